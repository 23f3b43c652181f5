#include "../../toolkit/src/io/node_numbers.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <limits>

using namespace recurve;
using internal::Node_numbers;

namespace {

std::vector<Point> points_named(const std::vector<Index>& numbers)
{
  std::vector<Point> points;
  points.reserve(numbers.size());
  for (const Index number : numbers)
    points.push_back({double(number), 0, 0});
  return points;
}

} // namespace

TEST_CASE("nodes are found by number, whatever gaps the numbers have")
{
  const Index huge = std::numeric_limits<Index>::max();
  const std::vector<Index> numbers =
    GENERATE_COPY(std::vector<Index>{1, 2, 3, 4}, std::vector<Index>{4, 3, 2, 1}, std::vector<Index>{7, 5, 12, 9},
                  std::vector<Index>{1, 1000000000, 5, huge}, std::vector<Index>{-3, 0, 2}, std::vector<Index>{0});
  std::vector<Point> points = points_named(numbers);
  const Node_numbers table(numbers, points);
  CHECK(table.first_duplicate() == no_index);
  for (const Index number : numbers)
  {
    const Index node = table.find(number);
    REQUIRE(node != no_index);
    CHECK(points[static_cast<std::size_t>(node)][0] == double(number));
  }
  for (const Index absent : {Index(6), Index(13), Index(-4), std::numeric_limits<Index>::min(), huge - 1})
    CHECK(table.find(absent) == no_index);
  CHECK(std::is_sorted(points.begin(), points.end()));
}

TEST_CASE("a node number that occurs twice is told")
{
  const std::vector<Index> numbers = GENERATE(std::vector<Index>{1, 2, 2, 3}, std::vector<Index>{9, 1, 100000, 9});
  std::vector<Point> points = points_named(numbers);
  CHECK(Node_numbers(numbers, points).first_duplicate() == (numbers[0] == 1 ? 2 : 9));
}

TEST_CASE("no nodes, no numbers")
{
  std::vector<Point> none;
  CHECK(Node_numbers({}, none).find(1) == no_index);
  CHECK(Node_numbers().find(0) == no_index);
}
