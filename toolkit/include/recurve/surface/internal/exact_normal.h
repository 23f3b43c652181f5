#ifndef RECURVE_SURFACE_INTERNAL_EXACT_NORMAL_H
#define RECURVE_SURFACE_INTERNAL_EXACT_NORMAL_H

#include <recurve/core/types.h>

#include <CGAL/Exact_rational.h>
#include <CGAL/number_utils.h>

#include <algorithm>
#include <array>
#include <span>
#include <vector>

namespace recurve::internal::surface {

/// twice the area vector of a face by Newell's method, in exact arithmetic, as a vector of length about one; exactly
/// zero where the area is.
inline Point exact_newell_direction(std::span<const Index> corners, const std::vector<Point>& points)
{
  using Number = CGAL::Exact_rational;
  std::array<Number, 3> sum = {0, 0, 0};
  for (std::size_t i = 0; i < corners.size(); ++i)
  {
    const Point& a = points[static_cast<std::size_t>(corners[i])];
    const Point& b = points[static_cast<std::size_t>(corners[(i + 1) % corners.size()])];
    for (std::size_t k = 0; k < 3; ++k)
    {
      const std::size_t x = (k + 1) % 3, y = (k + 2) % 3;
      sum[k] += Number(a[x]) * Number(b[y]) - Number(a[y]) * Number(b[x]);
    }
  }
  Number largest = 0;
  for (const Number& c : sum)
    largest = std::max(largest, Number(CGAL::abs(c)));
  if (CGAL::is_zero(largest))
    return {0, 0, 0};
  // The squares of tiny areas would underflow: divided first.
  return {CGAL::to_double(Number(sum[0] / largest)), CGAL::to_double(Number(sum[1] / largest)),
          CGAL::to_double(Number(sum[2] / largest))};
}

} // namespace recurve::internal::surface

#endif
