#include "grouped_mesh.h"
#include "input_file.h"

#include <recurve/core/exceptions.h>
#include <recurve/elements/node_layout.h>
#include <recurve/io/vtk.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <new>
#include <optional>
#include <span>

namespace recurve {

namespace {

using internal::Grouped_mesh;
using internal::Input_file;

/// value of an attribute of an XML element; empty without it. Nothing here needs escapes but names, which stand as
/// character codes.
std::string_view attribute(std::string_view element, std::string_view name)
{
  const std::string begin = fmt::format(" {}=\"", name);
  const std::size_t at = element.find(begin);
  if (at == std::string_view::npos)
    return {};
  element.remove_prefix(at + begin.size());
  return element.substr(0, element.find('"'));
}

template <class Number>
std::optional<Number> number_of(std::string_view text)
{
  Number value = {};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size())
    return std::nullopt;
  return value;
}

/// An array of the appended data, as the header tells.
struct Appended_array
{
  std::string name, type;
  std::uint64_t offset = 0;
  Index components = 1;
};

/// Elements of one type in one zone (of cells) or patch (of faces).
using Owner_and_type = std::pair<Index, Element_type>;

class Vtu_reader
{
public:
  Vtu_reader(const std::filesystem::path& file, const Progress_callback& progress) : in_(file, progress) {}

  Zonal_mesh read(Read_report* report)
  {
    read_header();
    read_arrays();
    check_arrays();
    add_elements();
    mesh_.zone_names = zone_names_;
    for (const std::string& name : patch_names_)
      mesh_.patches.push_back({.name = name, .kind = "BCTypeUserDefined", .family = {}, .faces = {}});
    std::vector<std::string> notes;
    Zonal_mesh result = to_zonal_mesh(std::move(mesh_), notes);
    if (report != nullptr)
      report->notes.insert(report->notes.end(), notes.begin(), notes.end());
    return result;
  }

private:
  // The header.
  // --------------------------------------------------------------------------------------------------------

  void read_header()
  {
    std::string line;
    bool is_ours = false;
    while (in_.read_line(line))
    {
      if (line.starts_with("<VTKFile"))
      {
        is_ours = attribute(line, "type") == "UnstructuredGrid" && attribute(line, "version") == "2.2" &&
                  attribute(line, "byte_order") == "LittleEndian" && attribute(line, "header_type") == "UInt64" &&
                  attribute(line, "compressor").empty();
        if (!is_ours)
          break;
      }
      else if (line.starts_with("<Piece"))
        read_piece(line);
      else if (line.starts_with("<DataArray"))
        read_array_element(line);
      else if (line.starts_with("<AppendedData"))
      {
        start_of_data(line);
        if (is_ours && point_count_ >= 0)
          return;
        break;
      }
    }
    in_.fail("is no VTU file as recurve writes them (one piece, version 2.2, little endian, appended raw data): others "
             "are not read");
  }

  void read_piece(std::string_view line)
  {
    const auto points = number_of<Index>(attribute(line, "NumberOfPoints"));
    const auto cells = number_of<Index>(attribute(line, "NumberOfCells"));
    if (!points || !cells || *points < 0 || *cells < 0 || point_count_ >= 0)
      in_.fail("more than one piece, or one without numbers of points and cells");
    point_count_ = *points;
    cell_count_ = *cells;
  }

  void read_array_element(std::string_view line)
  {
    const std::string name(attribute(line, "Name"));
    if (attribute(line, "type") == "String")
    {
      const std::string_view codes = line.substr(std::min(line.size(), line.find('>') + 1));
      if (name == "zone_names")
        zone_names_ = decoded(codes);
      else if (name == "patch_names")
        patch_names_ = decoded(codes);
      return;
    }
    const auto offset = number_of<std::uint64_t>(attribute(line, "offset"));
    const auto components = number_of<Index>(attribute(line, "NumberOfComponents"));
    if (!offset || !components || attribute(line, "format") != "appended")
      in_.fail(fmt::format("array {} is not among the appended data", internal::printable(name)));
    arrays_.push_back({name, std::string(attribute(line, "type")), *offset, *components});
  }

  /// texts that stand as character codes, each closed by a 0.
  std::vector<std::string> decoded(std::string_view codes)
  {
    std::vector<std::string> texts;
    std::string text;
    while (!codes.empty() && codes.front() != '<')
    {
      const std::size_t end = std::min(codes.size(), codes.find(' '));
      const auto code = number_of<int>(codes.substr(0, end));
      if (!code || *code < 0 || *code > 255)
        in_.fail("a text that does not stand as character codes");
      if (*code == 0)
        texts.push_back(std::exchange(text, {}));
      else
        text += static_cast<char>(*code);
      codes.remove_prefix(std::min(codes.size(), end + 1));
    }
    return texts;
  }

