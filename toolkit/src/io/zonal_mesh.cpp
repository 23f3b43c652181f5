#include <recurve/io/zonal_mesh.h>

#include <recurve/core/exceptions.h>
#include <recurve/elements/node_layout.h>
#include <recurve/mesh/join_zones.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <span>
#include <utility>

namespace recurve {

namespace {

/// Nodes of an edge or face of two zones are the same node when they are no further apart than this part of the
/// distance of its corners: the tolerance of join_zones().
constexpr double joining_tolerance = 1e-4;

// Points that are no corner leave the linear mesh.
// ---------------------------------------------------------------------

enum class Role : std::uint8_t
{
  unused,
  inner, ///< node of an element, never a corner
  corner
};

std::vector<Role> roles_of_points(const Zone& linear, const Zonal_elements& elements)
{
  std::vector<Role> roles(linear.points.size(), Role::unused);
  for (const auto* sections : {&elements.cells, &elements.faces, &elements.bars})
    for (const Curved_section& section : *sections)
      for (const Index node : section.nodes)
        roles[static_cast<std::size_t>(node)] = Role::inner;
  for (const auto* sections : {&linear.cells, &linear.faces, &linear.bars})
    for (const Section& section : *sections)
      for (const Index node : section.nodes)
        roles[static_cast<std::size_t>(node)] = Role::corner;
  return roles;
}

/// Where the points of a zone go: those of the linear zone first, each group in its order.
struct Split_points
{
  std::vector<Index> new_number;
  Index linear_count = 0;
};

Split_points split_points(const std::vector<Role>& roles)
{
  Split_points split;
  split.linear_count = std::count_if(roles.begin(), roles.end(), [](Role role) { return role != Role::inner; });
  Index next_linear = 0, next_inner = split.linear_count;
  split.new_number.reserve(roles.size());
  for (const Role role : roles)
    split.new_number.push_back(role == Role::inner ? next_inner++ : next_linear++);
  return split;
}

template <class Sections>
void renumber(Sections& sections, const std::vector<Index>& new_number)
{
  for (auto& section : sections)
    for (Index& node : section.nodes)
      node = new_number[static_cast<std::size_t>(node)];
}

/// keeps the pairs of points that are corners on both sides.
void renumber(Zone_interface& interface, const Split_points& own, const Split_points& donor)
{
  if (interface.location != Zone_interface::Location::vertex ||
      interface.points.size() != interface.donor_points.size())
    return;
  std::size_t kept = 0;
  for (std::size_t m = 0; m < interface.points.size(); ++m)
  {
    const Index a = own.new_number[static_cast<std::size_t>(interface.points[m])];
    const Index b = donor.new_number[static_cast<std::size_t>(interface.donor_points[m])];
    if (a >= own.linear_count || b >= donor.linear_count)
      continue;
    interface.points[kept] = a;
    interface.donor_points[kept++] = b;
  }
  interface.points.resize(kept);
  interface.donor_points.resize(kept);
}

void renumber_interfaces(Volume_mesh& linear, const std::vector<Split_points>& splits)
{
  for (std::size_t z = 0; z < linear.zones.size(); ++z)
    for (Zone_interface& interface : linear.zones[z].interfaces)
      for (std::size_t d = 0; d < linear.zones.size(); ++d)
        if (linear.zones[d].name == interface.donor_zone)
        {
          renumber(interface, splits[z], splits[d]);
          break;
        }
}

// Faces without nodes take them from their cells.
// ----------------------------------------------------------------------

std::array<Index, 4> sorted_corners(std::span<const Index> corners)
{
  std::array<Index, 4> key = {no_index, no_index, no_index, no_index};
  std::copy(corners.begin(), corners.end(), key.begin());
  std::sort(key.begin(), key.end());
  return key;
}

/// Where the nodes of a face have to be written, and its corners in its own order.
struct Wanted_face
{
  Index* nodes;
  std::array<Index, 4> corners;
};

void take_nodes(const Wanted_face& face, Element_type face_type, int degree, std::span<const Index> cell_nodes,
                std::span<const int> numbers)
{
  const int corners = corner_count(face_type);
  int first = 0;
  while (cell_nodes[static_cast<std::size_t>(numbers[static_cast<std::size_t>(first)])] != face.corners[0])
    ++first;
  const Index next = cell_nodes[static_cast<std::size_t>(numbers[static_cast<std::size_t>((first + 1) % corners)])];
  const std::span<const int> order = face_orientation(face_type, degree, first, next != face.corners[1]);
  for (std::size_t m = 0; m < order.size(); ++m)
    face.nodes[m] = cell_nodes[static_cast<std::size_t>(numbers[static_cast<std::size_t>(order[m])])];
}

using Wanted_faces = std::multimap<std::array<Index, 4>, Wanted_face>;

Wanted_faces missing_faces(const Zone& linear, Zonal_elements& elements, int degree)
{
  Wanted_faces wanted;
  for (std::size_t s = elements.faces.size(); s < linear.faces.size(); ++s)
  {
    const Section& section = linear.faces[s];
    const auto corners = static_cast<std::size_t>(corner_count(section.type));
    const auto width = static_cast<std::size_t>(node_count(section.type, degree));
    elements.faces.push_back({section.name, section.type, std::vector<Index>(width * section.nodes.size() / corners)});
    for (std::size_t face = 0; face * corners < section.nodes.size(); ++face)
    {
      const std::span<const Index> own(section.nodes.data() + face * corners, corners);
      Wanted_face entry = {elements.faces.back().nodes.data() + face * width, {}};
      std::copy(own.begin(), own.end(), entry.corners.begin());
      wanted.emplace(sorted_corners(own), entry);
    }
  }
  return wanted;
}

void add_missing_faces(const Zone& linear, Zonal_elements& elements, int degree)
{
  if (elements.faces.size() == linear.faces.size())
    return;
  Wanted_faces wanted = missing_faces(linear, elements, degree);
  for (const Curved_section& section : elements.cells)
  {
    const Reference_element& reference = reference_element(section.type);
    const auto width = static_cast<std::size_t>(node_count(section.type, degree));
    for (std::size_t first = 0; first < section.nodes.size() && !wanted.empty(); first += width)
      for (int f = 0; f < reference.face_count; ++f)
      {
        const std::span<const Index> nodes(section.nodes.data() + first, width);
        const Reference_face& face = reference.faces[static_cast<std::size_t>(f)];
        std::array<Index, 4> corners = {};
        for (std::size_t c = 0; c < static_cast<std::size_t>(face.corner_count); ++c)
          corners[c] = nodes[static_cast<std::size_t>(face.corners[c])];
        const auto [begin, end] = wanted.equal_range(
          sorted_corners(std::span<const Index>(corners.data(), static_cast<std::size_t>(face.corner_count))));
        for (auto entry = begin; entry != end; ++entry)
          take_nodes(entry->second, face.type, degree, nodes, face_nodes(section.type, degree, f));
        wanted.erase(begin, end);
      }
  }
  if (!wanted.empty())
    throw Input_error(fmt::format("zone '{}': {} faces are no side of a cell, so that their nodes are unknown",
                                  linear.name, wanted.size()));
}

// The nodes of all zones under one number.
// -----------------------------------------------------------------------------

/// An edge or face that several zones may share: its vertices, ascending, from the canonical side.
using Item_key = std::array<Index, 4>;

/// Gives numbers to the nodes that are no corners; shared ones get one.
class Node_numbering
{
public:
  Node_numbering(const Joined_zones& joined, Curved_mesh& mesh, int degree)
    : joined_(joined), mesh_(mesh), degree_(degree), zones_of_vertex_(static_cast<std::size_t>(joined.vertex_count), 0)
  {
    for (const std::vector<Index>& vertices : joined.vertex_of_point)
      for (const Index vertex : vertices)
        if (zones_of_vertex_[static_cast<std::size_t>(vertex)] < 2)
          ++zones_of_vertex_[static_cast<std::size_t>(vertex)];
  }

