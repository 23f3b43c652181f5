#include "cgns_reading.h"

#include <fmt/format.h>

#include <algorithm>

namespace recurve::internal::cgns {

namespace {

/// the numbers of points and cells that Zone_t states, one of each per index direction.
struct Zone_size
{
  std::vector<Index> points, cells;
};

Zone_size read_size(const Cgns_tree& tree, const Cgns_node& node, bool is_structured)
{
  const std::vector<std::int64_t> data = tree.read_integers(node);
  const std::size_t dimension = data.size() / 3;
  if (data.size() % 3 != 0 || dimension != (is_structured ? 3U : 1U))
    tree.fail(fmt::format("zone '{}' ({}) states its size with {} numbers", node.name(),
                          is_structured ? "structured" : "unstructured", data.size()));
  Zone_size size;
  size.points.assign(data.begin(), data.begin() + static_cast<std::ptrdiff_t>(dimension));
  size.cells.assign(data.begin() + static_cast<std::ptrdiff_t>(dimension),
                    data.begin() + static_cast<std::ptrdiff_t>(2 * dimension));
  double points = 1;
  for (const Index count : size.points)
  {
    if (count < 1)
      tree.fail(fmt::format("zone '{}' states {} points", node.name(), count));
    points *= static_cast<double>(count);
  }
  for (const Index count : size.cells)
    if (count < 0)
      tree.fail(fmt::format("zone '{}' states {} cells", node.name(), count));
  // At least float32 coordinates have to be in the file.
  tree.check_plausible_size(12 * points, fmt::format("{:.0f} points of zone '{}'", points, node.name()));
  return size;
}

bool find_structured(const Cgns_tree& tree, const Cgns_node& node)
{
  const std::string type = text_of(tree, node, "ZoneType_t");
  if (type == "Structured" || type == "Unstructured")
    return type == "Structured";
  if (!type.empty())
    tree.fail(fmt::format("zone '{}': zone type '{}' is neither Structured nor Unstructured", node.name(), type));
  return tree.read_integers(node).size() == 9; // files before CGNS 1.2 do not say: three numbers per index direction
}

} // namespace

Zone_reading read_zone(Cgns_reading& reading, const Cgns_node& node)
{
  const Cgns_tree& tree = reading.tree;
  Zone_reading result;
  result.node = node;
  result.zone.name = node.name();
  result.zone.family = text_of(tree, node, "FamilyName_t");
  result.zone.descriptors = read_descriptors(tree, node);
  result.is_structured = find_structured(tree, node);
  const Zone_size size = read_size(tree, node, result.is_structured);
  Index points = size.points[0];
  if (result.is_structured)
  {
    std::copy(size.points.begin(), size.points.end(), result.size.begin());
    if (*std::min_element(size.points.begin(), size.points.end()) < 2)
      tree.fail(fmt::format("zone '{}' has {} x {} x {} points: no cells", node.name(), size.points[0], size.points[1],
                            size.points[2]));
    points = size.points[0] * size.points[1] * size.points[2];
  }
  read_coordinates(reading, result, points);
  if (result.is_structured)
  {
    if (reading.degree > 1)
      tree.fail(fmt::format("zone '{}' is structured, hence linear, in a mesh of degree {}: only meshes of one degree "
                            "can be read",
                            node.name(), reading.degree));
    reading.degree = 1;
    make_structured_cells(result);
    reading.notes.push_back(fmt::format("zone '{}': structured, {} x {} x {} points, read as hexahedra", node.name(),
                                        size.points[0], size.points[1], size.points[2]));
    return result;
  }
  read_sections(reading, result);
  const Index cells = result.zone.cell_count();
  if (cells != size.cells[0])
    reading.notes.push_back(
      fmt::format("zone '{}' states {} cells, its sections have {}", node.name(), size.cells[0], cells));
  return result;
}

} // namespace recurve::internal::cgns
