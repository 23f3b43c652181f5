#include <recurve/core/exceptions.h>
#include <recurve/mesh/internal/face_table.h>
#include <recurve/mesh/internal/point_clusters.h>
#include <recurve/mesh/internal/surface_topology.h>

#include <fmt/format.h>
#include <tbb/parallel_sort.h>

#include <span>
#include <tuple>

namespace recurve::internal {

namespace {

constexpr std::size_t notes_kept = 10;

/// One side of a face, seen by its joined vertices.
struct Side
{
  Index low, high;
  Index face;
  int side;
  bool is_forward; ///< runs from low to high

  friend bool operator<(const Side& a, const Side& b)
  {
    return std::tie(a.low, a.high, a.face, a.side) < std::tie(b.low, b.high, b.face, b.side);
  }
};

class Surface_builder
{
public:
  Surface_builder(const Volume_mesh& mesh, const Joined_zones& joined, const Boundary_faces& boundary,
                  const std::vector<Point>& points)
    : mesh_(mesh), joined_(joined), boundary_(boundary), points_(points)
  {}

  Surface_topology build(const std::vector<std::vector<std::uint8_t>>& is_selected)
  {
    collect_faces(is_selected);
    sort_sides();
    if (turn_inner_faces())
      sort_sides();
    make_vertices();
    make_edges();
    count_components();
    count_non_manifold_vertices();
    return std::move(result_);
  }

private:
  using Side_group = std::span<const Side>;

  // Faces ------------------------------------------------------------------------------------------------------------

  void collect_faces(const std::vector<std::vector<std::uint8_t>>& is_selected)
  {
    for (std::size_t z = 0; z < mesh_.zones.size(); ++z)
    {
      const Zone& zone = mesh_.zones[z];
      for (std::size_t p = 0; p < zone.patches.size(); ++p)
        for (const Index face : zone.patches[p].faces)
          if (is_selected[z][face])
            add_face({static_cast<Index>(z), static_cast<Index>(p), face});
    }
    leave_out_repeated_faces();
  }

  void add_face(const Patch_face& listed)
  {
    const Face_owners& owners = boundary_.owners[listed.zone][listed.face];
    if (place_of(owners) == Face_place::nowhere)
      return;
    Surface_face face;
    face.listed = listed;
    face.is_inside = place_of(owners) != Face_place::boundary;
    set_owner(face, owners.first);
    if (face_key(face.vertices, face.corner_count).count < face.corner_count)
      ++result_.report.collapsed_faces;
    else
      result_.faces.push_back(face);
  }

  void set_owner(Surface_face& face, const Cell_face& owner) const
  {
    const Zone& zone = mesh_.zones[owner.zone];
    const Section_entry entry = find_element(zone.cells, owner.cell);
    const Section& section = zone.cells[entry.section];
    const Reference_face& reference = reference_element(section.type).faces[owner.face];
    const Index* const points = section.nodes.data() + entry.element * corner_count(section.type);
    face.owner = owner;
    face.corner_count = reference.corner_count;
    for (int c = 0; c < reference.corner_count; ++c)
      face.vertices[c] = joined_.vertex_of_point[owner.zone][points[reference.corners[c]]];
  }

  /// the face by the smaller of its sides, whichever it was listed from.
  Cell_face identity(const Surface_face& face) const
  {
    const Face_owners& owners = boundary_.owners[face.listed.zone][face.listed.face];
    return face.is_inside ? std::min(owners.first, owners.second) : owners.first;
  }

  void leave_out_repeated_faces()
  {
    std::vector<std::pair<Cell_face, Index>> order;
    for (const Surface_face& face : result_.faces)
      order.emplace_back(identity(face), static_cast<Index>(order.size()));
    std::sort(order.begin(), order.end());
    std::vector<char> is_repeated(order.size(), 0);
    for (std::size_t i = 1; i < order.size(); ++i)
      is_repeated[order[i].second] = order[i].first == order[i - 1].first;
    std::size_t kept = 0;
    for (std::size_t f = 0; f < order.size(); ++f)
      if (!is_repeated[f])
        result_.faces[kept++] = result_.faces[f];
    result_.report.repeated_faces = static_cast<Index>(order.size() - kept);
    result_.faces.resize(kept);
  }

  // Sides ------------------------------------------------------------------------------------------------------------

  void sort_sides()
  {
    sides_.clear();
    for (std::size_t f = 0; f < result_.faces.size(); ++f)
    {
      const Surface_face& face = result_.faces[f];
      for (int s = 0; s < face.corner_count; ++s)
      {
        const Index from = face.vertices[s], to = face.vertices[(s + 1) % face.corner_count];
        sides_.push_back({std::min(from, to), std::max(from, to), static_cast<Index>(f), s, from < to});
      }
    }
    tbb::parallel_sort(sides_.begin(), sides_.end());
  }

