#include <recurve/io/su2.h>

#include "grouped_mesh.h"
#include "input_file.h"

#include <recurve/core/exceptions.h>
#include <recurve/elements/node_layout.h>

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <map>
#include <new>
#include <optional>
#include <span>

namespace recurve {

namespace {

using internal::Element_group;
using internal::Grouped_mesh;
using internal::Input_file;

struct Su2_type
{
  Element_type type;
  int degree;
};

/// the element of a code: 100 (degree - 1) + type of VTK; beyond 10000 the degree of the solution comes on top.
std::optional<Su2_type> find_type(Index code)
{
  if (code > 10000)
    code %= 10000;
  const Index degree = code / 100 + 1;
  if (code < 0 || degree > max_degree)
    return std::nullopt;
  switch (code % 100)
  {
  case 3: return Su2_type{Element_type::line, static_cast<int>(degree)};
  case 5: return Su2_type{Element_type::triangle, static_cast<int>(degree)};
  case 9: return Su2_type{Element_type::quadrangle, static_cast<int>(degree)};
  case 10: return Su2_type{Element_type::tetrahedron, static_cast<int>(degree)};
  case 12: return Su2_type{Element_type::hexahedron, static_cast<int>(degree)};
  case 13: return Su2_type{Element_type::prism, static_cast<int>(degree)};
  case 14: return Su2_type{Element_type::pyramid, static_cast<int>(degree)};
  default: return std::nullopt;
  }
}

std::string_view trimmed(std::string_view text)
{
  constexpr std::string_view blanks = " \t\r";
  const std::size_t first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos)
    return {};
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

/// The numbers of a line, one after the other.
class Line_numbers
{
public:
  Line_numbers(const Input_file& in, std::string_view line) : in_(in), rest_(line) {}

  template <class Number>
  Number next(std::string_view what)
  {
    rest_ = trimmed(rest_);
    const std::string_view word = rest_.substr(0, rest_.find_first_of(" \t"));
    Number value = {};
    const auto [end, error] =
      std::from_chars(word.data() + (word.starts_with('+') ? 1 : 0), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size())
      in_.fail(word.empty() ? fmt::format("ends where {} is expected", what)
                            : fmt::format("'{}' where {} is expected", word.substr(0, 40), what));
    rest_.remove_prefix(word.size());
    return value;
  }

private:
  const Input_file& in_;
  std::string_view rest_;
};

class Su2_reader
{
public:
  Su2_reader(const std::filesystem::path& file, const Progress_callback& progress) : in_(file, progress) {}

  Zonal_mesh read(Read_report* report)
  {
    while (read_line())
    {
      const std::size_t equals = line_.find('=');
      if (equals != std::string::npos)
        read_keyword(trimmed(std::string_view(line_).substr(0, equals)),
                     trimmed(std::string_view(line_).substr(equals + 1)));
    }
    finish_zone();
    if (mesh_.cells.empty())
      in_.fail("has no cells: no NELEM= with elements of dimension 3");
    mesh_.degree = degree_;
    note_left_out();
    Zonal_mesh result = to_zonal_mesh(std::move(mesh_), notes_);
    if (report != nullptr)
      report->notes.insert(report->notes.end(), notes_.begin(), notes_.end());
    return result;
  }

private:
  /// the next line with something on it, without its comment.
  bool read_line()
  {
    while (in_.read_line(line_))
    {
      line_.resize(std::min(line_.size(), line_.find('%')));
      if (!trimmed(line_).empty())
        return true;
    }
    return false;
  }

  Index count_of(std::string_view value, std::string_view what, std::uint64_t bytes)
  {
    const auto count = Line_numbers(in_, value).next<Index>(fmt::format("the number of {}", what));
    if (count < 0)
      in_.fail(fmt::format("{} {}", count, what));
    in_.check_count(static_cast<std::uint64_t>(count), bytes, what);
    return count;
  }

