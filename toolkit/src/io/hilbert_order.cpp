#include "hilbert_order.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace recurve::internal {

namespace {

constexpr int bits = 21; // three times 21 fit into 64

} // namespace

std::uint64_t hilbert_key(std::array<std::uint32_t, 3> x)
{
  // Undoes, level by level from the finest, the turns and mirrors that the curve takes in each octant ...
  for (std::uint32_t q = std::uint32_t{1} << (bits - 1); q > 1; q >>= 1)
    for (std::uint32_t& coordinate : x)
      if ((coordinate & q) != 0)
        x[0] ^= q - 1;
      else
      {
        const std::uint32_t swapped = (x[0] ^ coordinate) & (q - 1);
        x[0] ^= swapped;
        coordinate ^= swapped;
      }
  // ... which leaves a Gray code.
  x[1] ^= x[0];
  x[2] ^= x[1];
  std::uint32_t flips = 0;
  for (std::uint32_t q = std::uint32_t{1} << (bits - 1); q > 1; q >>= 1)
    if ((x[2] & q) != 0)
      flips ^= q - 1;
  std::uint64_t key = 0;
  for (int bit = bits - 1; bit >= 0; --bit)
    for (const std::uint32_t coordinate : x)
      key = 2 * key + (((coordinate ^ flips) >> bit) & 1);
  return key;
}

std::vector<Index> hilbert_order(std::span<const Point> points)
{
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Point low = {infinity, infinity, infinity};
  double extent = 0;
  for (const Point& point : points)
    for (std::size_t axis = 0; axis < 3; ++axis)
      low[axis] = std::min(low[axis], point[axis]);
  for (const Point& point : points)
    for (std::size_t axis = 0; axis < 3; ++axis)
      extent = std::max(extent, point[axis] - low[axis]);

  constexpr double cells = (1 << bits) - 1;
  std::vector<std::pair<std::uint64_t, Index>> keys;
  keys.reserve(points.size());
  for (const Point& point : points)
  {
    std::array<std::uint32_t, 3> cell = {};
    for (std::size_t axis = 0; axis < 3 && extent > 0; ++axis)
      cell[axis] = static_cast<std::uint32_t>(cells * std::clamp((point[axis] - low[axis]) / extent, 0.0, 1.0));
    keys.push_back({hilbert_key(cell), static_cast<Index>(keys.size())});
  }
  std::sort(keys.begin(), keys.end());
  std::vector<Index> order;
  order.reserve(keys.size());
  for (const auto& [key, number] : keys)
    order.push_back(number);
  return order;
}

} // namespace recurve::internal