  void start_of_data(const std::string& line)
  {
    in_.set_binary(std::endian::native != std::endian::little);
    if (attribute(line, "encoding") != "raw" || in_.read<char>() != '_')
      in_.fail("the appended data are not raw");
    start_ = in_.offset();
  }

  // The arrays, in the order of the file.
  // ------------------------------------------------------------------------------

  void read_arrays()
  {
    std::sort(arrays_.begin(), arrays_.end(),
              [](const Appended_array& a, const Appended_array& b) { return a.offset < b.offset; });
    for (const Appended_array& array : arrays_)
    {
      const std::uint64_t done = in_.offset() - start_;
      if (array.offset < done)
        in_.fail(fmt::format("array {} overlaps another", internal::printable(array.name)));
      in_.skip_bytes(array.offset - done);
      const auto bytes = in_.read<std::uint64_t>();
      in_.check_count(bytes, 1, fmt::format("bytes of array {}", internal::printable(array.name)));
      if (array.name == "Points")
        read_points(array, bytes);
      else if (array.name == "connectivity")
        connectivity_ = read_numbers<std::int64_t>(array, bytes, "Int64");
      else if (array.name == "offsets")
        offsets_ = read_numbers<std::int64_t>(array, bytes, "Int64");
      else if (array.name == "pyramid_nodes")
        pyramid_nodes_ = read_numbers<std::int64_t>(array, bytes, "Int64");
      else if (array.name == "element_type")
        types_ = read_numbers<std::uint8_t>(array, bytes, "UInt8");
      else if (array.name == "zone")
        zones_ = read_numbers<std::int32_t>(array, bytes, "Int32");
      else if (array.name == "patch")
        patches_ = read_numbers<std::int32_t>(array, bytes, "Int32");
      else
        in_.skip_bytes(bytes);
    }
  }

  template <class Number>
  std::vector<Number> read_numbers(const Appended_array& array, std::uint64_t bytes, std::string_view type)
  {
    if (array.type != type || array.components != 1 || bytes % sizeof(Number) != 0)
      in_.fail(fmt::format("array {} does not consist of {}", internal::printable(array.name), type));
    std::vector<Number> values(bytes / sizeof(Number));
    for (Number& value : values)
      value = in_.read<Number>();
    return values;
  }

  void read_points(const Appended_array& array, std::uint64_t bytes)
  {
    if (array.type != "Float64" || array.components != 3 || bytes != 24 * static_cast<std::uint64_t>(point_count_))
      in_.fail(fmt::format("array Points does not hold {} points of Float64", point_count_));
    mesh_.nodes.resize(static_cast<std::size_t>(point_count_));
    for (std::size_t m = 0; m < mesh_.nodes.size(); ++m)
      for (std::size_t axis = 0; axis < 3; ++axis)
      {
        const double x = mesh_.nodes[m][axis] = in_.read<double>();
        if (!std::isfinite(x))
          in_.fail(fmt::format("point {}: coordinate {} is {}", m, "XYZ"[axis], x));
      }
  }

  void check_arrays()
  {
    const auto count = static_cast<std::size_t>(cell_count_);
    if (offsets_.size() != count || types_.size() != count || zones_.size() != count || patches_.size() != count ||
        mesh_.nodes.size() != static_cast<std::size_t>(point_count_))
      in_.fail("lacks arrays of cells or points that recurve writes: VTU files of other programs are not read");
    if (zone_names_.empty() || count == 0)
      in_.fail("has no zones: the mesh is empty");
    for (const std::int64_t node : connectivity_)
      if (node < 0 || node >= point_count_)
        in_.fail(fmt::format("the connectivity names point {}, outside 0..{}", node, point_count_ - 1));
    for (const std::int64_t node : pyramid_nodes_)
      if (node < 0 || node >= point_count_)
        in_.fail(fmt::format("pyramid_nodes names point {}, outside 0..{}", node, point_count_ - 1));
  }

  // Elements.
  // ----------------------------------------------------------------------------------------------------------

  Element_type element_type(std::size_t cell) const
  {
    const std::uint8_t number = types_[cell];
    if (number >= all_element_types.size() || reference_element(all_element_types[number]).dimension < 2)
      in_.fail(fmt::format("cell {}: element type {} is none that recurve writes", cell, number));
    return all_element_types[number];
  }

  static Element_type written_type(Element_type type)
  {
    return type == Element_type::pyramid ? Element_type::hexahedron : type;
  }

  void set_degree(std::size_t cell, Element_type type, Index width)
  {
    int degree = 1;
    while (degree <= max_degree && node_count(written_type(type), degree) != width)
      ++degree;
    if (degree > max_degree)
      in_.fail(fmt::format("cell {}: {} nodes for a {}", cell, width, element_name(type)));
    if (degree_ != 0 && degree != degree_)
      in_.fail(fmt::format("cell {}: degree {} in a mesh of degree {}", cell, degree, degree_));
    mesh_.degree = degree_ = degree;
  }

