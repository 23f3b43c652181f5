#ifndef RECURVE_VOLUME_INTERNAL_SUBDIVIDE_H
#define RECURVE_VOLUME_INTERNAL_SUBDIVIDE_H

#include <recurve/volume/internal/bernstein_bisection.h>
#include <recurve/volume/internal/exact_number.h>
#include <recurve/volume/internal/jacobian_table.h>
#include <recurve/volume/jacobian_bounds.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace recurve::internal {

/// Coefficients in doubles, of which each has at most a known error.
struct Rounded_arithmetic
{
  using Number = double;
  using State = double; ///< the error

  const double* values(const double* coefficients, State, int) { return coefficients; }
  static double lower(double value, State error) { return value - error; }
  static double upper(double value, State error) { return value + error; }

  /// whether subdivision may decide the sign of the value at a corner, which it does not change.
  static bool may_decide(double corner_value, State error) { return corner_value > error || corner_value <= -error; }

  /// Of the mean of two numbers only the sum is rounded, each coefficient at most `degree` times; means carry errors
  /// on without magnifying them. Twice the bound, for the rounding of the bound and of `lower()` and `upper()`.
  static State halved(State error, int degree, double magnitude)
  {
    return error + 2 * rounding_error(degree + 2) * (magnitude + error);
  }

  static double mean(double a, double b) { return 0.5 * (a + b); }
  static double raise(double x, int) { return x; }
};

/// Coefficients as integers times 2^-state times a unit.
class Exact_arithmetic
{
public:
  using Number = Integer;
  using State = int;

  explicit Exact_arithmetic(double unit) : unit_(unit) {}

  /// in doubles, with the exact sign.
  const double* values(const Integer* coefficients, State state, int count)
  {
    constexpr double least = std::numeric_limits<double>::denorm_min();
    values_.resize(static_cast<std::size_t>(count));
    for (std::size_t m = 0; m < values_.size(); ++m)
    {
      const double value = to_double(coefficients[m], -state) * unit_;
      const int sign = coefficients[m].sign();
      values_[m] = sign > 0 ? std::max(value, least) : sign < 0 ? std::min(value, -least) : 0;
    }
    return values_.data();
  }

  static double lower(double value, State)
  {
    return value > 0 ? value * (1 - relative_error) : value * (1 + relative_error);
  }
  static double upper(double value, State) { return -lower(-value, 0); }
  static bool may_decide(double, State) { return true; }
  static State halved(State state, int degree, double) { return state + degree; }
  static Integer mean(const Integer& a, const Integer& b) { return a + b; }
  static Integer raise(const Integer& x, int n) { return x << n; }

private:
  static constexpr double relative_error = 4 * conversion_error; ///< of two conversions, a product and this bound

  double unit_;
  std::vector<double> values_;
};

/// What subdivision found, in the unit of the coefficients.
struct Subdivision_result
{
  double lower = std::numeric_limits<double>::infinity();
  double upper = -std::numeric_limits<double>::infinity();
  double reached = std::numeric_limits<double>::infinity();
  bool is_stuck = false; ///< whether the error of the coefficients forbids a decision; then the rest means nothing
};

/// Parts of an element that are still to be examined, the next one last; kept from one element to the next.
template <class Arithmetic>
class Subdivision
{
public:
  using Number = typename Arithmetic::Number;
  using State = typename Arithmetic::State;

  /// room for the coefficients of the whole element.
  Number* root(int size)
  {
    reserve(1, size);
    return numbers_.data();
  }

  /// halves the element with the coefficients `root()` until the bounds decide about every part or the limits are
  /// reached. The half with the smaller coefficient comes first, so that an inverted point is found soon.
  Subdivision_result run(const Bisection_table& table, Arithmetic arithmetic, State state,
                         const Jacobian_options& options, int max_parts)
  {
    Subdivision_result result;
    double largest_reached = 0; // a lower bound of the largest |det J|
    parts_.assign(1, {state, 0});
    for (int examined = 1; !parts_.empty(); ++examined)
    {
      const Part part = parts_.back();
      const double* const values = arithmetic.values(top(table.size), part.state, table.size);
      const Extremes extremes = find_extremes(table, values);
      largest_reached = std::max(largest_reached, extremes.corner_magnitude);
      result.reached = std::min(result.reached, Arithmetic::upper(extremes.least_corner, part.state));
      const double lower = Arithmetic::lower(extremes.least, part.state);
      const bool is_decided = lower > 0 || result.reached <= 0;
      const bool is_sharp =
        std::isinf(options.sharpness) || lower >= result.reached - options.sharpness * largest_reached;
      if (!is_decided && !Arithmetic::may_decide(extremes.least_corner, part.state))
      {
        result.is_stuck = true;
        return result;
      }
      int bisection = -1;
      if (!(is_decided && is_sharp) && part.depth < options.max_depth && examined < max_parts)
        bisection = strongest_bisection(table, values);
      if (bisection >= 0)
        divide(table, static_cast<std::size_t>(bisection), extremes.magnitude());
      else
      {
        result.lower = std::min(result.lower, lower);
        result.upper = std::max(result.upper, Arithmetic::upper(extremes.largest, part.state));
        parts_.pop_back();
      }
    }
    return result;
  }

private:
  struct Part
  {
    State state;
    int depth;
  };

  struct Extremes
  {
    double least, largest, least_corner, corner_magnitude;

    double magnitude() const { return std::max(std::abs(least), std::abs(largest)); }
  };

  void reserve(std::size_t parts, int size)
  {
    const std::size_t needed = parts * static_cast<std::size_t>(size);
    if (numbers_.size() < needed)
      numbers_.resize(std::max(needed, 2 * numbers_.size()));
  }

  Number* top(int size) { return numbers_.data() + (parts_.size() - 1) * static_cast<std::size_t>(size); }

  static Extremes find_extremes(const Bisection_table& table, const double* values)
  {
    Extremes result{values[0], values[0], values[table.corners.front()], 0};
    for (int m = 1; m < table.size; ++m)
    {
      result.least = std::min(result.least, values[m]);
      result.largest = std::max(result.largest, values[m]);
    }
    for (const int corner : table.corners)
    {
      result.least_corner = std::min(result.least_corner, values[corner]);
      result.corner_magnitude = std::max(result.corner_magnitude, std::abs(values[corner]));
    }
    return result;
  }

  /// replaces the last part by its halves. Each line of coefficients is read before it is written: the first half takes
  /// the place of the whole.
  void divide(const Bisection_table& table, std::size_t which, double magnitude)
  {
    const Bisection& bisection = table.bisections[which];
    reserve(parts_.size() + 1, table.size);
    Number* const first = top(table.size);
    Number* const second = first + table.size;
    bisect(bisection, first, first, second, Arithmetic::mean, Arithmetic::raise);
    if (*std::min_element(first, second) < *std::min_element(second, second + table.size))
      std::swap_ranges(first, second, second);
    Part& part = parts_.back();
    part = {Arithmetic::halved(part.state, bisection.degree, magnitude), part.depth + 1};
    parts_.push_back(part);
  }

  std::vector<Number> numbers_; ///< coefficients of the parts, in their order
  std::vector<Part> parts_;
};

} // namespace recurve::internal

#endif
