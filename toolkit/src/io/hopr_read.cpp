#include "grouped_mesh.h"
#include "hdf5_file.h"

#include <recurve/core/exceptions.h>
#include <recurve/elements/node_layout.h>
#include <recurve/io/hopr.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <new>
#include <optional>
#include <span>
#include <utility>

namespace recurve {

namespace {

using internal::Grouped_mesh;
using internal::Hdf5_file;

/// Rows that are read at a time.
constexpr Index rows_at_a_time = Index(1) << 15;

/// Periodic sides are translated if their nodes agree on one vector up to this part of its length.
constexpr double translation_tolerance = 1e-6;

std::optional<Element_type> type_of(std::int64_t code)
{
  switch (code % 100 % 10)
  {
  case 4: return Element_type::tetrahedron;
  case 5: return Element_type::pyramid;
  case 6: return Element_type::prism;
  case 8: return Element_type::hexahedron;
  default: return std::nullopt;
  }
}

class Hopr_reader
{
public:
  Hopr_reader(const std::filesystem::path& file, const Progress_callback& progress)
    : file_(file, Hdf5_file::Mode::read), progress_(progress)
  {}

  Zonal_mesh read(Read_report* report)
  {
    read_header();
    read_nodes();
    read_elements();
    read_conditions();
    read_sides();
    Zonal_mesh result = to_zonal_mesh(std::move(mesh_), notes_);
    if (report != nullptr)
      report->notes.insert(report->notes.end(), notes_.begin(), notes_.end());
    return result;
  }

private:
  /// the number of rows of a two-dimensional array with at least `columns` columns, or of an array of one dimension if
  /// `columns` is 0. Sets `width` to the columns that there are.
  Index rows_of(const std::string& name, Index columns, Index* width = nullptr) const
  {
    const std::vector<Index> shape = file_.shape(name);
    if (shape.size() != (columns > 0 ? 2U : 1U) || (columns > 0 && shape[1] < columns))
      file_.fail(fmt::format("array {} has not the shape of one of HOPR", name));
    file_.check_size(name);
    if (width != nullptr)
      *width = shape[1];
    return shape[0];
  }

  void expect_rows(const std::string& name, Index found, Index expected) const
  {
    if (found != expected)
      file_.fail(fmt::format("array {} has {} rows, expected {}", name, found, expected));
  }

  template <class Number, class Visit>
  void visit_rows(const std::string& name, Index rows, Index columns, const Visit& visit) const
  {
    std::vector<Number> values;
    for (Index first = 0; first < rows; first += rows_at_a_time)
    {
      values.resize(static_cast<std::size_t>(std::min(rows_at_a_time, rows - first) * columns));
      file_.read_rows(name, first, columns, std::span<Number>(values));
      for (std::size_t m = 0; m < values.size(); m += static_cast<std::size_t>(columns))
        visit(first + static_cast<Index>(m) / columns,
              std::span<const Number>(values).subspan(m, static_cast<std::size_t>(columns)));
    }
  }

  void read_header()
  {
    const std::int64_t degree = file_.read_integer_attribute("Ngeo");
    if (degree < 1 || degree > max_degree)
      file_.fail(fmt::format("Ngeo is {}: elements of degree 1 to {} are read", degree, max_degree));
    mesh_.degree = static_cast<int>(degree);
    element_count_ = rows_of("ElemInfo", 6, &element_width_);
    side_count_ = rows_of("SideInfo", 5, &side_width_);
    node_count_ = rows_of("NodeCoords", 3);
    expect_rows("GlobalNodeIDs", rows_of("GlobalNodeIDs", 0), node_count_);
    if (element_count_ == 0)
      file_.fail("has no elements: the mesh is empty");
    for (const auto& [name, rows] :
         {std::pair("nElems", element_count_), std::pair("nSides", side_count_), std::pair("nNodes", node_count_)})
      if (file_.read_integer_attribute(name) != rows)
        file_.fail(
          fmt::format("attribute {} is {}, but the array has {} rows", name, file_.read_integer_attribute(name), rows));
  }

