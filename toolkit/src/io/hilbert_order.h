#ifndef RECURVE_IO_HILBERT_ORDER_H
#define RECURVE_IO_HILBERT_ORDER_H

#include <recurve/core/types.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace recurve::internal {

/// place along Hilbert's curve of the cell (x, y, z) of a cube of 2^21 cells a side: neighbours along the curve are
/// neighbours in space. \pre each below 2^21 \par Source  Skilling 2004, AIP Conf. Proc. 707, 381.
std::uint64_t hilbert_key(std::array<std::uint32_t, 3> cell);

/// the numbers of `points` in the order of Hilbert's curve through the cube around them; equal places by number.
std::vector<Index> hilbert_order(std::span<const Point> points);

} // namespace recurve::internal

#endif