  void add_elements()
  {
    std::int64_t begin = 0;
    Owner_and_type last = {};
    std::vector<Index>* nodes = nullptr;
    std::span<const int> order;
    for (std::size_t cell = 0; cell < offsets_.size(); ++cell)
    {
      const std::int64_t end = offsets_[cell];
      if (end < begin || end > static_cast<std::int64_t>(connectivity_.size()))
        in_.fail(fmt::format("cell {}: offset {} outside {}..{}", cell, end, begin, connectivity_.size()));
      const Element_type type = element_type(cell);
      set_degree(cell, type, end - begin);
      // Neighbours mostly belong together.
      if (const Owner_and_type key = owner_of(cell, type); nodes == nullptr || key != last)
      {
        nodes = &nodes_for(key);
        order = type == Element_type::pyramid ? order : foreign_of_canonical(Node_order::vtk, type, degree_);
        last = key;
      }
      if (type == Element_type::pyramid)
        take_pyramid(cell, *nodes);
      else
        for (const int foreign : order)
          nodes->push_back(connectivity_[static_cast<std::size_t>(begin + foreign)]);
      begin = end;
    }
    connectivity_ = offsets_ = {};
    drop_extra_points();
  }

  /// the zone of a cell or the patch of a face.
  Owner_and_type owner_of(std::size_t cell, Element_type type) const
  {
    const Index zone = zones_[cell], patch = patches_[cell];
    const auto zone_count = static_cast<Index>(zone_names_.size());
    const auto patch_count = static_cast<Index>(patch_names_.size());
    const bool is_cell = reference_element(type).dimension == 3;
    if (zone < 0 || zone >= zone_count || (is_cell ? patch != -1 : patch < 0 || patch >= patch_count))
      in_.fail(fmt::format("cell {}: zone {} or patch {} does not exist", cell, zone, patch));
    return {is_cell ? zone : patch, type};
  }

  /// where the nodes of the elements of a zone or patch go.
  std::vector<Index>& nodes_for(const Owner_and_type& key)
  {
    const auto& [owner, type] = key;
    const bool is_cell = reference_element(type).dimension == 3;
    auto& groups = is_cell ? mesh_.cells : mesh_.faces;
    const auto [entry, is_new] = groups_.try_emplace(key, groups.size());
    if (is_new)
    {
      const std::string name(element_name(type));
      groups.push_back(
        {owner, is_cell ? name : fmt::format("{}_{}", patch_names_[static_cast<std::size_t>(owner)], name), type, {}});
    }
    return groups[entry->second].nodes;
  }

  /// The nodes of pyramids stand in an array of their own: not all of them are nodes of the hexahedron that VTK gets.
  void take_pyramid(std::size_t cell, std::vector<Index>& nodes)
  {
    const auto width = static_cast<std::size_t>(node_count(Element_type::pyramid, degree_));
    if (pyramid_nodes_.size() < next_pyramid_ + width)
      in_.fail(fmt::format("cell {}: its nodes are not in the array pyramid_nodes", cell));
    const auto first = pyramid_nodes_.begin() + static_cast<std::ptrdiff_t>(next_pyramid_);
    nodes.insert(nodes.end(), first, first + static_cast<std::ptrdiff_t>(width));
    next_pyramid_ += width;
  }

  /// The points of collapsed hexahedra that no pyramid has stand behind the nodes of the mesh.
  void drop_extra_points()
  {
    if (next_pyramid_ == 0)
      return;
    Index count = 0;
    for (const auto* groups : {&mesh_.cells, &mesh_.faces})
      for (const internal::Element_group& group : *groups)
        for (const Index node : group.nodes)
          count = std::max(count, node + 1);
    mesh_.nodes.resize(static_cast<std::size_t>(count));
  }

  Input_file in_;
  Grouped_mesh mesh_;
  int degree_ = 0;
  Index point_count_ = -1, cell_count_ = 0;
  std::uint64_t start_ = 0; ///< of the appended data, in the file
  std::vector<Appended_array> arrays_;
  std::vector<std::string> zone_names_, patch_names_;
  std::vector<std::int64_t> offsets_, connectivity_, pyramid_nodes_;
  std::vector<std::uint8_t> types_; ///< of elements
  std::vector<std::int32_t> zones_, patches_;
  std::map<Owner_and_type, std::size_t> groups_;
  std::size_t next_pyramid_ = 0;
};

} // namespace

Zonal_mesh read_vtu(const std::filesystem::path& file, Read_report* report, const Progress_callback& progress)
try
{
  return Vtu_reader(file, progress).read(report);
}
catch (const std::bad_alloc&)
{
  throw Format_error(fmt::format("{}: takes more memory than there is", file.string()));
}

} // namespace recurve