  /// numbers of all nodes of zone `z` in the mesh. `points` are those of the linear zone, then the others.
  std::vector<Index> number_zone(std::size_t z, const Zonal_elements& elements, std::span<const Point> points)
  {
    std::vector<Index> numbers = joined_.vertex_of_point[z];
    const std::size_t linear_count = numbers.size();
    numbers.resize(points.size(), no_index);
    if (joined_.vertex_of_point.size() > 1 && degree_ > 1)
      for (const Curved_section& section : elements.cells)
        share_nodes(section, points, numbers);
    for (std::size_t m = linear_count; m < points.size(); ++m)
      if (numbers[m] == no_index)
      {
        numbers[m] = static_cast<Index>(mesh_.nodes.size());
        mesh_.nodes.push_back(points[m]);
      }
    fill_new_items(numbers);
    return numbers;
  }

  Index moved_count() const { return moved_; }
  double largest_gap() const { return largest_gap_; }

private:
  bool is_shared(std::span<const Index> vertices) const
  {
    return std::all_of(vertices.begin(), vertices.end(),
                       [this](Index vertex) { return zones_of_vertex_[static_cast<std::size_t>(vertex)] > 1; });
  }

  void share_nodes(const Curved_section& section, std::span<const Point> points, std::vector<Index>& numbers)
  {
    const Reference_element& reference = reference_element(section.type);
    const auto width = static_cast<std::size_t>(node_count(section.type, degree_));
    for (std::size_t first = 0; first < section.nodes.size(); first += width)
    {
      const std::span<const Index> nodes(section.nodes.data() + first, width);
      for (int e = 0; e < reference.edge_count; ++e)
        share_edge(section.type, nodes, e, points, numbers);
      for (int f = 0; f < reference.face_count; ++f)
        share_face(section.type, nodes, f, points, numbers);
    }
  }

