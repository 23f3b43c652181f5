#ifndef RECURVE_SURFACE_INTERNAL_FACE_NORMAL_H
#define RECURVE_SURFACE_INTERNAL_FACE_NORMAL_H

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

/// unit normal of a face by Newell's method, over all its corners; zero where the area is below the resolution of the
/// coordinates, so that its direction would be noise.
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
  if (!(length(twice_area) > coordinate_resolution * magnitude * perimeter))
    return {0, 0, 0};
  return normalized(twice_area);
}

} // namespace recurve::internal::surface

#endif
