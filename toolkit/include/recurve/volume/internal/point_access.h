#ifndef RECURVE_VOLUME_INTERNAL_POINT_ACCESS_H
#define RECURVE_VOLUME_INTERNAL_POINT_ACCESS_H

#include <recurve/core/types.h>

#include <concepts>
#include <ranges>
#include <type_traits>

namespace recurve {

/// A position or displacement: `std::array<double, 3>`, `CGAL::Point_3`, `CGAL::Vector_3`, `Eigen::Vector3d`, ...
template <class T>
concept Point_like = requires(const T& point)
{
  {
    point[0]
    } -> std::convertible_to<double>;
};

/// A random-access, sized range of them.
template <class Range>
concept Point_range = std::ranges::random_access_range<Range> && std::ranges::sized_range<Range> &&
  Point_like<std::remove_cvref_t<std::ranges::range_reference_t<Range>>>;

namespace internal {

template <class P>
Point coordinates(const P& point)
{
  return {static_cast<double>(point[0]), static_cast<double>(point[1]), static_cast<double>(point[2])};
}

/// the inverse of `coordinates()`.
template <class P>
P make_point(const Point& c)
{
  if constexpr (std::is_same_v<P, Point>)
    return c;
  else if constexpr (std::is_constructible_v<P, double, double, double>)
    return P(c[0], c[1], c[2]);
  else
    return P{c[0], c[1], c[2]};
}

} // namespace internal
} // namespace recurve

#endif