  void share_edge(Element_type type, std::span<const Index> nodes, int edge, std::span<const Point> points,
                  std::vector<Index>& numbers)
  {
    const auto& ends = reference_element(type).edges[static_cast<std::size_t>(edge)];
    const std::array<Index, 2> vertices = {numbers[at(nodes, ends[0])], numbers[at(nodes, ends[1])]};
    if (!is_shared(vertices) || vertices[0] == vertices[1])
      return;
    inside_.clear();
    const int first = first_edge_node(type, degree_, edge);
    for (int k = 0; k < degree_ - 1; ++k)
      inside_.push_back(nodes[static_cast<std::size_t>(first + (vertices[0] < vertices[1] ? k : degree_ - 2 - k))]);
    share_item({std::min(vertices[0], vertices[1]), std::max(vertices[0], vertices[1]), no_index, no_index},
               distance(points[at(nodes, ends[0])], points[at(nodes, ends[1])]), points, numbers);
  }

  void share_face(Element_type type, std::span<const Index> nodes, int face, std::span<const Point> points,
                  std::vector<Index>& numbers)
  {
    const Reference_face& reference = reference_element(type).faces[static_cast<std::size_t>(face)];
    const auto count = static_cast<std::size_t>(reference.corner_count);
    std::array<Index, 4> vertices = {no_index, no_index, no_index, no_index};
    for (std::size_t c = 0; c < count; ++c)
      vertices[c] = numbers[at(nodes, reference.corners[c])];
    if (interior_node_count(reference.type, degree_) == 0 || !is_shared(std::span(vertices).first(count)))
      return;
    const auto smallest = std::min_element(vertices.begin(), vertices.begin() + reference.corner_count);
    const auto first = static_cast<std::size_t>(smallest - vertices.begin());
    const bool is_reversed = vertices[(first + count - 1) % count] < vertices[(first + 1) % count];
    const std::span<const int> order = face_orientation(reference.type, degree_, static_cast<int>(first), is_reversed);
    const std::span<const int> in_cell = face_nodes(type, degree_, face);
    inside_.clear();
    for (auto m = static_cast<std::size_t>(first_interior_node(reference.type, degree_)); m < order.size(); ++m)
      inside_.push_back(nodes[static_cast<std::size_t>(in_cell[static_cast<std::size_t>(order[m])])]);
    share_item(sorted_corners(std::span<const Index>(vertices).first(count)),
               distance(points[at(nodes, reference.corners[0])], points[at(nodes, reference.corners[1])]), points,
               numbers);
  }

  /// takes the numbers that an earlier zone gave to `inside_`, or leaves a mark to note those that this zone will give.
  void share_item(const Item_key& key, double length, std::span<const Point> points, std::vector<Index>& numbers)
  {
    const auto found = items_.find(key);
    if (found == items_.end())
    {
      new_items_.emplace(key, inside_);
      return;
    }
    for (std::size_t m = 0; m < inside_.size(); ++m)
    {
      Index& number = numbers[static_cast<std::size_t>(inside_[m])];
      const Point& theirs = mesh_.nodes[static_cast<std::size_t>(found->second[m])];
      const Point& own = points[static_cast<std::size_t>(inside_[m])];
      const double gap = distance(own, theirs);
      if (number != no_index || gap > joining_tolerance * length)
        continue;
      number = found->second[m];
      if (own == theirs)
        continue;
      ++moved_;
      largest_gap_ = std::max(largest_gap_, gap);
    }
  }

  void fill_new_items(const std::vector<Index>& numbers)
  {
    for (auto& [key, nodes] : new_items_)
    {
      for (Index& node : nodes)
        node = numbers[static_cast<std::size_t>(node)];
      items_.emplace(key, std::move(nodes));
    }
    new_items_.clear();
  }

  static std::size_t at(std::span<const Index> nodes, int corner)
  {
    return static_cast<std::size_t>(nodes[static_cast<std::size_t>(corner)]);
  }

  static double distance(const Point& a, const Point& b) { return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]); }