  /// calls `visit` for the sides of each joined edge.
  template <class Visit>
  void visit_edges(const Visit& visit) const
  {
    for (auto first = sides_.begin(); first != sides_.end();)
    {
      const auto last = std::find_if(
        first, sides_.end(), [&](const Side& side) { return side.low != first->low || side.high != first->high; });
      visit(Side_group(first, last));
      first = last;
    }
  }

  bool is_inside(const Side& side) const { return result_.faces[side.face].is_inside; }

  /// the two faces that an edge joins, if there are two: those of the outer boundary, however many faces inside the
  /// volume end at it; or else those inside, if no other meets them.
  std::pair<const Side*, const Side*> partners(Side_group group) const
  {
    const bool has_outside = std::any_of(group.begin(), group.end(), [&](const Side& s) { return !is_inside(s); });
    std::vector<const Side*> candidates;
    for (const Side& side : group)
      if (is_inside(side) != has_outside)
        candidates.push_back(&side);
    if (candidates.size() != 2)
      return {nullptr, nullptr};
    return {candidates[0], candidates[1]};
  }

  /// Faces inside the volume have a cell on both sides; neighbours must agree which one they look away from.
  bool turn_inner_faces()
  {
    std::vector<std::vector<std::pair<Index, bool>>> neighbours(result_.faces.size()); // face, whether it runs alike
    visit_edges([&](Side_group group) {
      const auto [a, b] = partners(group);
      if (a == nullptr || !is_inside(*a))
        return;
      neighbours[a->face].emplace_back(b->face, a->is_forward == b->is_forward);
      neighbours[b->face].emplace_back(a->face, a->is_forward == b->is_forward);
    });
    std::vector<signed char> turn(result_.faces.size(), -1); // not decided yet
    for (std::size_t seed = 0; seed < turn.size(); ++seed)
    {
      if (turn[seed] >= 0 || !result_.faces[seed].is_inside)
        continue;
      turn[seed] = 0;
      std::vector<Index> front = {static_cast<Index>(seed)};
      while (!front.empty())
      {
        const Index face = front.back();
        front.pop_back();
        for (const auto& [other, runs_alike] : neighbours[face])
          if (turn[other] < 0)
          {
            turn[other] = static_cast<signed char>(turn[face] ^ static_cast<int>(runs_alike));
            front.push_back(other);
          }
      }
    }
    for (std::size_t f = 0; f < turn.size(); ++f)
      if (turn[f] == 1)
      {
        Surface_face& face = result_.faces[f];
        const Face_owners& owners = boundary_.owners[face.listed.zone][face.listed.face];
        set_owner(face, face.owner == owners.first ? owners.second : owners.first);
        ++result_.report.turned_faces;
      }
    return result_.report.turned_faces > 0;
  }

  // Vertices ---------------------------------------------------------------------------------------------------------

  static Index corner_number(const Side& side, int corner_count, bool at_end)
  {
    return 4 * side.face + (at_end ? (side.side + 1) % corner_count : side.side);
  }

  /// Corners around a joined vertex become one vertex of the surface if edges of two faces lead from one to the next: a
  /// fan or a ring. What meets only at a vertex, or at an edge of more faces, falls apart.
  void make_vertices()
  {
    Point_clusters fans(4 * static_cast<Index>(result_.faces.size()));
    visit_edges([&](Side_group group) {
      const auto [a, b] = partners(group);
      if (a == nullptr || a->is_forward == b->is_forward)
        return;
      const int a_count = result_.faces[a->face].corner_count, b_count = result_.faces[b->face].corner_count;
      fans.merge(corner_number(*a, a_count, false), corner_number(*b, b_count, true));
      fans.merge(corner_number(*a, a_count, true), corner_number(*b, b_count, false));
    });
    std::vector<std::pair<Index, Index>> roots; // joined vertex, first corner of the fan
    for (std::size_t f = 0; f < result_.faces.size(); ++f)
      for (int c = 0; c < result_.faces[f].corner_count; ++c)
        if (const Index corner = 4 * static_cast<Index>(f) + c; fans.root(corner) == corner)
          roots.emplace_back(result_.faces[f].vertices[c], corner);
    tbb::parallel_sort(roots.begin(), roots.end());
    std::vector<Index> vertex_of_corner(4 * result_.faces.size(), no_index);
    for (std::size_t v = 0; v < roots.size(); ++v)
    {
      vertex_of_corner[roots[v].second] = static_cast<Index>(v);
      result_.joined_vertex.push_back(roots[v].first);
    }
    result_.corners.resize(result_.faces.size());
    for (std::size_t f = 0; f < result_.faces.size(); ++f)
      for (int c = 0; c < result_.faces[f].corner_count; ++c)
        result_.corners[f][c] = vertex_of_corner[fans.root(4 * static_cast<Index>(f) + c)];
  }

