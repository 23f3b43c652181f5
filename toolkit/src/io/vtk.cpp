#include <recurve/io/vtk.h>

#include "binary_output.h"

#include <recurve/elements/basis.h>
#include <recurve/elements/node_layout.h>

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <map>
#include <set>
#include <span>
#include <utility>

namespace recurve {

namespace {

constexpr std::string_view stage = "write";

// VTK's numbers of Lagrange cells, vtkCellType.h.
std::uint8_t vtk_type(Element_type type)
{
  switch (type)
  {
  case Element_type::line: return 68;
  case Element_type::triangle: return 69;
  case Element_type::quadrangle: return 70;
  case Element_type::tetrahedron: return 71;
  case Element_type::prism: return 73; // also at degree 1: the linear wedge of VTK has the opposite orientation
  case Element_type::pyramid:          // VTK has no Lagrange pyramid; see Collapsed_pyramid
  case Element_type::hexahedron: return 72;
  }
  return 0;
}

Element_type written_type(Element_type type)
{
  return type == Element_type::pyramid ? Element_type::hexahedron : type;
}

/// How a pyramid becomes a hexahedron: node (i, j, k) of the hexahedron lies at (i(p-k)/p, j(p-k)/p, k) on the lattice
/// of the pyramid. Where that is a node of the pyramid it is used, else an extra point is made.
struct Collapsed_pyramid
{
  std::vector<int> pyramid_node; ///< per canonical node of the hexahedron: node of the pyramid, or -1
  std::vector<int> extra_number; ///< ... or number among the extra points of a pyramid
  std::vector<int> extra_nodes;  ///< canonical nodes of the hexahedron that are extra points
};

Collapsed_pyramid collapse_pyramid(int degree)
{
  std::map<Lattice_point, int> pyramid_nodes;
  for (const Lattice_point& lattice : canonical_nodes(Element_type::pyramid, degree))
    pyramid_nodes.emplace(lattice, static_cast<int>(pyramid_nodes.size()));

  Collapsed_pyramid result;
  int node = 0;
  for (const auto& [i, j, k] : canonical_nodes(Element_type::hexahedron, degree))
  {
    const int x = i * (degree - k), y = j * (degree - k);
    const bool is_node = x % degree == 0 && y % degree == 0;
    result.pyramid_node.push_back(is_node ? pyramid_nodes.at({x / degree, y / degree, k}) : -1);
    result.extra_number.push_back(is_node ? -1 : static_cast<int>(result.extra_nodes.size()));
    if (!is_node)
      result.extra_nodes.push_back(node);
    ++node;
  }
  return result;
}

/// A section as it goes to the file. Of a section of faces only the faces of patches are written.
struct Block
{
  std::size_t zone = 0;
  const Curved_section* section = nullptr;
  std::span<const std::int32_t> patch_of_face; ///< of the section; empty for cells
  std::span<const std::uint8_t> is_straight;   ///< of the section; empty for faces
  Index element_count = 0;                     ///< of the section
  Index written_count = 0;

  bool is_cells() const { return patch_of_face.empty(); }
  bool is_written(Index element) const { return is_cells() || patch_of_face[static_cast<std::size_t>(element)] >= 0; }
};

/// What goes to the file, in its order.
class Vtu_content
{
public:
  explicit Vtu_content(const Curved_mesh& mesh)
    : mesh_(mesh), collapsed_(collapse_pyramid(mesh.degree)), patch_of_face_(mesh.zones.size())
  {
    if (mesh.zones.size() != mesh.linear.zones.size())
      throw Input_error("write_vtu: the curved mesh and its linear mesh differ in zones");
    for (std::size_t z = 0; z < mesh.zones.size(); ++z)
      number_patches(z);
    for (std::size_t z = 0; z < mesh.zones.size(); ++z)
      add_cells(z);
    for (std::size_t z = 0; z < mesh.zones.size(); ++z)
      add_faces(z);
  }

