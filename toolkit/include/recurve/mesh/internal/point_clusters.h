#ifndef RECURVE_MESH_INTERNAL_POINT_CLUSTERS_H
#define RECURVE_MESH_INTERNAL_POINT_CLUSTERS_H

#include <recurve/core/types.h>

#include <numeric>
#include <utility>
#include <vector>

namespace recurve::internal {

/// Disjoint sets that know their members. The root of a set is its smallest member.
class Point_clusters
{
public:
  explicit Point_clusters(Index size) : parent_(static_cast<std::size_t>(size)), next_(parent_.size())
  {
    std::iota(parent_.begin(), parent_.end(), Index(0));
    std::iota(next_.begin(), next_.end(), Index(0));
  }

  Index root(Index a) const
  {
    while (parent_[a] != a)
      a = parent_[a];
    return a;
  }

  void merge(Index a, Index b)
  {
    a = compress(a);
    b = compress(b);
    if (a == b)
      return;
    if (b < a)
      std::swap(a, b);
    parent_[b] = a;
    std::swap(next_[a], next_[b]); // two rings become one
  }

  /// the member after `a` in the ring of its set.
  Index next(Index a) const { return next_[a]; }

private:
  Index compress(Index a)
  {
    const Index top = root(a);
    while (parent_[a] != top)
      a = std::exchange(parent_[a], top);
    return top;
  }

  std::vector<Index> parent_;
  std::vector<Index> next_;
};

} // namespace recurve::internal

#endif
