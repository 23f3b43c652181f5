#ifndef RECURVE_SURFACE_CURVING_SURFACE_REPORT_H
#define RECURVE_SURFACE_CURVING_SURFACE_REPORT_H

#include <recurve/core/types.h>

#include <algorithm>

namespace recurve {

/// What a call to `curve_surface()` did. Reports of disjoint parts of a surface add up.
struct Curving_surface_report
{
  Index edges = 0;
  Index faces = 0;
  Index curve_edges = 0;                    ///< edges that took their nodes from a feature curve of two or more edges
  Index moved_edge_nodes = 0;               ///< nodes written
  Index moved_face_nodes = 0;               ///< nodes written
  double largest_displacement = 0;          ///< from the straight-sided position, in the unit of the mesh
  double largest_relative_displacement = 0; ///< the same, over the length of the edge or of the face's longest edge

  Curving_surface_report& operator+=(const Curving_surface_report& other)
  {
    edges += other.edges;
    faces += other.faces;
    curve_edges += other.curve_edges;
    moved_edge_nodes += other.moved_edge_nodes;
    moved_face_nodes += other.moved_face_nodes;
    largest_displacement = std::max(largest_displacement, other.largest_displacement);
    largest_relative_displacement = std::max(largest_relative_displacement, other.largest_relative_displacement);
    return *this;
  }
};

} // namespace recurve

#endif