  const Curved_mesh& mesh() const { return mesh_; }
  const std::vector<Block>& blocks() const { return blocks_; }
  const std::vector<std::string>& patch_names() const { return patch_names_; }
  const Collapsed_pyramid& collapsed() const { return collapsed_; }
  Index element_count() const { return element_count_; }
  Index cell_count() const { return cell_count_; }
  Index pyramid_count() const { return pyramid_count_; }
  Index connectivity_size() const { return connectivity_size_; }
  Index point_count() const
  {
    return static_cast<Index>(mesh_.nodes.size()) + pyramid_count_ * static_cast<Index>(collapsed_.extra_nodes.size());
  }

private:
  void number_patches(std::size_t z)
  {
    const Zone& zone = mesh_.linear.zones[z];
    auto& patch_of_face = patch_of_face_[z];
    patch_of_face.assign(static_cast<std::size_t>(zone.face_count()), -1);
    for (const Patch& patch : zone.patches)
    {
      const auto [entry, is_new] = patch_numbers_.emplace(patch.name, static_cast<std::int32_t>(patch_names_.size()));
      if (is_new)
        patch_names_.push_back(patch.name);
      for (Index face : patch.faces)
        patch_of_face.at(static_cast<std::size_t>(face)) = entry->second;
    }
  }

  void add_cells(std::size_t z)
  {
    std::span<const std::uint8_t> is_straight = mesh_.zones[z].is_straight;
    for (const Curved_section& section : mesh_.zones[z].cells)
    {
      Block block = make_block(z, section);
      if (is_straight.size() < static_cast<std::size_t>(block.element_count))
        throw Input_error(
          fmt::format("write_vtu: zone \"{}\" has fewer straightness marks than cells", mesh_.linear.zones[z].name));
      block.is_straight = is_straight.first(static_cast<std::size_t>(block.element_count));
      is_straight = is_straight.subspan(static_cast<std::size_t>(block.element_count));
      cell_count_ += block.element_count;
      if (section.type == Element_type::pyramid)
        pyramid_count_ += block.element_count;
      add(block);
    }
  }

  void add_faces(std::size_t z)
  {
    std::span<const std::int32_t> patches = patch_of_face_[z];
    for (const Curved_section& section : mesh_.zones[z].faces)
    {
      Block block = make_block(z, section);
      if (patches.size() < static_cast<std::size_t>(block.element_count))
        throw Input_error(
          fmt::format("write_vtu: zone \"{}\" has more curved faces than linear ones", mesh_.linear.zones[z].name));
      block.patch_of_face = patches.first(static_cast<std::size_t>(block.element_count));
      patches = patches.subspan(static_cast<std::size_t>(block.element_count));
      block.written_count = 0;
      for (std::int32_t patch : block.patch_of_face)
        block.written_count += patch >= 0;
      if (block.element_count > 0)
        add(block);
    }
  }

  Block make_block(std::size_t z, const Curved_section& section) const
  {
    Block block;
    block.zone = z;
    block.section = &section;
    block.element_count = static_cast<Index>(section.nodes.size()) / node_count(section.type, mesh_.degree);
    block.written_count = block.element_count;
    return block;
  }

  void add(const Block& block)
  {
    element_count_ += block.written_count;
    connectivity_size_ += block.written_count * node_count(written_type(block.section->type), mesh_.degree);
    blocks_.push_back(block);
  }

