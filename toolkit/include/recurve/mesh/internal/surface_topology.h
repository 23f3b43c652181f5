#ifndef RECURVE_MESH_INTERNAL_SURFACE_TOPOLOGY_H
#define RECURVE_MESH_INTERNAL_SURFACE_TOPOLOGY_H

#include <recurve/mesh/boundary_faces.h>
#include <recurve/mesh/join_zones.h>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace recurve {

/// What making a surface of boundary faces met. Edges and vertices are counted as joined ones: once, however many edges
/// and vertices of the surface stand on them.
struct Boundary_surface_report
{
  Index components = 0;            ///< connected parts of the surface
  Index closed_components = 0;     ///< those without border
  Index border_edges = 0;          ///< edges of one face
  Index non_manifold_edges = 0;    ///< edges of more than two faces, or of two that run alike or lie inside and outside
  Index non_manifold_vertices = 0; ///< vertices at which the surface has several sheets or fans; each has its own
                                   ///< vertex of the surface
  Index repeated_faces = 0;        ///< faces left out, as another one of the surface is the same or its other side
  Index collapsed_faces = 0;       ///< faces left out, as corners of theirs are one vertex
  Index turned_faces = 0;          ///< faces inside the volume that took their other side to fit their neighbours
  std::vector<std::string> notes;  ///< the first few non-manifold edges and vertices, by vertex and position
};

/// Where a face of the surface was listed.
struct Patch_face
{
  Index zone = no_index;
  Index patch = no_index; ///< of the zone
  Index face = no_index;  ///< of the zone, see `Zone::faces`
};

namespace internal {

struct Surface_face
{
  Cell_face owner;
  Patch_face listed;
  int corner_count = 3;
  bool is_inside = false; ///< between two cells, on a baffle or an interface of zones
  std::array<Index, 4> vertices = {no_index, no_index, no_index, no_index}; ///< joined, as the owner numbers them
};

/// Side `side` of a face runs from its corner `side` to the next one.
struct Surface_edge
{
  Index face = no_index;
  int side = 0;
  Index other_face = no_index; ///< no_index: a border edge
  int other_side = 0;
  bool is_pinned = false;
};

/// A manifold with borders, as arrays: what `make_boundary_surface()` turns into a graph.
struct Surface_topology
{
  std::vector<Surface_face> faces;
  std::vector<std::array<Index, 4>> corners; ///< per face: vertices of the surface
  std::vector<Index> joined_vertex;          ///< per vertex of the surface, ascending
  std::vector<Surface_edge> edges;           ///< ascending by joined vertices
  Boundary_surface_report report;
};

/// \param is_selected  per zone and face
/// \param points       positions of the joined vertices, for the report
Surface_topology make_surface_topology(const Volume_mesh& mesh, const Joined_zones& joined,
                                       const Boundary_faces& boundary,
                                       const std::vector<std::vector<std::uint8_t>>& is_selected,
                                       const std::vector<Point>& points);

} // namespace internal
} // namespace recurve

#endif
