#ifndef RECURVE_VOLUME_INFLUENCE_H
#define RECURVE_VOLUME_INFLUENCE_H

#include <recurve/core/exceptions.h>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <limits>
#include <span>
#include <string>

namespace recurve {

/// How strongly a source moves a point, by their distance: positive, decreasing. All lengths are given in units of
/// `length()`, so that the numbers stay near 1 whatever the unit of the mesh.
///   - `w.length()`  positive, in the unit of the points.
///   - `w(q)`        weight at squared distance q > 0 (in units of length()^2).
template <class W>
concept Influence = requires(const W& w, double q) {
  { w.length() } -> std::convertible_to<double>;
  { w(q) } -> std::convertible_to<double>;
};

/// An influence that can be summed fast. It has to be a sum of positive multiples of inverse powers of the distance
/// (then the radial direction is the worst for its Taylor series), and to know of itself:
///   - `w.derivatives(q, values)`  values[m] = (2 d/dq)^m w(q), m = 0 .. values.size()-1.
///   - `w.remainders(distance, mean_radius, largest_radius, values)`  values[k] = a bound of what the Taylor polynomial of
///     degree k at a point that far away omits, averaged over displacements of its argument that are nowhere longer
///     than `largest_radius` < `distance` and whose mean of order k + 1 is at most `mean_radius`.
template <class W>
concept Expandable_influence = Influence<W> && requires(const W& w, double q, std::span<double> values) {
  w.derivatives(q, values);
  w.remainders(q, q, q, values);
};

namespace internal {

/// adds `factor` times the remainders of |x|^-power; see `Expandable_influence`. The term of degree k of the series of
/// |x + d|^-power is at most binomial(power + k - 1, k) (|d|/|x|)^k |x|^-power, since Gegenbauer polynomials are largest
/// at 1. The quotient of successive terms tends to |d|/|x| and is largest (power > 1) or smallest in front, so that the
/// remainder is less than a geometric series.
template <class Power>
void add_remainders(Power power, double factor, double distance, double mean_radius, double largest_radius,
                    std::span<double> values)
{
  const double inverse = 1 / distance;
  const double ratio = mean_radius * inverse, largest_ratio = largest_radius * inverse;
  double term = factor;
  if constexpr (std::integral<Power>)
    for (Power k = 0; k < power; ++k)
      term *= inverse;
  else
    term *= std::pow(inverse, power);
  const double p = static_cast<double>(power);
  double k = 1;
  for (double& value : values)
  {
    term *= ratio * ((p + k - 1) / k);
    const double quotient = largest_ratio * std::max(1.0, (p + k) / (k + 1));
    value += quotient < 1 ? term / (1 - quotient) : std::numeric_limits<double>::infinity();
    k += 1;
  }
}

inline void check_influence(double a, double b, double alpha, double length)
{
  const auto is_positive = [](double x) { return x > 0 && x < std::numeric_limits<double>::infinity(); };
  if (!is_positive(length))
    throw Input_error("influence: the length has to be positive and finite, not " + std::to_string(length));
  if (!(alpha >= 0 && alpha < std::numeric_limits<double>::infinity()))
    throw Input_error("influence: alpha has to be finite and not negative, not " + std::to_string(alpha));
  if (!is_positive(a) || !is_positive(b))
    throw Input_error("influence: the exponents have to be positive and finite, not " + std::to_string(a) + " and " +
                      std::to_string(b));
}

} // namespace internal

/// The paper's formula, w = (L/r)^A + (alpha L/r)^B. The exponents are known to the compiler, so that no power function
/// is called; use `Inverse_distance_powers` for other numbers.
/// \par Source  Luke, Collins & Blades 2012, J. Comput. Phys. 231; Ims & Wang 2018, section 3.4.
template <int A = 3, int B = 5>
class Inverse_distance
{
public:
  static constexpr int far_exponent = A;
  static constexpr int near_exponent = B;

  /// \throws Input_error unless `length` is positive and `alpha` not negative.
  explicit Inverse_distance(double length, double alpha = 0.9) : length_(length)
  {
    static_assert(A > 0 && B > 0);
    internal::check_influence(A, B, alpha, length);
    near_factor_ = integer_power(alpha, B);
  }

  double length() const { return length_; }
  double near_factor() const { return near_factor_; } ///< alpha^B

  double operator()(double q) const
  {
    const double u = 1 / std::sqrt(q);
    return integer_power(u, A) + near_factor_ * integer_power(u, B);
  }

  void derivatives(double q, std::span<double> values) const
  {
    const double u = 1 / std::sqrt(q);
    double far = integer_power(u, A), near = near_factor_ * integer_power(u, B);
    for (std::size_t m = 0; m < values.size(); ++m)
    {
      values[m] = far + near;
      far *= -(A + 2.0 * static_cast<double>(m)) / q;
      near *= -(B + 2.0 * static_cast<double>(m)) / q;
    }
  }

  void remainders(double distance, double mean_radius, double largest_radius, std::span<double> values) const
  {
    std::ranges::fill(values, 0.0);
    internal::add_remainders(A, 1, distance, mean_radius, largest_radius, values);
    internal::add_remainders(B, near_factor_, distance, mean_radius, largest_radius, values);
  }

private:
  static constexpr double integer_power(double x, int n)
  {
    double result = 1;
    for (; n > 0; --n)
      result *= x;
    return result;
  }

  double length_;
  double near_factor_;
};

/// The same formula with any exponents, through the power function: slower.
class Inverse_distance_powers
{
public:
  /// \throws Input_error unless `length`, `a` and `b` are positive and `alpha` is not negative.
  Inverse_distance_powers(double length, double alpha, double a, double b) : length_(length), a_(a), b_(b)
  {
    internal::check_influence(a, b, alpha, length);
    near_factor_ = std::pow(alpha, b);
  }

  double length() const { return length_; }

  double operator()(double q) const { return std::pow(q, -a_ / 2) + near_factor_ * std::pow(q, -b_ / 2); }

  void derivatives(double q, std::span<double> values) const
  {
    double far = std::pow(q, -a_ / 2), near = near_factor_ * std::pow(q, -b_ / 2);
    for (std::size_t m = 0; m < values.size(); ++m)
    {
      values[m] = far + near;
      far *= -(a_ + 2.0 * static_cast<double>(m)) / q;
      near *= -(b_ + 2.0 * static_cast<double>(m)) / q;
    }
  }

  void remainders(double distance, double mean_radius, double largest_radius, std::span<double> values) const
  {
    std::ranges::fill(values, 0.0);
    internal::add_remainders(a_, 1, distance, mean_radius, largest_radius, values);
    internal::add_remainders(b_, near_factor_, distance, mean_radius, largest_radius, values);
  }

private:
  double length_, a_, b_, near_factor_;
};

} // namespace recurve

#endif