  const Joined_zones& joined_;
  Curved_mesh& mesh_;
  int degree_;
  std::vector<std::uint8_t> zones_of_vertex_; ///< 2: two or more
  std::map<Item_key, std::vector<Index>> items_, new_items_;
  std::vector<Index> inside_; ///< points of the zone inside the edge or face at hand, in canonical order
  Index moved_ = 0;
  double largest_gap_ = 0;
};

std::vector<Curved_section> as_curved(const std::vector<Section>& sections)
{
  std::vector<Curved_section> result;
  result.reserve(sections.size());
  for (const Section& section : sections)
    result.push_back({section.name, section.type, section.nodes});
  return result;
}

/// moves the points of the linear zone to the front of `zone.points`, all of which are returned; `zone` keeps the
/// linear ones.
std::vector<Point> take_points(Zone& zone, Zonal_elements& elements, const Split_points& split)
{
  for (auto* sections : {&zone.cells, &zone.faces, &zone.bars})
    renumber(*sections, split.new_number);
  for (auto* sections : {&elements.cells, &elements.faces, &elements.bars})
    renumber(*sections, split.new_number);
  std::vector<Point> points(zone.points.size());
  for (std::size_t m = 0; m < points.size(); ++m)
    points[static_cast<std::size_t>(split.new_number[m])] = zone.points[m];
  zone.points.assign(points.begin(), points.begin() + split.linear_count);
  return points;
}

void list_nodes(Curved_zone& zone, const std::vector<Index>& numbers, std::size_t linear_count)
{
  zone.nodes = numbers;
  const auto others = zone.nodes.begin() + static_cast<std::ptrdiff_t>(linear_count);
  if (!std::is_sorted(others, zone.nodes.end())) // as they are in the first zone
    std::sort(others, zone.nodes.end());
  zone.nodes.erase(std::unique(others, zone.nodes.end()), zone.nodes.end());
}

void note_gaps(const Node_numbering& numbering, const Joined_zones& joined, Read_report* report)
{
  if (report == nullptr)
    return;
  double gap = numbering.largest_gap();
  for (const Joined_pair& pair : joined.pairs)
    gap = std::max(gap, pair.largest_gap);
  if (gap > 0)
    report->notes.push_back(
      fmt::format("nodes that zones share lie up to {:.3g} apart: those of the first zone count", gap));
}

} // namespace

Curved_mesh to_curved_mesh(Zonal_mesh mesh, Read_report* report)
{
  Volume_mesh& linear = mesh.linear;
  mesh.zones.resize(linear.zones.size());
  std::vector<Split_points> splits(linear.zones.size());
  std::vector<std::vector<Point>> points(linear.zones.size());
  for (std::size_t z = 0; z < linear.zones.size(); ++z)
  {
    Zonal_elements& elements = mesh.zones[z];
    if (mesh.degree == 1)
    {
      elements = {as_curved(linear.zones[z].cells), as_curved(linear.zones[z].faces), as_curved(linear.zones[z].bars)};
      points[z] = linear.zones[z].points;
      continue;
    }
    add_missing_faces(linear.zones[z], elements, mesh.degree);
    splits[z] = split_points(roles_of_points(linear.zones[z], elements));
    points[z] = take_points(linear.zones[z], elements, splits[z]);
  }
  if (mesh.degree > 1)
    renumber_interfaces(linear, splits);

  const Joined_zones joined = join_zones(linear);
  Curved_mesh result;
  result.degree = mesh.degree;
  result.nodes = joined_points(linear, joined);
  result.nodes.reserve(std::accumulate(points.begin(), points.end(), std::size_t{0},
                                       [](std::size_t sum, const auto& list) { return sum + list.size(); }));
  Node_numbering numbering(joined, result, mesh.degree);
  for (std::size_t z = 0; z < linear.zones.size(); ++z)
  {
    Zonal_elements& elements = mesh.zones[z];
    const std::vector<Index> numbers = numbering.number_zone(z, elements, points[z]);
    points[z] = {};
    for (auto* sections : {&elements.cells, &elements.faces, &elements.bars})
      renumber(*sections, numbers);
    Curved_zone zone = {{}, std::move(elements.cells), std::move(elements.faces), std::move(elements.bars), {}};
    list_nodes(zone, numbers, linear.zones[z].points.size());
    zone.is_straight.assign(static_cast<std::size_t>(linear.zones[z].cell_count()), 1);
    result.zones.push_back(std::move(zone));
  }
  note_gaps(numbering, joined, report);
  result.linear = std::move(linear);
  update_straight_cells(result);
  return result;
}

} // namespace recurve
