#ifndef RECURVE_VOLUME_INTERNAL_POINT_TREE_H
#define RECURVE_VOLUME_INTERNAL_POINT_TREE_H

#include <recurve/core/types.h>

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <tuple>
#include <vector>

namespace recurve::internal {

/// A point and the number under which the caller knows it.
struct Numbered_point
{
  Point position;
  Index number;
};

/// Balanced binary tree over points: each node halves its points across the widest side of their box. All leaves are at
/// the same depth and hold between `capacity / 2` and `capacity` points (fewer only if there are no more). Node 0 is
/// the root, the children of node n are 2n + 1 and 2n + 2. Depends on positions and numbers only, not on threads.
class Point_tree
{
public:
  struct Node
  {
    Point low, high;  ///< tight box
    Point center;     ///< of the box
    double radius;    ///< largest distance of a point from `center`
    Index begin, end; ///< the node's points
    Index size() const { return end - begin; }
  };

  Point_tree() = default;
  /// \param group  so many successive points of a leaf, from its first one on, are sorted to be near each other; 0:
  /// they are in any order. \pre capacity >= 2
  Point_tree(std::vector<Numbered_point> points, Index capacity, Index group = 0);

  bool is_empty() const { return points_.empty(); }
  bool is_leaf(Index node) const { return node >= first_leaf_; }
  Index first_leaf() const { return first_leaf_; }
  Index node_count() const { return static_cast<Index>(nodes_.size()); }
  const Node& node(Index n) const { return nodes_[static_cast<std::size_t>(n)]; }
  std::span<const Numbered_point> points() const { return points_; } ///< in the order of the leaves
  std::size_t bytes() const { return points_.size() * sizeof(Numbered_point) + nodes_.size() * sizeof(Node); }

  /// box, center and radius of some of the points.
  Node measured(Index begin, Index end) const;

  /// releases the points; the nodes stay.
  void drop_points() { std::vector<Numbered_point>().swap(points_); }

private:
  void build(Index node, Index begin, Index end);
  void sort_groups(const Node& part);
  void halve(const Node& node, Index middle);

  // Below this many points a task costs more than it saves.
  static constexpr Index parallel_size = 16384;

  std::vector<Numbered_point> points_;
  std::vector<Node> nodes_;
  Index first_leaf_ = 0, group_ = 0;
};

inline Point_tree::Point_tree(std::vector<Numbered_point> points, Index capacity, Index group)
  : points_(std::move(points)), group_(group)
{
  const Index n = static_cast<Index>(points_.size());
  if (n == 0)
    return;
  Index leaf_count = 1;
  while ((n + leaf_count - 1) / leaf_count > capacity)
    leaf_count *= 2;
  nodes_.resize(static_cast<std::size_t>(2 * leaf_count - 1));
  first_leaf_ = leaf_count - 1;
  build(0, 0, n);
}

inline Point_tree::Node Point_tree::measured(Index begin, Index end) const
{
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Node node;
  node.begin = begin;
  node.end = end;
  node.low = {infinity, infinity, infinity};
  node.high = {-infinity, -infinity, -infinity};
  for (Index m = node.begin; m < node.end; ++m)
    for (std::size_t d = 0; d < 3; ++d)
    {
      node.low[d] = std::min(node.low[d], points_[static_cast<std::size_t>(m)].position[d]);
      node.high[d] = std::max(node.high[d], points_[static_cast<std::size_t>(m)].position[d]);
    }
  for (std::size_t d = 0; d < 3; ++d)
    node.center[d] = node.low[d] + (node.high[d] - node.low[d]) / 2;
  double squared = 0;
  for (Index m = node.begin; m < node.end; ++m)
  {
    const Point& p = points_[static_cast<std::size_t>(m)].position;
    const double x = p[0] - node.center[0], y = p[1] - node.center[1], z = p[2] - node.center[2];
    squared = std::max(squared, x * x + y * y + z * z);
  }
  // rounded up, so that a bound computed from the radius is one
  node.radius = std::sqrt(squared) * (1 + 4 * std::numeric_limits<double>::epsilon());
  return node;
}

/// puts the points of a node before `middle` that are lower along its widest side.
inline void Point_tree::halve(const Node& node, Index middle)
{
  std::size_t widest = 0;
  for (std::size_t d = 1; d < 3; ++d)
    if (node.high[d] - node.low[d] > node.high[widest] - node.low[widest])
      widest = d;
  // The number breaks ties, so that the halves do not depend on the order in which points of equal coordinate came.
  std::nth_element(points_.begin() + node.begin, points_.begin() + middle, points_.begin() + node.end,
                   [widest](const Numbered_point& a, const Numbered_point& b) {
                     return std::tie(a.position[widest], a.number) < std::tie(b.position[widest], b.number);
                   });
}

inline void Point_tree::sort_groups(const Node& part)
{
  if (group_ == 0 || part.size() <= group_)
    return;
  const Index groups = (part.size() + group_ - 1) / group_, middle = part.begin + groups / 2 * group_;
  halve(part, middle);
  sort_groups(measured(part.begin, middle));
  sort_groups(measured(middle, part.end));
}

inline void Point_tree::build(Index number, Index begin, Index end)
{
  Node& node = nodes_[static_cast<std::size_t>(number)];
  node = measured(begin, end);
  if (is_leaf(number))
    return sort_groups(node);
  const Index middle = begin + (end - begin) / 2;
  halve(node, middle);
  const auto left = [&] { build(2 * number + 1, begin, middle); };
  const auto right = [&] { build(2 * number + 2, middle, end); };
  if (end - begin >= parallel_size)
    tbb::parallel_invoke(left, right);
  else
  {
    left();
    right();
  }
}

inline double squared_distance(const Point& a, const Point& b)
{
  const double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
  return x * x + y * y + z * z;
}

/// squared distance between the nearest points of two boxes; 0 if they meet.
inline double squared_gap(const Point_tree::Node& a, const Point_tree::Node& b)
{
  double sum = 0;
  for (std::size_t d = 0; d < 3; ++d)
  {
    const double gap = std::max({0.0, a.low[d] - b.high[d], b.low[d] - a.high[d]});
    sum += gap * gap;
  }
  return sum;
}

/// squared distance of a point from the nearest point of a box; 0 inside.
inline double squared_gap(const Point_tree::Node& a, const Point& p)
{
  double sum = 0;
  for (std::size_t d = 0; d < 3; ++d)
  {
    const double gap = std::max({0.0, a.low[d] - p[d], p[d] - a.high[d]});
    sum += gap * gap;
  }
  return sum;
}

/// squared distance between the farthest points of two boxes.
inline double squared_span(const Point_tree::Node& a, const Point_tree::Node& b)
{
  double sum = 0;
  for (std::size_t d = 0; d < 3; ++d)
  {
    const double span = std::max(a.high[d] - b.low[d], b.high[d] - a.low[d]);
    sum += span * span;
  }
  return sum;
}

} // namespace recurve::internal

#endif
