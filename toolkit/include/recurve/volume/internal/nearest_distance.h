#ifndef RECURVE_VOLUME_INTERNAL_NEAREST_DISTANCE_H
#define RECURVE_VOLUME_INTERNAL_NEAREST_DISTANCE_H

#include <recurve/core/types.h>
#include <recurve/volume/internal/point_tree.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace recurve::internal {

/// distance of `p` from the nearest point of the tree, or `largest` if none is nearer.
inline double nearest_distance(const Point_tree& tree, const Point& p, double largest)
{
  if (tree.is_empty())
    return largest;
  double nearest = largest * largest;
  std::array<Index, 64> stack = {0}; // the tree is not deeper, and of each level at most one sibling waits
  std::size_t size = 1;
  while (size > 0)
  {
    const Index n = stack[--size];
    const Point_tree::Node& node = tree.node(n);
    if (squared_gap(node, p) >= nearest)
      continue;
    if (!tree.is_leaf(n))
    {
      Index near = 2 * n + 1, far = 2 * n + 2;
      if (squared_gap(tree.node(far), p) < squared_gap(tree.node(near), p))
        std::swap(near, far);
      stack[size++] = far;
      stack[size++] = near;
      continue;
    }
    for (Index m = node.begin; m < node.end; ++m)
    {
      const Point& s = tree.points()[static_cast<std::size_t>(m)].position;
      const double x = p[0] - s[0], y = p[1] - s[1], z = p[2] - s[2];
      nearest = std::min(nearest, x * x + y * y + z * z);
    }
  }
  return std::sqrt(nearest);
}

} // namespace recurve::internal

#endif