  void read_keyword(std::string_view key, std::string_view value)
  {
    if (key == "NDIME")
      check_dimension(value);
    else if (key == "NZONE")
      has_zones_ = Line_numbers(in_, value).next<Index>("the number of zones") > 1;
    else if (key == "IZONE")
      begin_zone();
    else if (key == "NELEM")
      read_cells(count_of(value, "elements", 10)); // five numbers and their blanks
    else if (key == "NPOIN")
      read_points(count_of(value, "points", 6));
    else if (key == "MARKER_TAG")
      begin_marker(std::string(value));
    else if (key == "MARKER_ELEMS")
      read_faces(count_of(value, "elements of a marker", 4));
    else if (key == "NPERIODIC" && Line_numbers(in_, value).next<Index>("the number of periodic maps") > 1)
      has_periodic_ = true;
  }

  void check_dimension(std::string_view value)
  {
    if (const auto dimension = Line_numbers(in_, value).next<Index>("the dimension"); dimension != 3)
      in_.fail(fmt::format("NDIME= {}: only 3D meshes can be read", dimension));
    has_dimension_ = true;
  }

  void begin_zone()
  {
    if (has_points_ || has_cells_)
      finish_zone();
  }

  /// checks the nodes of the zone that ends, which may come after the elements.
  void finish_zone()
  {
    if (!has_dimension_)
      in_.fail("has no NDIME=: this is no SU2 mesh");
    if (!has_points_)
      in_.fail("has no NPOIN=");
    const auto count = static_cast<Index>(mesh_.nodes.size());
    for (auto* groups : {&mesh_.cells, &mesh_.faces})
    {
      std::size_t& checked = groups == &mesh_.cells ? checked_cells_ : checked_faces_;
      for (; checked < groups->size(); ++checked)
        check_nodes((*groups)[checked], count);
    }
    mesh_.zone_names.push_back(has_zones_ ? fmt::format("zone_{}", mesh_.zone_names.size() + 1) : "zone");
    first_node_ = count;
    has_points_ = has_cells_ = false;
    cell_groups_.clear();
  }

  void check_nodes(Element_group& group, Index count) const
  {
    const auto width = static_cast<std::size_t>(node_count(group.type, degree_));
    for (std::size_t m = 0; m < group.nodes.size(); ++m)
    {
      Index& node = group.nodes[m];
      if (node < 0 || node >= count - first_node_)
        in_.fail(fmt::format("{} {} of {}: node {} is number {}, outside 0..{}", element_name(group.type),
                             m / width + 1, group.name.empty() ? "NELEM" : group.name, m % width + 1, node,
                             count - first_node_ - 1));
      node += first_node_;
    }
  }

  void read_points(Index count)
  {
    if (has_points_)
      in_.fail("NPOIN= twice in one zone");
    has_points_ = true;
    mesh_.nodes.reserve(mesh_.nodes.size() + static_cast<std::size_t>(count));
    for (Index m = 0; m < count; ++m)
    {
      if (!read_line())
        in_.fail(fmt::format("ends after {} of {} points", m, count));
      Line_numbers numbers(in_, line_);
      Point point;
      for (std::size_t axis = 0; axis < 3; ++axis)
      {
        point[axis] = numbers.next<double>("a coordinate");
        if (!std::isfinite(point[axis]))
          in_.fail(fmt::format("point {}: coordinate {} is {}", m, "XYZ"[axis], point[axis]));
      }
      mesh_.nodes.push_back(point);
    }
  }

  Su2_type read_type(Line_numbers& numbers, int dimension)
  {
    const auto code = numbers.next<Index>("the type of an element");
    const auto type = find_type(code);
    if (!type || reference_element(type->type).dimension != dimension)
      in_.fail(fmt::format("type {} is no element of dimension {} that is read", code, dimension));
    if (degree_ != 0 && type->degree != degree_)
      in_.fail(fmt::format("type {}, of degree {}, in a mesh of degree {}: only meshes of one degree are read", code,
                           type->degree, degree_));
    degree_ = type->degree;
    return *type;
  }

