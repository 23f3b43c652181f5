#ifndef RECURVE_SURFACE_INTERNAL_VECTOR_3_H
#define RECURVE_SURFACE_INTERNAL_VECTOR_3_H

#include <recurve/core/types.h>

#include <CGAL/number_utils.h>

#include <algorithm>
#include <cmath>

/// The little vector algebra that the surface passes need on plain arrays.
namespace recurve::internal::surface {

inline Point add(const Point& a, const Point& b)
{
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}

inline Point subtract(const Point& a, const Point& b)
{
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

inline Point scaled(double factor, const Point& a)
{
  return {factor * a[0], factor * a[1], factor * a[2]};
}

inline double dot(const Point& a, const Point& b)
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

inline Point cross(const Point& a, const Point& b)
{
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

inline double length(const Point& a)
{
  return std::sqrt(dot(a, a));
}

inline double largest_coordinate(const Point& a)
{
  return std::max({std::abs(a[0]), std::abs(a[1]), std::abs(a[2])});
}

/// the coordinates of a CGAL point.
template <class Point3>
Point point_of(const Point3& p)
{
  return {CGAL::to_double(p.x()), CGAL::to_double(p.y()), CGAL::to_double(p.z())};
}

} // namespace recurve::internal::surface

#endif
