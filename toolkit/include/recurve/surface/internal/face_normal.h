#ifndef RECURVE_SURFACE_INTERNAL_FACE_NORMAL_H
#define RECURVE_SURFACE_INTERNAL_FACE_NORMAL_H

#include <recurve/surface/internal/exact_normal.h>
#include <recurve/surface/internal/vector_3.h>

#include <limits>
#include <span>
#include <vector>

namespace recurve::internal::surface {

/// Round-off of a coordinate that went through a few operations (a rotation, a conversion), relative to its magnitude:
/// the resolution below which positions say nothing. Twice the largest error of a rotation matrix times a vector.
inline constexpr double coordinate_resolution = 16 * std::numeric_limits<double>::epsilon();

inline Point normalized(const Point& a)
{
  // In units of the largest component: the square of a tiny length must not underflow.
  const double unit = largest_coordinate(a);
  if (!(unit > 0))
    return {0, 0, 0};
  const Point b = {a[0] / unit, a[1] / unit, a[2] / unit};
  return scaled(1 / length(b), b);
}

/// Round-off of the area vector in double, in resolutions of its bound, is at most 1. Where the area is less than this
/// many times larger, the direction has lost digits and is computed exactly.
inline constexpr double certain_area = 1024;

/// unit normal of a face by Newell's method, over all its corners; zero where the area is below the resolution of the
/// coordinates, so that its direction would be noise. Of slivers above that it is that of exact arithmetic.
inline Point face_normal(std::span<const Index> corners, const std::vector<Point>& points)
{
  const Point& first = points[corners[0]];
  Point twice_area = {0, 0, 0};
  double perimeter = 0;
  double magnitude = largest_coordinate(first);
  Point a = {0, 0, 0}; // relative to the first corner, so that the place of the mesh costs no digits
  for (std::size_t i = 1; i <= corners.size(); ++i)
  {
    const Point& x = points[corners[i % corners.size()]];
    const Point b = subtract(x, first);
    twice_area = add(twice_area, cross(a, b));
    perimeter += length(subtract(b, a));
    magnitude = std::max(magnitude, largest_coordinate(x));
    a = b;
  }
  const double noise = coordinate_resolution * magnitude * perimeter;
  const double area = length(twice_area);
  if (!(area > noise))
    return {0, 0, 0};
  return normalized(area > certain_area * noise ? twice_area : exact_newell_direction(corners, points));
}

} // namespace recurve::internal::surface

#endif
