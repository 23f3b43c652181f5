#ifndef RECURVE_MESH_BOUNDARY_SURFACE_H
#define RECURVE_MESH_BOUNDARY_SURFACE_H

#include <recurve/mesh/boundary_faces.h>
#include <recurve/mesh/internal/surface_topology.h>
#include <recurve/mesh/join_zones.h>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace recurve {

/// Boundary patches of all zones as one face graph, and the maps that lead back to the cells. Every face looks out of
/// its owner. The graph is a manifold with borders; where the boundary is not, several vertices (edges) of the graph
/// stand on one joined vertex (edge): take positions of nodes by joined vertices, and nothing comes apart.
///
/// The maps belong to `mesh`. The surface can be moved, not copied: maps of a copy would still read the original.
struct Boundary_surface
{
  using Mesh = CGAL::Surface_mesh<CGAL::Exact_predicates_inexact_constructions_kernel::Point_3>;
  using Vertex = Mesh::Vertex_index;
  using Edge = Mesh::Edge_index;
  using Halfedge = Mesh::Halfedge_index;
  using Face = Mesh::Face_index;
  template <class Key, class Value>
  using Map = Mesh::Property_map<Key, Value>;

  Boundary_surface() = default;
  Boundary_surface(const Boundary_surface&) = delete;
  Boundary_surface& operator=(const Boundary_surface&) = delete;
  Boundary_surface(Boundary_surface&&) = default;
  Boundary_surface& operator=(Boundary_surface&&) = default;
  ~Boundary_surface() = default;

  Mesh mesh; ///< triangles and quadrangles; source(halfedge(f)) is corner 0 of the owner's `Reference_face`, the
             ///< halfedges from there on start at its corners 1, 2, ...
  Map<Face, Cell_face> face_owner;      ///< the cell that the face looks out of
  Map<Face, Patch_face> face_patch;     ///< where the face was listed
  Map<Vertex, Index> joined_vertex;     ///< see `Joined_zones`; not decreasing from vertex to vertex
  Map<Vertex, char> vertex_is_critical; ///< on a feature curve; 0 at first
  Map<Vertex, char> vertex_is_sharp;    ///< where feature curves meet, or an isolated corner; 0 at first
  Map<Edge, char> edge_is_critical;     ///< on a feature curve; 0 at first
  Map<Edge, char> edge_is_pinned;       ///< on the border of the surface, or on a non-manifold edge
  Boundary_surface_report report;
};

