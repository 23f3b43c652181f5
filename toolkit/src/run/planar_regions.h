#ifndef RECURVE_SRC_RUN_PLANAR_REGIONS_H
#define RECURVE_SRC_RUN_PLANAR_REGIONS_H

#include <recurve/core/types.h>
#include <recurve/volume/element_block.h>

#include <span>
#include <vector>

namespace recurve {

/// A triangle or quadrangle of the boundary with its nodes in canonical order.
struct Boundary_element
{
  Element_type type = Element_type::triangle;
  std::span<const Index> nodes;
};

/// Connected faces of the boundary in one plane.
struct Planar_region
{
  std::vector<Index> faces; ///< ascending
  Point normal = {};        ///< of length 1
  int axis = -1;            ///< 0, 1, 2: all corners share this coordinate, to the bit; else -1
};

/// parts `faces` into planar regions, the largest faces first. Every planar face is in one region, if only its own;
/// those without an area are in one with a neighbour or in none. \param points  by node number; only those of corners
/// are read. \par Complexity  O(n log n).
std::vector<Planar_region> find_planar_regions(std::span<const Boundary_element> faces, std::span<const Point> points);

/// the vector without what is normal to the plane of `region`; exactly zero along its `axis`.
Point along_plane(const Planar_region& region, const Point& vector);

/// The nodes of a planar region.
struct Region_nodes
{
  std::vector<Index> rim;    ///< on edges that only one face of the region has, ascending
  std::vector<Index> inside; ///< the others, ascending
};

Region_nodes nodes_of(const Planar_region& region, std::span<const Boundary_element> faces, int degree);

} // namespace recurve

#endif
