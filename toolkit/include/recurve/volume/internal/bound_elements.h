#ifndef RECURVE_VOLUME_INTERNAL_BOUND_ELEMENTS_H
#define RECURVE_VOLUME_INTERNAL_BOUND_ELEMENTS_H

#include <recurve/core/exceptions.h>
#include <recurve/core/types.h>
#include <recurve/elements/element.h>
#include <recurve/volume/element_block.h>
#include <recurve/volume/internal/flat_cell.h>
#include <recurve/volume/internal/jacobian_bounder.h>
#include <recurve/volume/internal/point_access.h>
#include <recurve/volume/jacobian_bounds.h>

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_reduce.h>

#include <array>
#include <cstddef>
#include <ranges>
#include <span>
#include <string>

namespace recurve::internal {

inline void check_element(Element_type type, int degree)
{
  if (reference_element(type).dimension != 3)
    throw Input_error("bound_jacobian: a " + std::string(element_name(type)) + " is not a cell");
  if (degree < 1 || degree > max_degree)
    throw Input_error("bound_jacobian: the degree has to be between 1 and " + std::to_string(max_degree) + ", not " +
                      std::to_string(degree));
}

inline void check_options(const Jacobian_options& options)
{
  constexpr int largest_depth = 1000;
  if (options.max_depth < 0 || options.max_depth > largest_depth)
    throw Input_error("bound_jacobian: max_depth has to be between 0 and " + std::to_string(largest_depth) + ", not " +
                      std::to_string(options.max_depth));
  if (options.max_parts < 1 || options.max_exact_parts < 1)
    throw Input_error("bound_jacobian: max_parts and max_exact_parts have to be positive");
  if (!(options.sharpness > 0))
    throw Input_error("bound_jacobian: sharpness has to be positive, not " + std::to_string(options.sharpness));
}

/// fills all lanes with one element.
inline void set_nodes(Jacobian_bounder& bounder, const Jacobian_table& table, std::span<const Point> nodes)
{
  double* to = bounder.nodes(table);
  for (const Point& p : nodes)
    for (const double x : p)
      for (int lane = 0; lane < bounder.batch(); ++lane)
        *to++ = x;
}

/// Bounds the elements of one block, or those of a selection, and gathers their report. Nothing in it depends on the
/// order of the elements.
template <class Nodes, class IsStraight, class Visit>
class Block_bounder
{
public:
  using Bounders = tbb::enumerable_thread_specific<Jacobian_bounder>;

  Block_bounder(const Nodes& nodes, const Element_block& block, Index number, int degree,
                const Jacobian_options& options, const IsStraight& is_straight, const Visit& visit, Bounders& bounders)
    : nodes_(nodes), block_(block), number_(number), options_(options), is_straight_(is_straight), visit_(visit),
      bounders_(bounders), stride_(node_count(block.type, degree)), curved_table_(jacobian_table(block.type, degree)),
      straight_table_(jacobian_table(block.type, 1))
  {}

  /// \param selection  numbers of elements; empty: all
  Jacobian_report report(std::span<const Index> selection = {}) const
  {
    constexpr Index grain = 128; // many batches
    const auto size = static_cast<Index>(block_.nodes.size());
    if (size % stride_ != 0)
      throw Input_error("bound_jacobians: block " + std::to_string(number_) + " has " + std::to_string(size) +
                        " nodes, which is no multiple of the " + std::to_string(stride_) + " of a " +
                        std::string(element_name(block_.type)));
    const Index count = selection.empty() ? size / stride_ : static_cast<Index>(selection.size());
    return tbb::parallel_reduce(
      tbb::blocked_range<Index>(0, count, grain), Jacobian_report(),
      [this, selection](const tbb::blocked_range<Index>& range, Jacobian_report sum) {
        add_range(range.begin(), range.end(), selection, sum);
        return sum;
      },
      [](Jacobian_report a, const Jacobian_report& b) { return a += b; });
  }

private:
  /// Elements that wait for their batch to be full.
  struct Queue
  {
    const Jacobian_table& table;
    std::array<Index, max_batch> elements = {};
    int count = 0;
  };

  void add_range(Index first, Index last, std::span<const Index> selection, Jacobian_report& sum) const
  {
    Jacobian_bounder& bounder = bounders_.local();
    Queue straight{straight_table_}, curved{curved_table_};
    for (Index m = first; m < last; ++m)
    {
      const Index e = selection.empty() ? m : selection[static_cast<std::size_t>(m)];
      const bool takes_short_test = &straight_table_ != &curved_table_ && is_straight_(number_, e);
      Queue& queue = takes_short_test ? straight : curved;
      put(bounder, queue, e, curved, sum);
    }
    flush(bounder, straight, curved, sum);
    flush(bounder, curved, curved, sum);
  }