  /// gives every unique node its position; numbers may have gaps.
  void read_nodes()
  {
    ids_.reserve(static_cast<std::size_t>(node_count_));
    visit_rows<std::int64_t>("GlobalNodeIDs", node_count_, 1, [&](Index row, std::span<const std::int64_t> id) {
      if (id[0] < 1 || id[0] > node_count_)
        file_.fail(fmt::format("GlobalNodeIDs, row {}: number {} is outside 1..{}", row + 1, id[0], node_count_));
      ids_.push_back(id[0]);
    });
    std::vector<Index> position(static_cast<std::size_t>(node_count_) + 1, no_index);
    for (const Index id : ids_)
      position[static_cast<std::size_t>(id)] = 0;
    Index unique = 0;
    for (Index& node : position)
      if (node == 0)
        node = unique++;
    mesh_.nodes.resize(static_cast<std::size_t>(unique));
    std::vector<bool> is_set(static_cast<std::size_t>(unique), false);
    Index differing = 0;
    visit_rows<double>("NodeCoords", node_count_, 3, [&](Index row, std::span<const double> x) {
      Index& id = ids_[static_cast<std::size_t>(row)];
      for (std::size_t axis = 0; axis < 3; ++axis)
        if (!std::isfinite(x[axis]))
          file_.fail(
            fmt::format("NodeCoords, row {} (node {}): coordinate {} is {}", row + 1, id, "XYZ"[axis], x[axis]));
      id = position[static_cast<std::size_t>(id)];
      const Point point = {x[0], x[1], x[2]};
      Point& node = mesh_.nodes[static_cast<std::size_t>(id)];
      if (!is_set[static_cast<std::size_t>(id)])
        node = point;
      else
        differing += node != point;
      is_set[static_cast<std::size_t>(id)] = true;
    });
    if (differing > 0)
      notes_.push_back(fmt::format("nodes that elements share and place differently, as in the first: {}", differing));
    report_progress(progress_, "read", 0.5);
  }

  void read_elements()
  {
    Index next_side = 0, next_node = 0;
    std::map<std::int64_t, Index> zones;
    std::vector<std::int64_t> zone_numbers;
    visit_rows<std::int64_t>(
      "ElemInfo", element_count_, element_width_, [&](Index row, std::span<const std::int64_t> info) {
        const auto type = type_of(info[0]);
        if (!type || info[0] < 100)
          file_.fail(fmt::format("ElemInfo, element {}: type {} is no cell", row + 1, info[0]));
        if (info[2] != next_side || info[3] < info[2] || info[3] > side_count_ || info[4] != next_node ||
            info[5] < info[4] || info[5] > node_count_)
          file_.fail(fmt::format("ElemInfo, element {}: its sides {}..{} or nodes {}..{} do not follow those before",
                                 row + 1, info[2] + 1, info[3], info[4] + 1, info[5]));
        next_side = info[3];
        next_node = info[5];
        if (info[5] - info[4] != node_count(*type, mesh_.degree))
          file_.fail(fmt::format("ElemInfo, element {}: {} nodes for a {} of degree {}", row + 1, info[5] - info[4],
                                 element_name(*type), mesh_.degree));
        if (info[3] - info[2] != reference_element(*type).face_count)
          file_.fail(fmt::format("ElemInfo, element {}: {} sides for a {}: hanging nodes (mortars) are not read",
                                 row + 1, info[3] - info[2], element_name(*type)));
        types_.push_back(*type);
        first_node_.push_back(info[4]);
        zones.try_emplace(info[1], 0);
        zone_numbers.push_back(info[1]);
      });
    if (next_side != side_count_ || next_node != node_count_)
      file_.fail("ElemInfo does not use all rows of SideInfo and NodeCoords");
    name_zones(zones);
    add_cells(zones, zone_numbers);
  }

  void name_zones(std::map<std::int64_t, Index>& zones)
  {
    const std::vector<std::string> names =
      file_.has("ZoneNames") ? file_.read_texts("ZoneNames") : std::vector<std::string>();
    for (auto& [number, zone] : zones)
    {
      zone = static_cast<Index>(mesh_.zone_names.size());
      const bool is_named = number >= 1 && number <= static_cast<std::int64_t>(names.size());
      std::string name = is_named ? names[static_cast<std::size_t>(number - 1)] : fmt::format("zone_{}", number);
      if (std::find(mesh_.zone_names.begin(), mesh_.zone_names.end(), name) != mesh_.zone_names.end())
        name += fmt::format("_{}", number);
      mesh_.zone_names.push_back(name);
    }
  }

