#ifndef RECURVE_IO_NODE_NUMBERS_H
#define RECURVE_IO_NODE_NUMBERS_H

#include <recurve/core/types.h>

#include <vector>

namespace recurve::internal {

/// Nodes under the numbers that a file gives them, which may have gaps.
class Node_numbers
{
public:
  Node_numbers() = default;

  /// sorts `points`, which come with `numbers`, by number. `first_duplicate()` tells whether one occurs twice.
  Node_numbers(std::vector<Index> numbers, std::vector<Point>& points);

  /// position of the node with the number; no_index if there is none.
  Index find(Index number) const;

  /// a number that two nodes have, or no_index.
  Index first_duplicate() const { return duplicate_; }

private:
  Index lowest_ = 0;
  std::vector<Index> table_;  ///< position by number - lowest_, where numbers are dense; empty: by position itself
  std::vector<Index> sorted_; ///< numbers, ascending, where they have gaps too large for a table
  Index count_ = 0;
  Index duplicate_ = no_index;
};

} // namespace recurve::internal

#endif