namespace internal {

inline void add_vertices_and_faces(const Surface_topology& topology, const std::vector<Point>& points,
                                   Boundary_surface& surface)
{
  for (const Index joined : topology.joined_vertex)
  {
    const Point& x = points[joined];
    surface.joined_vertex[surface.mesh.add_vertex({x[0], x[1], x[2]})] = joined;
  }
  for (const Surface_face& face : topology.faces)
  {
    const Boundary_surface::Face f = surface.mesh.add_face();
    surface.face_owner[f] = face.owner;
    surface.face_patch[f] = face.listed;
  }
}

/// adds the edges, and returns the halfedge at each side of each face, four places a face.
inline std::vector<Boundary_surface::Halfedge> add_edges(const Surface_topology& topology, Boundary_surface& surface)
{
  using Vertex = Boundary_surface::Vertex;
  std::vector<Boundary_surface::Halfedge> halfedges(4 * topology.faces.size());
  for (const Surface_edge& edge : topology.edges)
  {
    const auto& corners = topology.corners[edge.face];
    const int next = (edge.side + 1) % topology.faces[edge.face].corner_count;
    const auto h = surface.mesh.add_edge(Vertex(static_cast<Vertex::size_type>(corners[edge.side])),
                                         Vertex(static_cast<Vertex::size_type>(corners[next])));
    surface.edge_is_pinned[surface.mesh.edge(h)] = edge.is_pinned;
    halfedges[4 * edge.face + edge.side] = h;
    if (edge.other_face != no_index)
      halfedges[4 * edge.other_face + edge.other_side] = surface.mesh.opposite(h);
  }
  return halfedges;
}

/// links halfedges around faces and along borders. CGAL's own `add_face` does the same from lists of vertices, but
/// searches for each halfedge and depends on the order of the faces where a vertex has several gaps.
inline void link_halfedges(const Surface_topology& topology, const std::vector<Boundary_surface::Halfedge>& halfedges,
                           Boundary_surface::Mesh& mesh)
{
  for (std::size_t f = 0; f < topology.faces.size(); ++f)
  {
    const int count = topology.faces[f].corner_count;
    const Boundary_surface::Face face(static_cast<Boundary_surface::Face::size_type>(f));
    for (int s = 0; s < count; ++s)
    {
      const auto h = halfedges[4 * f + s];
      mesh.set_face(h, face);
      mesh.set_next(h, halfedges[4 * f + (s + 1) % count]); // sets the way back too
      mesh.set_halfedge(mesh.target(h), h);
    }
    mesh.set_halfedge(face, halfedges[4 * f]);
  }
  // A vertex has at most one gap, so one border halfedge enters it and one leaves. The one that enters becomes the
  // vertex's own, as CGAL expects of vertices on a border.
  std::vector<Boundary_surface::Halfedge> border_out(mesh.number_of_vertices());
  for (const auto h : mesh.halfedges())
    if (mesh.is_border(h))
    {
      border_out[mesh.source(h)] = h;
      mesh.set_halfedge(mesh.target(h), h);
    }
  for (const auto h : mesh.halfedges())
    if (mesh.is_border(h))
      mesh.set_next(h, border_out[mesh.target(h)]);
}

inline void add_maps(Boundary_surface& surface)
{
  using S = Boundary_surface;
  S::Mesh& mesh = surface.mesh;
  surface.face_owner = mesh.add_property_map<S::Face, Cell_face>("f:owner").first;
  surface.face_patch = mesh.add_property_map<S::Face, Patch_face>("f:patch").first;
  surface.joined_vertex = mesh.add_property_map<S::Vertex, Index>("v:joined", no_index).first;
  surface.vertex_is_critical = mesh.add_property_map<S::Vertex, char>("v:is_critical", 0).first;
  surface.vertex_is_sharp = mesh.add_property_map<S::Vertex, char>("v:is_sharp", 0).first;
  surface.edge_is_critical = mesh.add_property_map<S::Edge, char>("e:is_critical", 0).first;
  surface.edge_is_pinned = mesh.add_property_map<S::Edge, char>("e:is_pinned", 0).first;
}

} // namespace internal

/// makes one surface of the selected faces of all zones.
///
/// Faces between two cells may be selected too: they look out of the cell that fits their neighbours, the first of the
/// component out of its first cell; of a face that is listed twice, or by both zones of an interface, one is taken.
/// Faces that share an edge are joined there if the edge has no third one; an outer boundary is not cut where a surface
/// inside the volume ends at it, but the edge counts as non-manifold. Corners of faces at one joined vertex become one
/// vertex of the graph as far as such edges lead from one to the next.
///
/// The result does not depend on the number of threads. Vertices ascend by joined vertex, faces by zone, patch and
/// face. \param is_selected  per zone and face of the zone, as after `find_boundary_faces()`; faces without a cell, or
/// in no
///                     patch, are passed over
/// \throws Input_error if `joined`, `boundary` or `is_selected` are not of the size of `mesh`.
/// \par Complexity  O(n log n) in the selected faces, linear in the points of the mesh.
inline Boundary_surface make_boundary_surface(const Volume_mesh& mesh, const Joined_zones& joined,
                                              const Boundary_faces& boundary,
                                              const std::vector<std::vector<std::uint8_t>>& is_selected)
{
  const std::vector<Point> points = joined_points(mesh, joined);
  internal::Surface_topology topology = internal::make_surface_topology(mesh, joined, boundary, is_selected, points);
  Boundary_surface surface;
  internal::add_maps(surface);
  using Size = Boundary_surface::Mesh::size_type;
  surface.mesh.reserve(static_cast<Size>(topology.joined_vertex.size()), static_cast<Size>(topology.edges.size()),
                       static_cast<Size>(topology.faces.size()));
  internal::add_vertices_and_faces(topology, points, surface);
  internal::link_halfedges(topology, internal::add_edges(topology, surface), surface.mesh);
  surface.report = std::move(topology.report);
  return surface;
}

/// the selection of all faces on the boundary of the joined mesh: sides of one cell.
inline std::vector<std::vector<std::uint8_t>> select_boundary(const Boundary_faces& boundary)
{
  std::vector<std::vector<std::uint8_t>> is_selected;
  for (const std::vector<Face_owners>& owners : boundary.owners)
  {
    is_selected.emplace_back();
    for (const Face_owners& o : owners)
      is_selected.back().push_back(place_of(o) == Face_place::boundary);
  }
  return is_selected;
}

} // namespace recurve

#endif