  void add_cells(const std::map<std::int64_t, Index>& zones, const std::vector<std::int64_t>& zone_numbers)
  {
    using Zone_and_type = std::pair<std::int64_t, Element_type>;
    std::map<Zone_and_type, std::size_t> groups;
    Zone_and_type last = {};
    std::vector<Index>* nodes = nullptr;
    std::span<const int> order;
    for (std::size_t element = 0; element < types_.size(); ++element)
    {
      const Element_type type = types_[element];
      // Neighbours mostly belong together.
      if (const Zone_and_type key = {zone_numbers[element], type}; nodes == nullptr || key != last)
      {
        const auto [entry, is_new] = groups.try_emplace(key, mesh_.cells.size());
        if (is_new)
          mesh_.cells.push_back({zones.at(key.first), std::string(element_name(type)), type, {}});
        nodes = &mesh_.cells[entry->second].nodes;
        order = foreign_of_canonical(Node_order::rows, type, mesh_.degree);
        last = key;
      }
      for (const int place : order)
        nodes->push_back(ids_[static_cast<std::size_t>(first_node_[element] + place)]);
    }
  }

  /// node of the mesh: canonical node `m` of an element.
  Index node_of(std::size_t element, int m) const
  {
    const std::span<const int> order = foreign_of_canonical(Node_order::rows, types_[element], mesh_.degree);
    return ids_[static_cast<std::size_t>(first_node_[element] + order[static_cast<std::size_t>(m)])];
  }

  void read_conditions()
  {
    const std::vector<std::string> names = file_.read_texts("BCNames");
    const Index count = rows_of("BCType", 4);
    expect_rows("BCType", count, static_cast<Index>(names.size()));
    visit_rows<std::int64_t>(
      "BCType", count, file_.shape("BCType")[1], [&](Index row, std::span<const std::int64_t> type) {
        mesh_.patches.push_back(
          {.name = names[static_cast<std::size_t>(row)], .kind = kind_of(type[0]), .family = {}, .faces = {}});
        condition_types_.push_back(type[0]);
      });
    for (std::size_t p = 0; p < mesh_.patches.size(); ++p)
      for (std::size_t q = 0; q < p; ++q)
        if (mesh_.patches[p].name == mesh_.patches[q].name)
          mesh_.patches[p].name += fmt::format("_{}", p + 1);
  }

  static std::string kind_of(std::int64_t type)
  {
    if (type == 3 || type == 4)
      return "BCWallViscous";
    return type == 9 ? "BCWallInviscid" : "BCTypeUserDefined";
  }

  void read_sides()
  {
    std::map<std::pair<std::int64_t, Element_type>, std::vector<Index>> faces;
    std::map<std::int64_t, std::vector<std::pair<Index, Index>>> periodic;
    std::size_t element = 0;
    int local = 0;
    visit_rows<std::int64_t>("SideInfo", side_count_, side_width_, [&](Index row, std::span<const std::int64_t> info) {
      while (local == reference_element(types_[element]).face_count)
      {
        ++element;
        local = 0;
      }
      if (info[0] < 0 || info[2] < 0)
        file_.fail(fmt::format("SideInfo, row {}: hanging nodes (mortars) are not read", row + 1));
      add_side(row, element, local++, info, faces, periodic);
    });
    for (auto& [key, nodes] : faces)
    {
      const std::string& name = mesh_.patches[static_cast<std::size_t>(key.first - 1)].name;
      const bool has_both =
        faces.count({key.first, Element_type::triangle}) > 0 && faces.count({key.first, Element_type::quadrangle}) > 0;
      mesh_.faces.push_back({key.first - 1, has_both ? fmt::format("{}_{}", name, element_name(key.second)) : name,
                             key.second, std::move(nodes)});
    }
    for (auto& [condition, pairs] : periodic)
      add_periodic(condition, pairs);
    report_progress(progress_, "read", 1);
  }

