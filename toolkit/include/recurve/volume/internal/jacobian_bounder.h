#ifndef RECURVE_VOLUME_INTERNAL_JACOBIAN_BOUNDER_H
#define RECURVE_VOLUME_INTERNAL_JACOBIAN_BOUNDER_H

#include <recurve/core/types.h>
#include <recurve/volume/internal/exact_jacobian.h>
#include <recurve/volume/internal/jacobian_kernels.h>
#include <recurve/volume/internal/subdivide.h>

#include <tbb/cache_aligned_allocator.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace recurve::internal {

/// `x` * 2^`exponent`, not above it.
inline double scaled_down(double x, int exponent)
{
  const double result = std::ldexp(x, exponent);
  if (std::isinf(result) && std::isfinite(x))
    return x > 0 ? std::numeric_limits<double>::max() : result;
  const bool is_rounded_up = std::ldexp(result, -exponent) > x; // it may be below the normal numbers
  return is_rounded_up ? std::nextafter(result, -std::numeric_limits<double>::infinity()) : result;
}

inline double scaled_up(double x, int exponent)
{
  return -scaled_down(-x, exponent);
}

/// whether all nodes of an edge are one point. Then det J = 0 at a corner.
inline bool has_collapsed_edge(Element_type type, int degree, std::span<const Point> nodes)
{
  for (int edge = 0; edge < reference_element(type).edge_count; ++edge)
  {
    const auto numbers = edge_nodes(type, degree, edge);
    const Point& first = nodes[static_cast<std::size_t>(numbers[0])];
    if (std::all_of(numbers.begin(), numbers.end(), [&](int m) { return nodes[static_cast<std::size_t>(m)] == first; }))
      return true;
  }
  return false;
}

/// Bounds elements batch by batch, for one thread. Its memory grows to what the largest element needs and is kept.
class Jacobian_bounder
{
public:
  explicit Jacobian_bounder(const Jacobian_kernel& kernel) : kernel_(kernel) {}

  int batch() const { return kernel_.batch; }

  /// where to put the nodes of a batch: [(3 node + component) * batch() + lane].
  double* nodes(const Jacobian_table& table)
  {
    const auto size = 3 * static_cast<std::size_t>(table.node_count * kernel_.batch);
    if (nodes_.size() < size)
      nodes_.resize(size);
    return nodes_.data();
  }

  /// bounds the elements whose nodes are there; every lane has to be filled.
  void bound(const Jacobian_table& table, const Jacobian_options& options, std::span<Jacobian_bounds> results)
  {
    const std::size_t size = workspace_size(table, kernel_.batch);
    if (work_.size() < size)
      work_.resize(size);
    kernel_.bound(table, nodes_.data(), work_.data(), batch_);
    for (std::size_t lane = 0; lane < results.size(); ++lane)
      results[lane] = is_decided(lane, options) ? first_bounds(lane) : examine(table, lane, options);
  }

private:
  bool is_decided(std::size_t lane, const Jacobian_options& options) const
  {
    const double lower = batch_.lower[lane], reached = batch_.reached[lane];
    const bool is_sharp = std::isinf(options.sharpness) || lower >= reached - options.sharpness * batch_.upper[lane];
    return (lower > 0 || reached <= 0) && is_sharp;
  }

  Jacobian_bounds first_bounds(std::size_t lane) const
  {
    return bounds({batch_.lower[lane], batch_.upper[lane], batch_.reached[lane], false}, batch_.exponent[lane]);
  }

  static Jacobian_bounds bounds(const Subdivision_result& result, int exponent)
  {
    Jacobian_bounds b;
    b.verdict = result.lower > 0 ? Validity::valid : result.reached <= 0 ? Validity::invalid : Validity::undecided;
    const double magnitude = std::max(result.upper, -result.lower);
    if (magnitude > 0)
      b.scaled = scaled_bound(result.lower / magnitude);
    b.lower = scaled_down(result.lower, 3 * exponent);
    b.upper = scaled_up(result.upper, 3 * exponent);
    b.reached = scaled_up(result.reached, 3 * exponent);
    return b;
  }