  /// appends the nodes of the element on the line, in canonical order. Linear elements have their corners in the order
  /// of VTK, which is the canonical one.
  void add_nodes(Line_numbers& numbers, const Su2_type& type, std::vector<Index>& nodes)
  {
    const auto width = static_cast<std::size_t>(node_count(type.type, type.degree));
    std::array<Index, 343> row = {}; // of a hexahedron of degree 6
    for (std::size_t m = 0; m < width; ++m)
      row[m] = numbers.next<Index>("the number of a node");
    if (type.degree == 1)
      nodes.insert(nodes.end(), row.begin(), row.begin() + static_cast<std::ptrdiff_t>(width));
    else
      for (const int foreign : foreign_of_canonical(Node_order::rows, type.type, type.degree))
        nodes.push_back(row[static_cast<std::size_t>(foreign)]);
  }

  void read_cells(Index count)
  {
    if (has_cells_)
      in_.fail("NELEM= twice in one zone");
    has_cells_ = true;
    for (Index m = 0; m < count; ++m)
    {
      if (!read_line())
        in_.fail(fmt::format("ends after {} of {} elements", m, count));
      Line_numbers numbers(in_, line_);
      const Su2_type type = read_type(numbers, 3);
      const auto [entry, is_new] = cell_groups_.try_emplace(type.type, mesh_.cells.size());
      if (is_new)
        mesh_.cells.push_back(
          {static_cast<Index>(mesh_.zone_names.size()), std::string(element_name(type.type)), type.type, {}});
      add_nodes(numbers, type, mesh_.cells[entry->second].nodes);
    }
  }

  void begin_marker(std::string name)
  {
    marker_ = std::move(name);
    if (marker_.empty())
      in_.fail("MARKER_TAG= without a name");
  }

  void read_faces(Index count)
  {
    if (marker_.empty())
      in_.fail("MARKER_ELEMS= without a MARKER_TAG= before it");
    if (marker_ == "SEND_RECEIVE")
    {
      ++send_receive_;
      for (Index m = 0; m < count && read_line(); ++m)
        if (line_.find('=') != std::string::npos)
          --m; // SEND_RECV= stands between
      return;
    }
    const Index patch = patch_of(marker_);
    std::map<Element_type, std::size_t> groups;
    for (Index m = 0; m < count; ++m)
    {
      if (!read_line())
        in_.fail(fmt::format("ends after {} of {} elements of marker '{}'", m, count, marker_));
      Line_numbers numbers(in_, line_);
      const Su2_type type = read_type(numbers, 2);
      const auto [entry, is_new] = groups.try_emplace(type.type, mesh_.faces.size());
      if (is_new)
        mesh_.faces.push_back({patch, marker_, type.type, {}});
      add_nodes(numbers, type, mesh_.faces[entry->second].nodes);
    }
    if (groups.size() > 1)
      for (const auto& [type, group] : groups)
        mesh_.faces[group].name = fmt::format("{}_{}", marker_, element_name(type));
  }

  Index patch_of(const std::string& name)
  {
    const auto [entry, is_new] = patches_.try_emplace(name, static_cast<Index>(mesh_.patches.size()));
    if (is_new)
      mesh_.patches.push_back({.name = name, .kind = "BCTypeUserDefined", .family = {}, .faces = {}});
    return entry->second;
  }

  void note_left_out()
  {
    if (send_receive_ > 0)
      notes_.push_back(fmt::format("SEND_RECEIVE markers of a partitioned mesh, left out: {}", send_receive_));
    if (has_periodic_)
      notes_.push_back("periodic maps are left out: the file does not say which nodes meet");
  }

  Input_file in_;
  std::string line_, marker_;
  Grouped_mesh mesh_;
  std::vector<std::string> notes_;
  std::map<Element_type, std::size_t> cell_groups_; ///< of the running zone
  std::map<std::string, Index> patches_;
  std::size_t checked_cells_ = 0, checked_faces_ = 0; ///< groups whose nodes are checked
  Index first_node_ = 0;                              ///< of the running zone
  int degree_ = 0;
  Index send_receive_ = 0;
  bool has_dimension_ = false, has_zones_ = false, has_points_ = false, has_cells_ = false, has_periodic_ = false;
};

} // namespace

Zonal_mesh read_su2(const std::filesystem::path& file, Read_report* report, const Progress_callback& progress)
try
{
  return Su2_reader(file, progress).read(report);
}
catch (const std::bad_alloc&)
{
  throw Format_error(fmt::format("{}: takes more memory than there is", file.string()));
}

} // namespace recurve
