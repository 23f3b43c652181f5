#ifndef RECURVE_SURFACE_INTERNAL_CONCENTRATED_CURVATURE_H
#define RECURVE_SURFACE_INTERNAL_CONCENTRATED_CURVATURE_H

#include <recurve/surface/internal/surface_arrays.h>
#include <recurve/surface/internal/vector_3.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace recurve::internal::surface {

/// Angle that faces lack (or have too many) around a vertex, in radians, from which on it may be a tip: that of a cone
/// whose half-angle is 72 degrees. A tip blunter than that bends no edge by a tenth of its length.
inline constexpr double least_tip_defect = 0.3;

/// So many times the defect of any neighbour. On a smooth surface the defect is the area times the curvature, which
/// differ little from a vertex to the next; however coarse, no vertex stands out.
inline constexpr double least_tip_contrast = 4;

/// 2 pi less the angles of the faces around `vertex`, which is not on a rim.
inline double angle_defect(const Surface_arrays& surface, Index vertex)
{
  double defect = 2 * std::numbers::pi;
  for (const Index corner : surface.corners_of_vertex(vertex))
  {
    const Point& apex = surface.points[vertex];
    const Point a = subtract(surface.points[surface.corner_vertices[surface.next_corner(corner)]], apex);
    const Point b = subtract(surface.points[surface.corner_vertices[surface.previous_corner(corner)]], apex);
    defect -= std::atan2(length(cross(a, b)), dot(a, b));
  }
  return defect;
}

/// whether the normals of the faces around `vertex` are so near to its own that the defect, which is the area that they
/// enclose on the unit sphere, is small, even if they go round twice. (Quick: most vertices are.)
inline bool is_nearly_flat(const Surface_arrays& surface, Index vertex)
{
  constexpr double least_cosine = 1 - least_tip_defect / (4 * std::numbers::pi);
  const auto corners = surface.corners_of_vertex(vertex);
  return std::all_of(corners.begin(), corners.end(), [&](Index corner) {
    return dot(surface.face_normals[surface.corner_faces[corner]], surface.normals[vertex]) >= least_cosine;
  });
}

/// whether curvature is concentrated in `vertex`, as at the tip of a cone: no polynomial says anything about it.
inline bool has_concentrated_curvature(const Surface_arrays& surface, Index vertex)
{
  if (surface.is_rim[vertex] || is_nearly_flat(surface, vertex))
    return false;
  const double defect = std::abs(angle_defect(surface, vertex));
  if (!(defect > least_tip_defect))
    return false;
  const auto neighbors = surface.neighbors_of(vertex);
  return std::all_of(neighbors.begin(), neighbors.end(), [&](Index neighbor) {
    return !surface.is_rim[neighbor] && least_tip_contrast * std::abs(angle_defect(surface, neighbor)) < defect;
  });
}

} // namespace recurve::internal::surface

#endif
