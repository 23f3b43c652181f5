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

/// So many times that of any neighbour, both per area: on a smooth surface it is the Gaussian curvature, which differs
/// little from a vertex to the next.
inline constexpr double least_tip_contrast = 4;

/// The curvature that faces around a vertex have in it.
struct Angle_defect
{
  double angle = 0; ///< 2 pi less the angles of the faces
  double area = 0;  ///< of the triangles of their corners

  /// whether it is so many times that of `other`, per area.
  bool stands_out(const Angle_defect& other) const
  {
    return least_tip_contrast * std::abs(other.angle) * area < std::abs(angle) * other.area;
  }
};

/// that of `vertex`; on a rim that is straight its angle is pi, whatever the surface.
inline Angle_defect angle_defect(const Surface_arrays& surface, Index vertex)
{
  Angle_defect defect = {.angle = 2 * std::numbers::pi};
  for (const Index corner : surface.corners_of_vertex(vertex))
  {
    const Point& apex = surface.points[vertex];
    const Point a = subtract(surface.points[surface.corner_vertices[surface.next_corner(corner)]], apex);
    const Point b = subtract(surface.points[surface.corner_vertices[surface.previous_corner(corner)]], apex);
    const double twice_area = length(cross(a, b));
    defect.angle -= std::atan2(twice_area, dot(a, b));
    defect.area += 0.5 * twice_area;
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
  const Angle_defect defect = angle_defect(surface, vertex);
  if (!(std::abs(defect.angle) > least_tip_defect))
    return false;
  const auto neighbors = surface.neighbors_of(vertex);
  return std::all_of(neighbors.begin(), neighbors.end(), [&](Index neighbor) {
    return !surface.is_rim[neighbor] && defect.stands_out(angle_defect(surface, neighbor));
  });
}

/// whether the rim at `vertex`, which is on it, turns by more than 45 degrees within the surface.
inline bool is_corner_of_rim(const Surface_arrays& surface, Index vertex)
{
  constexpr double least_turn = std::numbers::pi / 4;
  return std::abs(angle_defect(surface, vertex).angle - std::numbers::pi) > least_turn;
}

} // namespace recurve::internal::surface

#endif