  // Edges ------------------------------------------------------------------------------------------------------------

  Index from(const Side& side) const { return result_.corners[side.face][side.side]; }
  Index to(const Side& side) const
  {
    return result_.corners[side.face][(side.side + 1) % result_.faces[side.face].corner_count];
  }

  void make_edges()
  {
    visit_edges([&](Side_group group) {
      const auto [a, b] = partners(group);
      const bool is_manifold = group.size() == 2 && a != nullptr && a->is_forward != b->is_forward;
      result_.report.border_edges += group.size() == 1;
      if (!is_manifold && group.size() > 1)
        note_edge(group);
      add_edges(group, !is_manifold);
    });
  }

  /// Sides that run between the same two vertices of the surface, one each way, are one edge: two faces that an edge
  /// joins, and also those faces of a non-manifold edge that belong to one fan at either end (two bodies that touch
  /// along an edge stay closed). A fan has one side that leaves it and one that enters, so there is no choice.
  void add_edges(Side_group group, bool is_pinned)
  {
    for (const Side& side : group)
    {
      const auto other = std::find_if(group.begin(), group.end(),
                                      [&](const Side& s) { return from(s) == to(side) && to(s) == from(side); });
      if (other == group.end())
        result_.edges.push_back({side.face, side.side, no_index, 0, is_pinned});
      else if (side.face < other->face || (side.face == other->face && side.side < other->side))
        result_.edges.push_back({side.face, side.side, other->face, other->side, is_pinned});
    }
  }

  // Report -----------------------------------------------------------------------------------------------------------

  std::string where(Index vertex) const
  {
    const Point& x = points_[vertex];
    return fmt::format("{} at ({:.6g}, {:.6g}, {:.6g})", vertex + 1, x[0], x[1], x[2]);
  }

  void note_edge(Side_group group)
  {
    ++result_.report.non_manifold_edges;
    if (result_.report.notes.size() < notes_kept)
      result_.report.notes.push_back(fmt::format("non-manifold edge of {} faces between vertex {} and vertex {}",
                                                 group.size(), where(group[0].low), where(group[0].high)));
  }

  void count_components()
  {
    Point_clusters components(static_cast<Index>(result_.faces.size()));
    for (const Surface_edge& edge : result_.edges)
      if (edge.other_face != no_index)
        components.merge(edge.face, edge.other_face);
    std::vector<char> has_border(result_.faces.size(), 0);
    for (const Surface_edge& edge : result_.edges)
      if (edge.other_face == no_index)
        has_border[components.root(edge.face)] = 1;
    for (Index f = 0; f < static_cast<Index>(result_.faces.size()); ++f)
      if (components.root(f) == f)
      {
        ++result_.report.components;
        result_.report.closed_components += !has_border[f];
      }
  }

  void count_non_manifold_vertices()
  {
    const std::vector<Index>& joined = result_.joined_vertex; // ascending
    std::size_t noted = 0;
    for (std::size_t v = 1; v < joined.size(); ++v)
      if (joined[v] == joined[v - 1] && (v == 1 || joined[v - 2] != joined[v]))
      {
        ++result_.report.non_manifold_vertices;
        if (noted++ < notes_kept)
          result_.report.notes.push_back("non-manifold vertex " + where(joined[v]));
      }
  }

  const Volume_mesh& mesh_;
  const Joined_zones& joined_;
  const Boundary_faces& boundary_;
  const std::vector<Point>& points_;
  std::vector<Side> sides_;
  Surface_topology result_;
};

void check_selection(const Volume_mesh& mesh, const Boundary_faces& boundary,
                     const std::vector<std::vector<std::uint8_t>>& is_selected)
{
  bool matches = boundary.owners.size() == mesh.zones.size() && is_selected.size() == mesh.zones.size();
  for (std::size_t z = 0; z < mesh.zones.size() && matches; ++z)
    matches = boundary.owners[z].size() == static_cast<std::size_t>(mesh.zones[z].face_count()) &&
              is_selected[z].size() == boundary.owners[z].size();
  if (!matches)
    throw Input_error("the owners or the selection of faces do not belong to this mesh: zones or faces differ");
}

} // namespace

Surface_topology make_surface_topology(const Volume_mesh& mesh, const Joined_zones& joined,
                                       const Boundary_faces& boundary,
                                       const std::vector<std::vector<std::uint8_t>>& is_selected,
                                       const std::vector<Point>& points)
{
  check_selection(mesh, boundary, is_selected);
  return Surface_builder(mesh, joined, boundary, points).build(is_selected);
}

} // namespace recurve::internal
