#ifndef RECURVE_MESH_JOIN_ZONES_H
#define RECURVE_MESH_JOIN_ZONES_H

#include <recurve/mesh/volume_mesh.h>

#include <string>
#include <vector>

namespace recurve {

struct Join_options
{
  bool use_connectivity = true; ///< join points that an abutting, non-periodic `Zone_interface` pairs
  bool use_geometry = true;     ///< join boundary points of different zones that coincide
  double tolerance = 1e-4; ///< largest distance of coinciding points, relative to the shorter of the shortest edges at
                           ///< them. Where all coordinates of a zone are float32 numbers, which are off by up to 6e-8
                           ///< of their size, that much is added, up to a quarter of the shortest edge
};

/// How many points two zones share.
struct Joined_pair
{
  std::string zone_a, zone_b;
  Index points_by_connectivity = 0;
  Index points_by_geometry = 0;
  double largest_gap = 0; ///< largest distance of joined points, in the unit of the mesh
};

/// One numbering of vertices across all zones: ascending by first zone, then by point of that zone.
struct Joined_zones
{
  Index vertex_count = 0;
  std::vector<std::vector<Index>> vertex_of_point; ///< per zone and point
  std::vector<Joined_pair> pairs;                  ///< ascending by zones
  Index pairs_refused_by_zone = 0; ///< coinciding points left apart, as joining them would have joined two points of
                                   ///< one zone; the closest pair went first
  Index pairs_refused_by_distance = 0; ///< pairs of an interface that lie apart: the interface is periodic or wrong
  std::vector<std::string> notes;      ///< the first few of those, by zone and node
};

/// joins the zones of `mesh` where they touch: first by the interfaces that the mesh states (points, or faces, whose
/// corners are then matched by position), then by position, between points on the hull of their zones. Periodic
/// interfaces join nothing. Points of one zone are never joined with each other, except where a non-periodic interface
/// of the zone with itself says so (the cut of a C-grid). Where several points of a zone coincide (the two sides of a
/// baffle that runs through an interface), points whose faces coincide are joined before others.
///
/// Nothing depends on the unit, the position or the order of magnitude of the mesh, nor on the number of threads.
/// \throws Input_error if an interface names a zone, point or face that does not exist, or joins faces of two types.
/// \par Complexity  linear in the cells, O(n log n) in the hull points; a mesh of one zone without interfaces costs
/// nothing.
Joined_zones join_zones(const Volume_mesh& mesh, const Join_options& options = {});

/// position of each joined vertex: that of its point in its first zone.
/// \throws Input_error if `joined` is not of the size of `mesh`.
std::vector<Point> joined_points(const Volume_mesh& mesh, const Joined_zones& joined);

} // namespace recurve

#endif
