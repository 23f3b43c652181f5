#include "disk_space.h"
#include "hdf5_file.h"
#include "hopr_sides.h"

#include <recurve/core/exceptions.h>
#include <recurve/elements/node_layout.h>
#include <recurve/io/hopr.h>

#include <algorithm>
#include <array>
#include <numeric>

namespace recurve {

namespace internal::hopr {

namespace {

constexpr std::size_t longest_name = 255; // of a boundary condition

/// Rows of ElemCounter: linear and curved tetrahedra, then linear, bilinear and curved pyramids and prisms, ...
constexpr std::array<std::int32_t, 11> counted_types = {104, 204, 105, 115, 205, 106, 116, 206, 108, 118, 208};

/// ElementType: the last digit counts the corners; "bilinear" and "non-linear" are the general elements of degree 1 and
/// more.
std::int32_t element_code(Element_type type, int degree)
{
  const std::int32_t corners = corner_count(type);
  if (degree > 1)
    return 200 + corners;
  return type == Element_type::tetrahedron ? 104 : 110 + corners;
}

std::int32_t side_code(Element_type type, int degree)
{
  const std::int32_t corners = corner_count(type);
  if (degree > 1)
    return 20 + corners;
  return corners == 3 ? 3 : 14;
}

/// Everything that the arrays of the file are made from.
struct Hopr_content
{
  const Curved_mesh& mesh;
  const Ordered_cells& cells;
  const Side_table& sides;
  std::vector<Index> first_node;    ///< per element, and the count at the end
  std::vector<std::int32_t> number; ///< per node of the mesh, from 1 without gaps; 0: in no cell
  std::int32_t unique_nodes = 0;
};

void number_nodes(Hopr_content& content)
{
  content.first_node.push_back(0);
  content.number.assign(content.mesh.nodes.size(), 0);
  for (Index element = 0; element < content.cells.count(); ++element)
  {
    const std::span<const Index> nodes = content.cells.nodes(element);
    content.first_node.push_back(content.first_node.back() + static_cast<Index>(nodes.size()));
    for (const Index node : nodes)
      content.number[static_cast<std::size_t>(node)] = 1;
  }
  for (std::int32_t& number : content.number)
    if (number != 0)
      number = ++content.unique_nodes;
}

void write_attributes(Hdf5_file& file, const Hopr_content& content)
{
  const auto put = [&](const char* name, Index value) { file.write_attribute(name, static_cast<std::int32_t>(value)); };
  file.write_attribute("Version", 1.0);
  put("Ngeo", content.mesh.degree);
  put("nElems", content.cells.count());
  put("nSides", content.sides.first_side.back());
  put("nNodes", content.first_node.back());
  put("nUniqueSides", content.sides.unique_count);
  put("nUniqueNodes", content.unique_nodes);
  put("nBCs", static_cast<Index>(content.sides.conditions.size()));
  file.write_attribute("FEMconnect", std::string("OFF"));
}

void write_elements(Hdf5_file& file, const Hopr_content& content)
{
  const Ordered_cells& cells = content.cells;
  file.write_array<std::int32_t>("ElemInfo", cells.count(), 6, [&](Index first, std::span<std::int32_t> values) {
    for (std::size_t m = 0; m < values.size(); m += 6)
    {
      const Index element = first + static_cast<Index>(m / 6);
      const auto e = static_cast<std::size_t>(element);
      const std::array<Index, 6> row = {element_code(cells.type(element), content.mesh.degree),
                                        static_cast<Index>(cells.zone(element)) + 1,
                                        content.sides.first_side[e],
                                        content.sides.first_side[e + 1],
                                        content.first_node[e],
                                        content.first_node[e + 1]};
      std::transform(row.begin(), row.end(), values.begin() + static_cast<std::ptrdiff_t>(m),
                     [](Index value) { return static_cast<std::int32_t>(value); });
    }
  });
  file.write_array<double>("ElemBarycenters", cells.count(), 3, [&](Index first, std::span<double> values) {
    for (std::size_t m = 0; m < values.size(); ++m)
      values[m] = cells.barycentre(first + static_cast<Index>(m / 3))[m % 3];
  });
  file.write_array<double>("ElemWeight", cells.count(), 0,
                           [](Index, std::span<double> values) { std::fill(values.begin(), values.end(), 1.0); });
  std::array<std::int32_t, 11> counts = {};
  for (Index element = 0; element < cells.count(); ++element)
    ++counts[static_cast<std::size_t>(
      std::find(counted_types.begin(), counted_types.end(), element_code(cells.type(element), content.mesh.degree)) -
      counted_types.begin())];
  file.write_array<std::int32_t>("ElemCounter", 11, 2, [&](Index, std::span<std::int32_t> values) {
    for (std::size_t row = 0; row < counts.size(); ++row)
    {
      values[2 * row] = counted_types[row];
      values[2 * row + 1] = counts[row];
    }
  });
}

void write_sides(Hdf5_file& file, const Hopr_content& content)
{
  const Side_table& table = content.sides;
  Index element = 0; // of the running side
  file.write_array<std::int32_t>(
    "SideInfo", table.first_side.back(), 5, [&](Index first, std::span<std::int32_t> values) {
      for (std::size_t m = 0; m < values.size(); m += 5)
      {
        const Index number = first + static_cast<Index>(m / 5);
        while (table.first_side[static_cast<std::size_t>(element) + 1] <= number)
          ++element;
        const auto local = static_cast<std::size_t>(number - table.first_side[static_cast<std::size_t>(element)]);
        const Side& side = table.sides[static_cast<std::size_t>(number)];
        const Element_type type = reference_element(content.cells.type(element)).faces[local].type;
        values[m] = side_code(type, content.mesh.degree);
        values[m + 1] = side.global_id;
        values[m + 2] = side.neighbor;
        values[m + 3] = 10 * side.neighbor_side + side.flip;
        values[m + 4] = side.condition;
      }
    });
}

/// calls visit(position in `values`, node of the mesh) for the nodes from `first` on, element by element in rows.
template <class Visit>
void visit_nodes(const Hopr_content& content, Index first, std::size_t count, const Visit& visit)
{
  const auto after = std::upper_bound(content.first_node.begin(), content.first_node.end(), first);
  Index element = static_cast<Index>(after - content.first_node.begin()) - 1;
  auto local = static_cast<std::size_t>(first - content.first_node[static_cast<std::size_t>(element)]);
  for (std::size_t done = 0; done < count; ++element, local = 0)
  {
    const std::span<const Index> nodes = content.cells.nodes(element);
    const std::span<const int> order =
      canonical_of_foreign(Node_order::rows, content.cells.type(element), content.mesh.degree);
    for (; local < order.size() && done < count; ++local, ++done)
      visit(done, nodes[static_cast<std::size_t>(order[local])]);
  }
}

void write_nodes(Hdf5_file& file, const Hopr_content& content, const Progress_callback& progress)
{
  const Index count = content.first_node.back();
  file.write_array<std::int32_t>("GlobalNodeIDs", count, 0, [&](Index first, std::span<std::int32_t> values) {
    visit_nodes(content, first, values.size(),
                [&](std::size_t m, Index node) { values[m] = content.number[static_cast<std::size_t>(node)]; });
  });
  Index percent = 0;
  file.write_array<double>("NodeCoords", count, 3, [&](Index first, std::span<double> values) {
    visit_nodes(content, first, values.size() / 3, [&](std::size_t m, Index node) {
      const Point& point = content.mesh.nodes[static_cast<std::size_t>(node)];
      std::copy(point.begin(), point.end(), values.begin() + static_cast<std::ptrdiff_t>(3 * m));
    });
    if (const Index now = 100 * first / count; now > percent)
      report_progress(progress, "write", static_cast<double>(percent = now) / 100);
  });
}

void write_conditions(Hdf5_file& file, const Hopr_content& content)
{
  std::vector<std::string> names, zones;
  for (const Condition& condition : content.sides.conditions)
    names.push_back(condition.name);
  for (const Zone& zone : content.mesh.linear.zones)
    zones.push_back(zone.name);
  file.write_texts("BCNames", names, longest_name);
  file.write_array<std::int32_t>(
    "BCType", static_cast<Index>(names.size()), 4, [&](Index first, std::span<std::int32_t> values) {
      for (std::size_t m = 0; m < values.size(); ++m)
        values[m] = content.sides.conditions[static_cast<std::size_t>(first) + m / 4].type[m % 4];
    });
  file.write_texts("ZoneNames", zones, longest_name);
}

/// an upper bound of the size of the file.
Index largest_file_size(const Hopr_content& content)
{
  constexpr Index overhead = 65536; // headers of the file and its arrays
  return overhead + 56 * content.cells.count() + 20 * content.sides.first_side.back() + 28 * content.first_node.back() +
         static_cast<Index>(longest_name + 16) *
           static_cast<Index>(content.sides.conditions.size() + content.mesh.linear.zones.size());
}

void write_file(const Hopr_content& content, const std::filesystem::path& path, const Progress_callback& progress)
{
  Hdf5_file file(path, Hdf5_file::Mode::write);
  write_attributes(file, content);
  write_elements(file, content);
  write_sides(file, content);
  write_nodes(file, content, progress);
  write_conditions(file, content);
  file.finish();
}

} // namespace

} // namespace internal::hopr

void write_hopr(const Curved_mesh& mesh, const std::filesystem::path& file, const Progress_callback& progress)
{
  using namespace internal::hopr;
  report_progress(progress, "write", 0);
  const Ordered_cells cells(mesh);
  if (cells.count() == 0)
    throw Input_error("write_hopr: the mesh has no cells");
  const Side_table sides = connect_sides(mesh, cells);
  Hopr_content content = {mesh, cells, sides, {}, {}, 0};
  number_nodes(content);
  internal::reserve_disk_space(file, largest_file_size(content));
  try
  {
    write_file(content, file, progress);
  }
  catch (...)
  {
    std::error_code ignored;
    std::filesystem::remove(file, ignored);
    throw;
  }
  report_progress(progress, "write", 1);
}

} // namespace recurve