  const Curved_mesh& mesh_;
  Collapsed_pyramid collapsed_;
  std::map<std::string, std::int32_t> patch_numbers_;
  std::vector<std::string> patch_names_;
  std::vector<std::vector<std::int32_t>> patch_of_face_;
  std::vector<Block> blocks_;
  Index element_count_ = 0, cell_count_ = 0, pyramid_count_ = 0, connectivity_size_ = 0;
};

template <class Function>
void for_each_written(const Block& block, Function function)
{
  for (Index element = 0; element < block.element_count; ++element)
    if (block.is_written(element))
      function(element);
}

std::span<const Index> element_nodes(const Block& block, Index element, int degree)
{
  const auto count = static_cast<std::size_t>(node_count(block.section->type, degree));
  return std::span(block.section->nodes).subspan(static_cast<std::size_t>(element) * count, count);
}

void put_points(const Vtu_content& content, Binary_output& out)
{
  const Curved_mesh& mesh = content.mesh();
  for (const Point& point : mesh.nodes)
    for (double coordinate : point)
      out.put(coordinate);

  for (const Block& block : content.blocks())
  {
    if (block.section->type != Element_type::pyramid || content.collapsed().extra_nodes.empty())
      continue;
    const Eigen::MatrixXd& hexahedron_of_pyramid = pyramid_to_hexahedron(mesh.degree);
    for_each_written(block, [&](Index element) {
      const auto nodes = element_nodes(block, element, mesh.degree);
      for (int extra : content.collapsed().extra_nodes)
      {
        Point point = {};
        for (std::size_t n = 0; n < nodes.size(); ++n)
          for (std::size_t c = 0; c < 3; ++c)
            point[c] += hexahedron_of_pyramid(extra, static_cast<Eigen::Index>(n)) *
                        mesh.nodes[static_cast<std::size_t>(nodes[n])][c];
        for (double coordinate : point)
          out.put(coordinate);
      }
    });
  }
}

void put_connectivity(const Vtu_content& content, Binary_output& out)
{
  const int degree = content.mesh().degree;
  const Collapsed_pyramid& collapsed = content.collapsed();
  auto next_extra = static_cast<Index>(content.mesh().nodes.size());
  for (const Block& block : content.blocks())
  {
    const Element_type type = block.section->type;
    const auto order = canonical_of_foreign(Node_order::vtk, written_type(type), degree);
    for_each_written(block, [&](Index element) {
      const auto nodes = element_nodes(block, element, degree);
      if (type != Element_type::pyramid)
      {
        for (int node : order)
          out.put(static_cast<std::int64_t>(nodes[static_cast<std::size_t>(node)]));
        return;
      }
      for (int node : order)
      {
        const auto n = static_cast<std::size_t>(node);
        const int own = collapsed.pyramid_node[n];
        out.put(own >= 0 ? nodes[static_cast<std::size_t>(own)] : next_extra + collapsed.extra_number[n]);
      }
      next_extra += static_cast<Index>(collapsed.extra_nodes.size());
    });
  }
}

/// the nodes of pyramids as they are, for our own reader: the collapsed hexahedra lack some of them.
void put_pyramid_nodes(const Vtu_content& content, Binary_output& out)
{
  for (const Block& block : content.blocks())
    if (block.section->type == Element_type::pyramid)
      for (const Index node : block.section->nodes)
        out.put(static_cast<std::int64_t>(node));
}

void put_offsets(const Vtu_content& content, Binary_output& out)
{
  std::int64_t end = 0;
  for (const Block& block : content.blocks())
  {
    const int count = node_count(written_type(block.section->type), content.mesh().degree);
    for (Index element = 0; element < block.written_count; ++element)
      out.put(end += count);
  }
}

/// writes value_of(block, element) for every element.
template <class Value, class Function>
void put_per_element(const Vtu_content& content, Binary_output& out, Function value_of)
{
  for (const Block& block : content.blocks())
    for_each_written(block, [&](Index element) { out.put(static_cast<Value>(value_of(block, element))); });
}

/// One array of the appended data, and how to write it.
struct Data_array
{
  std::string name;
  std::string vtk_value_type;
  int components = 1;
  std::uint64_t bytes = 0;
  std::function<void(Binary_output&)> put;
  Index tuples = 0; ///< told in the file where it does not follow from the piece
};

struct Arrays
{
  std::vector<Data_array> field_data, points, cells, cell_data;
};

template <class Value>
constexpr std::string_view value_type_name = "";
template <>
constexpr std::string_view value_type_name<double> = "Float64";
template <>
constexpr std::string_view value_type_name<std::int64_t> = "Int64";
template <>
constexpr std::string_view value_type_name<std::int32_t> = "Int32";
template <>
constexpr std::string_view value_type_name<std::uint8_t> = "UInt8";
template <>
constexpr std::string_view value_type_name<std::int8_t> = "Int8";

template <class Value>
Data_array make_array(std::string name, int components, Index values, std::function<void(Binary_output&)> put)
{
  return {std::move(name), std::string(value_type_name<Value>), components,
          static_cast<std::uint64_t>(values) * sizeof(Value), std::move(put)};
}

template <class Value, class Function>
Data_array make_element_array(const Vtu_content& content, std::string name, Function value_of)
{
  return make_array<Value>(std::move(name), 1, content.element_count(), [&content, value_of](Binary_output& out) {
    put_per_element<Value>(content, out, value_of);
  });
}

Data_array make_field_array(const Vtu_content& content, const Cell_field& field)
{
  return make_array<double>(field.name, 1, content.element_count(), [&](Binary_output& out) {
    for (double value : field.values)
      out.put(value);
    for (Index face = content.cell_count(); face < content.element_count(); ++face)
      out.put(std::numeric_limits<double>::quiet_NaN());
  });
}

Arrays make_arrays(const Vtu_content& content, const std::vector<Cell_field>& fields)
{
  Arrays arrays;
  const auto put = [&content](auto function) {
    return [&content, function](Binary_output& out) { function(content, out); };
  };
  if (content.pyramid_count() > 0)
    arrays.field_data = {make_array<std::int64_t>(
      "pyramid_nodes", 1, content.pyramid_count() * node_count(Element_type::pyramid, content.mesh().degree),
      put(put_pyramid_nodes))};
  for (Data_array& array : arrays.field_data)
    array.tuples = static_cast<Index>(array.bytes / sizeof(std::int64_t));
  arrays.points = {make_array<double>("Points", 3, 3 * content.point_count(), put(put_points))};
  arrays.cells = {make_array<std::int64_t>("connectivity", 1, content.connectivity_size(), put(put_connectivity)),
                  make_array<std::int64_t>("offsets", 1, content.element_count(), put(put_offsets)),
                  make_element_array<std::uint8_t>(
                    content, "types", [](const Block& block, Index) { return vtk_type(block.section->type); })};
  arrays.cell_data = {
    make_element_array<std::int32_t>(content, "zone", [](const Block& block, Index) { return block.zone; }),
    make_element_array<std::int32_t>(content, "patch",
                                     [](const Block& block, Index element) {
                                       return block.is_cells() ? -1
                                                               : block.patch_of_face[static_cast<std::size_t>(element)];
                                     }),
    make_element_array<std::uint8_t>(content, "element_type",
                                     [](const Block& block, Index) { return block.section->type; }),
    make_element_array<std::int8_t>(content, "is_straight", [](const Block& block, Index element) {
      return block.is_cells() ? (block.is_straight[static_cast<std::size_t>(element)] != 0 ? 1 : 0) : -1;
    })};
  for (const Cell_field& field : fields)
    arrays.cell_data.push_back(make_field_array(content, field));
  return arrays;
}

void check_fields(const Vtu_content& content, const std::vector<Cell_field>& fields)
{
  std::set<std::string> names = {"zone", "patch", "element_type", "is_straight"};
  for (const Cell_field& field : fields)
  {
    if (static_cast<Index>(field.values.size()) != content.cell_count())
      throw Input_error(fmt::format("write_vtu: field \"{}\" has {} values for {} cells", field.name,
                                    field.values.size(), content.cell_count()));
    if (field.name.empty() || !names.insert(field.name).second)
      throw Input_error(fmt::format("write_vtu: the name \"{}\" of a field is empty or taken", field.name));
  }
}

std::string escaped(std::string_view text)
{
  std::string result;
  for (char character : text)
    switch (character)
    {
    case '&': result += "&amp;"; break;
    case '<': result += "&lt;"; break;
    case '>': result += "&gt;"; break;
    case '"': result += "&quot;"; break;
    default: result += character;
    }
  return result;
}

/// a string array of the field data: character codes, each string closed by a 0.
template <class Strings>
std::string string_array(std::string_view name, const Strings& strings)
{
  std::string text =
    fmt::format(R"(<DataArray type="String" Name="{}" NumberOfTuples="{}" format="ascii">)", name, std::size(strings));
  for (const auto& string : strings)
  {
    for (char character : string)
      text += fmt::format("{} ", static_cast<int>(static_cast<unsigned char>(character)));
    text += "0 ";
  }
  return text + "</DataArray>\n";
}

std::string field_data(const Vtu_content& content)
{
  std::vector<std::string> zone_names;
  zone_names.reserve(content.mesh().linear.zones.size());
  for (const Zone& zone : content.mesh().linear.zones)
    zone_names.push_back(zone.name);
  std::vector<std::string_view> type_names;
  type_names.reserve(all_element_types.size());
  for (Element_type type : all_element_types)
    type_names.push_back(element_name(type));
  return string_array("zone_names", zone_names) + string_array("patch_names", content.patch_names()) +
         string_array("element_type_names", type_names);
}

/// the XML elements of `arrays`; `offset` runs through the appended data.
std::string array_elements(const std::vector<Data_array>& arrays, std::uint64_t& offset)
{
  std::string text;
  for (const Data_array& array : arrays)
  {
    text += fmt::format("<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\"{} format=\"appended\" "
                        "offset=\"{}\"/>\n",
                        array.vtk_value_type, escaped(array.name), array.components,
                        array.tuples > 0 ? fmt::format(" NumberOfTuples=\"{}\"", array.tuples) : "", offset);
    offset += sizeof(std::uint64_t) + array.bytes;
  }
  return text;
}

std::string header(const Vtu_content& content, const Arrays& arrays)
{
  std::uint64_t offset = 0;
  const std::string more_fields = array_elements(arrays.field_data, offset);
  const std::string points = array_elements(arrays.points, offset);
  const std::string cells = array_elements(arrays.cells, offset);
  const std::string cell_data = array_elements(arrays.cell_data, offset);
  return fmt::format("<?xml version=\"1.0\"?>\n"
                     "<VTKFile type=\"UnstructuredGrid\" version=\"2.2\" byte_order=\"LittleEndian\" "
                     "header_type=\"UInt64\">\n<UnstructuredGrid>\n<FieldData>\n{}{}</FieldData>\n"
                     "<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n<Points>\n{}</Points>\n<Cells>\n{}</Cells>\n"
                     "<CellData>\n{}</CellData>\n</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_",
                     field_data(content), more_fields, content.point_count(), content.element_count(), points, cells,
                     cell_data);
}

std::uint64_t total_bytes(const Arrays& arrays)
{
  std::uint64_t total = 0;
  for (const auto* group : {&arrays.field_data, &arrays.points, &arrays.cells, &arrays.cell_data})
    for (const Data_array& array : *group)
      total += array.bytes;
  return total;
}

/// tells `progress` of each new percent that is written.
std::function<void()> watch(const Binary_output& out, std::uint64_t total, const Progress_callback& progress)
{
  return [&out, &progress, total, shown = std::uint64_t{0}]() mutable {
    // The header comes on top of the arrays, so that the sum may pass 100.
    const std::uint64_t percent = std::min<std::uint64_t>(100, total > 0 ? 100 * out.size() / total : 100);
    if (percent > std::exchange(shown, percent))
      report_progress(progress, stage, static_cast<double>(percent) / 100);
  };
}

void put_appended(const Arrays& arrays, Binary_output& out)
{
  for (const auto* group : {&arrays.field_data, &arrays.points, &arrays.cells, &arrays.cell_data})
    for (const Data_array& array : *group)
    {
      out.put(array.bytes);
      const std::uint64_t start = out.size();
      array.put(out);
      if (out.size() - start != array.bytes)
        throw Input_error(fmt::format("write_vtu: array \"{}\" does not fit the mesh", array.name));
    }
}

} // namespace

void write_vtu(const Curved_mesh& mesh, const std::filesystem::path& file, const std::vector<Cell_field>& fields,
               const Progress_callback& progress)
{
  const Vtu_content content(mesh);
  check_fields(content, fields);
  report_progress(progress, stage, 0.0);

  const Arrays arrays = make_arrays(content, fields);
  Binary_output out(file);
  out.put_text(header(content, arrays));
  out.call_after_writes(watch(out, total_bytes(arrays), progress));
  put_appended(arrays, out);
  out.put_text("\n</AppendedData>\n</VTKFile>\n");
  out.close();
}

} // namespace recurve
