#include "node_numbers.h"

#include <algorithm>
#include <numeric>

namespace recurve::internal {

namespace {

/// A table may be this many times as long as there are nodes; else numbers are searched.
constexpr double largest_table = 4;

bool is_consecutive(const std::vector<Index>& numbers)
{
  for (std::size_t m = 1; m < numbers.size(); ++m)
    if (numbers[m] != numbers[m - 1] + 1)
      return false;
  return true;
}

void sort_together(std::vector<Index>& numbers, std::vector<Point>& points)
{
  if (std::is_sorted(numbers.begin(), numbers.end()))
    return;
  std::vector<Index> order(numbers.size());
  std::iota(order.begin(), order.end(), Index(0));
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) {
    return numbers[static_cast<std::size_t>(a)] < numbers[static_cast<std::size_t>(b)];
  });
  std::vector<Point> sorted(points.size());
  for (std::size_t m = 0; m < order.size(); ++m)
    sorted[m] = points[static_cast<std::size_t>(order[m])];
  points = std::move(sorted);
  std::sort(numbers.begin(), numbers.end());
}

} // namespace

Node_numbers::Node_numbers(std::vector<Index> numbers, std::vector<Point>& points)
  : count_(static_cast<Index>(numbers.size()))
{
  if (numbers.empty())
    return;
  sort_together(numbers, points);
  if (const auto twin = std::adjacent_find(numbers.begin(), numbers.end()); twin != numbers.end())
    duplicate_ = *twin;
  lowest_ = numbers.front();
  if (is_consecutive(numbers))
    return;
  const double span = static_cast<double>(numbers.back()) - static_cast<double>(lowest_);
  if (span > largest_table * static_cast<double>(numbers.size()))
  {
    sorted_ = std::move(numbers);
    return;
  }
  table_.assign(static_cast<std::size_t>(numbers.back() - lowest_) + 1, no_index);
  for (std::size_t m = 0; m < numbers.size(); ++m)
    table_[static_cast<std::size_t>(numbers[m] - lowest_)] = static_cast<Index>(m);
}

Index Node_numbers::find(Index number) const
{
  if (!sorted_.empty())
  {
    const auto found = std::lower_bound(sorted_.begin(), sorted_.end(), number);
    return found != sorted_.end() && *found == number ? static_cast<Index>(found - sorted_.begin()) : no_index;
  }
  if (count_ == 0 || number < lowest_)
    return no_index;
  const auto offset = static_cast<std::uint64_t>(number) - static_cast<std::uint64_t>(lowest_);
  if (table_.empty())
    return offset < static_cast<std::uint64_t>(count_) ? static_cast<Index>(offset) : no_index;
  return offset < table_.size() ? table_[offset] : no_index;
}

} // namespace recurve::internal