  /// a quotient, which has been rounded, as a lower bound of the same sign.
  static double scaled_bound(double quotient)
  {
    const double lowered = std::nextafter(quotient, -1.0);
    return quotient > 0 ? std::max(lowered, std::numeric_limits<double>::denorm_min()) : lowered;
  }

  /// What one batch cannot decide: the element for itself.
  Jacobian_bounds examine(const Jacobian_table& table, std::size_t lane, const Jacobian_options& options)
  {
    element_.resize(static_cast<std::size_t>(table.node_count));
    bool is_finite = true;
    for (std::size_t m = 0; m < element_.size(); ++m)
      for (std::size_t d = 0; d < 3; ++d)
      {
        element_[m][d] = nodes_[(3 * m + d) * static_cast<std::size_t>(kernel_.batch) + lane];
        is_finite = is_finite && std::isfinite(element_[m][d]);
      }
    if (!is_finite)
      return {};
    const bool is_number = std::isfinite(batch_.error[lane]); // not so if a difference overflows
    if (is_number && std::isinf(options.sharpness) && has_collapsed_edge(table.type, table.degree, element_))
    {
      batch_.reached[lane] = std::min(batch_.reached[lane], 0.0);
      return first_bounds(lane);
    }
    if (is_number)
    {
      const Subdivision_result result = sharpened(options, [&](const Jacobian_options& goal) {
        set_root(table, lane);
        return rounded_.run(table.bisections, Rounded_arithmetic(), batch_.error[lane], goal, goal.max_parts);
      });
      if (!result.is_stuck)
      {
        Jacobian_bounds b = bounds(result, batch_.exponent[lane]);
        b.is_subdivided = true;
        return b;
      }
    }
    return examine_exactly(table, options);
  }

  /// decides first, and sharpens then: a limit on the way must not cost the verdict.
  template <class Run>
  static Subdivision_result sharpened(const Jacobian_options& options, Run run)
  {
    Jacobian_options verdict_only = options;
    verdict_only.sharpness = std::numeric_limits<double>::infinity();
    Subdivision_result result = run(verdict_only);
    if (std::isinf(options.sharpness) || result.is_stuck)
      return result;
    const Subdivision_result sharp = run(options);
    result.is_stuck = sharp.is_stuck;
    result.lower = std::max(result.lower, sharp.lower);
    result.upper = std::min(result.upper, sharp.upper);
    result.reached = std::min(result.reached, sharp.reached);
    return result;
  }

  void set_root(const Jacobian_table& table, std::size_t lane)
  {
    double* const root = rounded_.root(table.bisections.size);
    for (std::size_t m = 0; m < table.positions.size(); ++m)
      root[m] =
        batch_
          .coefficients[static_cast<std::size_t>(table.positions[m]) * static_cast<std::size_t>(kernel_.batch) + lane];
  }

  Jacobian_bounds examine_exactly(const Jacobian_table& table, const Jacobian_options& options)
  {
    const Exact_jacobian jacobian(table, element_);
    const Exact_arithmetic arithmetic(1 / to_double(jacobian.denominator()));
    const Subdivision_result result = sharpened(options, [&](const Jacobian_options& goal) {
      std::copy(jacobian.coefficients().begin(), jacobian.coefficients().end(), exact_.root(table.bisections.size));
      return exact_.run(table.bisections, arithmetic, jacobian.shift(), goal, goal.max_exact_parts);
    });
    Jacobian_bounds b = bounds(result, jacobian.exponent());
    b.is_subdivided = true;
    b.is_exact = true;
    return b;
  }

  using Numbers = std::vector<double, tbb::cache_aligned_allocator<double>>;

  Jacobian_kernel kernel_;
  Numbers nodes_, work_;
  Batch_bounds batch_;
  std::vector<Point> element_;
  Subdivision<Rounded_arithmetic> rounded_;
  Subdivision<Exact_arithmetic> exact_;
};

} // namespace recurve::internal

#endif
