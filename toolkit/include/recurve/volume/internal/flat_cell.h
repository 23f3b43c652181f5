#ifndef RECURVE_VOLUME_INTERNAL_FLAT_CELL_H
#define RECURVE_VOLUME_INTERNAL_FLAT_CELL_H

#include <recurve/core/types.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

namespace recurve::internal {

/// whether rounding of its other nodes may fold a straight cell that is valid by its corners. Rounding moves a node by
/// a few units in the last place of its coordinates, and det J by the derivatives of that (those of Lagrange functions
/// of degree 6 add up to less than 1e4) times the other two derivatives, each at most the cell's size. A cell whose
/// det J is larger keeps its sign at every degree. \param least_jacobian  lower bound of det J of the corners.
inline bool may_be_flat(double least_jacobian, std::span<const Point> corners)
{
  constexpr double allowance = 1e5 * std::numeric_limits<double>::epsilon();
  double largest = 0, extent = 0;
  for (const Point& p : corners)
    for (std::size_t d = 0; d < 3; ++d)
    {
      largest = std::max(largest, std::abs(p[d]));
      extent = std::max(extent, 2 * std::abs(p[d] - corners[0][d])); // of any two corners
    }
  return !(least_jacobian > allowance * largest * extent * extent);
}

} // namespace recurve::internal

#endif
