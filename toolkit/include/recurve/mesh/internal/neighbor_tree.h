#ifndef RECURVE_MESH_INTERNAL_NEIGHBOR_TREE_H
#define RECURVE_MESH_INTERNAL_NEIGHBOR_TREE_H

#include <recurve/core/types.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

namespace recurve::internal {

inline double squared_distance(const Point& a, const Point& b)
{
  const double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
  return x * x + y * y + z * z;
}

/// Balanced kd-tree over points, for queries of a radius that differs from point to point (cells of a boundary layer
/// are 10^4 times smaller than their neighbours; a grid of one size would be no help).
class Neighbor_tree
{
public:
  /// \par Complexity  O(n log n).
  explicit Neighbor_tree(std::vector<Point> points) : points_(std::move(points)), order_(points_.size())
  {
    std::iota(order_.begin(), order_.end(), Index(0));
    if (!points_.empty())
      build(0, static_cast<Index>(points_.size()));
  }

  /// calls `visit(number)` for every point within `radius` of `center`, bounds included.
  template <class Visit>
  void visit_ball(const Point& center, double radius, const Visit& visit) const
  {
    if (!nodes_.empty())
      visit_ball(0, center, radius * radius, visit);
  }

private:
  static constexpr Index leaf_size = 8; // a few points side by side are tested faster than a tree is descended

  struct Node
  {
    Point low, high;
    Index begin, end;
    Index right = no_index; ///< the left child is the next node; no_index: a leaf
  };

  Index build(Index begin, Index end)
  {
    const Index number = static_cast<Index>(nodes_.size());
    nodes_.push_back(bounds(begin, end));
    if (end - begin <= leaf_size)
      return number;
    const int axis = widest_axis(nodes_[number]);
    const Index middle = begin + (end - begin) / 2;
    std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                     [&](Index a, Index b) { return std::pair(points_[a][axis], a) < std::pair(points_[b][axis], b); });
    build(begin, middle);
    const Index right = build(middle, end);
    nodes_[number].right = right;
    return number;
  }

  Node bounds(Index begin, Index end) const
  {
    Node node{points_[order_[begin]], points_[order_[begin]], begin, end};
    for (Index i = begin + 1; i < end; ++i)
      for (int axis = 0; axis < 3; ++axis)
      {
        node.low[axis] = std::min(node.low[axis], points_[order_[i]][axis]);
        node.high[axis] = std::max(node.high[axis], points_[order_[i]][axis]);
      }
    return node;
  }

  static int widest_axis(const Node& node)
  {
    int widest = 0;
    for (int axis = 1; axis < 3; ++axis)
      if (node.high[axis] - node.low[axis] > node.high[widest] - node.low[widest])
        widest = axis;
    return widest;
  }

  template <class Visit>
  void visit_ball(Index number, const Point& center, double squared_radius, const Visit& visit) const
  {
    const Node& node = nodes_[number];
    Point nearest = center;
    for (int axis = 0; axis < 3; ++axis)
      nearest[axis] = std::clamp(center[axis], node.low[axis], node.high[axis]);
    if (squared_distance(nearest, center) > squared_radius)
      return;
    if (node.right != no_index)
    {
      visit_ball(number + 1, center, squared_radius, visit);
      visit_ball(node.right, center, squared_radius, visit);
      return;
    }
    for (Index i = node.begin; i < node.end; ++i)
      if (squared_distance(points_[order_[i]], center) <= squared_radius)
        visit(order_[i]);
  }

  std::vector<Point> points_;
  std::vector<Index> order_;
  std::vector<Node> nodes_;
};

} // namespace recurve::internal

#endif