  void put(Jacobian_bounder& bounder, Queue& queue, Index element, Queue& curved, Jacobian_report& sum) const
  {
    queue.elements[static_cast<std::size_t>(queue.count++)] = element;
    if (queue.count == bounder.batch())
      flush(bounder, queue, curved, sum);
  }

  /// coordinates of a node of an element; \throws Input_error if there is none.
  Point point(Index element, int node) const
  {
    const Index id = block_.nodes[static_cast<std::size_t>(element * stride_ + node)];
    if (id < 0 || id >= static_cast<Index>(std::ranges::size(nodes_)))
      throw Input_error("bound_jacobians: " + std::string(element_name(block_.type)) + " " + std::to_string(element) +
                        " of block " + std::to_string(number_) + " has node " + std::to_string(id) + ", of " +
                        std::to_string(std::ranges::size(nodes_)));
    return coordinates(std::ranges::begin(nodes_)[id]);
  }

  /// bounds the elements that wait in `queue`. Straight ones that are too flat for the short test go on to `curved`.
  void flush(Jacobian_bounder& bounder, Queue& queue, Queue& curved, Jacobian_report& sum) const
  {
    if (queue.count == 0)
      return;
    const int batch = bounder.batch();
    double* const to = bounder.nodes(queue.table);
    for (int lane = 0; lane < batch; ++lane)
    {
      const Index element = queue.elements[static_cast<std::size_t>(lane < queue.count ? lane : 0)];
      for (int m = 0; m < queue.table.node_count; ++m)
      {
        const Point p = point(element, m);
        for (int d = 0; d < 3; ++d)
          to[(3 * m + d) * batch + lane] = p[static_cast<std::size_t>(d)];
      }
    }
    std::array<Jacobian_bounds, max_batch> results;
    const auto used = static_cast<std::size_t>(queue.count);
    bounder.bound(queue.table, options_, std::span(results).first(used));
    queue.count = 0;
    const bool is_short = &queue != &curved;
    for (std::size_t lane = 0; lane < used; ++lane)
    {
      const Index element = queue.elements[lane];
      if (is_short && results[lane].verdict == Validity::valid && is_flat(element, results[lane].lower))
      {
        put(bounder, curved, element, curved, sum);
        continue;
      }
      sum.straight_elements += is_short;
      add(element, results[lane], sum);
      visit_(number_, element, results[lane]);
    }
  }

  bool is_flat(Index element, double least_jacobian) const
  {
    std::array<Point, 8> corners;
    const int count = corner_count(block_.type);
    for (int c = 0; c < count; ++c)
      corners[static_cast<std::size_t>(c)] = point(element, c);
    return may_be_flat(least_jacobian, std::span(corners).first(static_cast<std::size_t>(count)));
  }

  void add(Index element, const Jacobian_bounds& bounds, Jacobian_report& sum) const
  {
    auto& verdicts = sum.of(block_.type);
    const Extreme_element candidate{bounds.scaled, number_, element, {}};
    keep_least(sum.least, candidate);
    switch (bounds.verdict)
    {
    case Validity::valid:
      ++verdicts.valid;
      ++sum.histogram[std::min(Jacobian_report::bin_count - 1,
                               static_cast<std::size_t>(bounds.scaled * Jacobian_report::bin_count))];
      keep_least(sum.least_valid, candidate);
      break;
    case Validity::invalid: ++verdicts.invalid; break;
    case Validity::undecided: ++verdicts.undecided; break;
    }
    sum.subdivided_elements += bounds.is_subdivided;
    sum.exact_elements += bounds.is_exact;
  }

  void keep_least(Extreme_element& least, const Extreme_element& candidate) const
  {
    if (!(candidate < least))
      return;
    least = candidate;
    const int corners = corner_count(block_.type);
    for (int c = 0; c < corners; ++c)
    {
      const Point p = point(candidate.element, c);
      for (std::size_t d = 0; d < 3; ++d)
        least.position[d] += p[d] / corners;
    }
  }

  const Nodes& nodes_;
  Element_block block_;
  Index number_;
  const Jacobian_options& options_;
  const IsStraight& is_straight_;
  const Visit& visit_;
  Bounders& bounders_;
  Index stride_;
  const Jacobian_table& curved_table_;
  const Jacobian_table& straight_table_;
};

} // namespace recurve::internal

#endif