  template <class Faces, class Periodic>
  void add_side(Index row, std::size_t element, int local, std::span<const std::int64_t> info, Faces& faces,
                Periodic& periodic)
  {
    const std::int64_t condition = info[4];
    if (condition == 0)
      return;
    if (condition < 0 || condition > static_cast<std::int64_t>(mesh_.patches.size()))
      file_.fail(fmt::format("SideInfo, row {}: boundary condition {} is outside 1..{}", row + 1, condition,
                             mesh_.patches.size()));
    const std::int64_t type = condition_types_[static_cast<std::size_t>(condition - 1)];
    if (type == 100 && info[1] < 0)
      return; // a face inside the mesh, which its master lists
    const Reference_face& face = reference_element(types_[element]).faces[static_cast<std::size_t>(local)];
    std::vector<Index>& nodes = faces[{condition, face.type}];
    for (const int m : face_nodes(types_[element], mesh_.degree, local))
      nodes.push_back(node_of(element, m));
    if (type == 1 && info[1] > 0 && info[2] > 0)
      pair_corners(row, element, face, info, periodic[condition]);
  }

  void pair_corners(Index row, std::size_t element, const Reference_face& face, std::span<const std::int64_t> info,
                    std::vector<std::pair<Index, Index>>& pairs)
  {
    const std::int64_t side = info[3] / 10, flip = info[3] % 10;
    const bool is_there = info[2] <= element_count_ && side >= 1 &&
                          side <= reference_element(types_[static_cast<std::size_t>(info[2] - 1)]).face_count;
    const auto neighbor = static_cast<std::size_t>(info[2] - 1);
    const Reference_face* const other =
      is_there ? &reference_element(types_[neighbor]).faces[static_cast<std::size_t>(side - 1)] : nullptr;
    if (other == nullptr || other->corner_count != face.corner_count || flip < 1 || flip > face.corner_count)
      file_.fail(
        fmt::format("SideInfo, row {}: there is no side {} of element {} with flip {}", row + 1, side, info[2], flip));
    for (int c = 0; c < face.corner_count; ++c)
    {
      const auto there = static_cast<std::size_t>((flip - 1 - c + face.corner_count) % face.corner_count);
      pairs.push_back(
        {node_of(element, face.corners[static_cast<std::size_t>(c)]), node_of(neighbor, other->corners[there])});
    }
  }

  void add_periodic(std::int64_t condition, std::vector<std::pair<Index, Index>>& pairs)
  {
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    internal::Periodic_nodes periodic;
    for (const auto& [a, b] : pairs)
    {
      const Point &from = mesh_.nodes[static_cast<std::size_t>(a)], &to = mesh_.nodes[static_cast<std::size_t>(b)];
      const Point step = {to[0] - from[0], to[1] - from[1], to[2] - from[2]};
      if (&pairs.front().first == &a)
        periodic.map.translation = step;
      const Point& shift = periodic.map.translation;
      const double length = std::hypot(shift[0], shift[1], shift[2]);
      for (std::size_t axis = 0; axis < 3; ++axis)
        if (!(std::abs(step[axis] - shift[axis]) <= translation_tolerance * length))
        {
          notes_.push_back(
            fmt::format("boundary condition '{}': its periodic sides are not translated; the connection is "
                        "left out",
                        mesh_.patches[static_cast<std::size_t>(condition - 1)].name));
          return;
        }
    }
    periodic.pairs = std::move(pairs);
    mesh_.periodic.push_back(std::move(periodic));
  }

  Hdf5_file file_;
  const Progress_callback& progress_;
  Grouped_mesh mesh_;
  std::vector<std::string> notes_;
  Index element_count_ = 0, side_count_ = 0, node_count_ = 0;
  Index element_width_ = 6, side_width_ = 5;
  std::vector<Index> ids_; ///< per row of NodeCoords: node of the mesh
  std::vector<Element_type> types_;
  std::vector<Index> first_node_;
  std::vector<std::int64_t> condition_types_;
};

} // namespace

Zonal_mesh read_hopr(const std::filesystem::path& file, Read_report* report, const Progress_callback& progress)
try
{
  report_progress(progress, "read", 0);
  return Hopr_reader(file, progress).read(report);
}
catch (const std::bad_alloc&)
{
  throw Format_error(fmt::format("{}: takes more memory than there is", file.string()));
}

} // namespace recurve
