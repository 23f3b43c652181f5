#ifndef RECURVE_VOLUME_INFLUENCE_H
#define RECURVE_VOLUME_INFLUENCE_H

#include <recurve/core/exceptions.h>

#include <algorithm>
#include <array>
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
concept Influence = requires(const W& w, double q)
{
  {
    w.length()
    } -> std::convertible_to<double>;
  {
    w(q)
    } -> std::convertible_to<double>;
};

/// An influence that can be summed fast. It has to be a sum of positive multiples of inverse powers of the distance
/// (then the radial direction is the worst for its Taylor series), and to know of itself:
///   - `w.derivatives(q, values)`  values[m] = (2 d/dq)^m w(q), m = 0 .. values.size()-1.
///   - `w.remainder(distance, mean_radius, largest_radius, degree)`  a bound of what the Taylor polynomial of degree
///     `degree` at a point that far away omits, averaged over displacements of its argument that are nowhere longer
///     than `largest_radius` < `distance` and whose mean of order degree + 1 is at most `mean_radius`.
template <class W>
concept Expandable_influence = Influence<W> && requires(const W& w, double q, std::span<double> values, int degree)
{
  w.derivatives(q, values);
  {
    w.remainder(q, q, q, degree)
    } -> std::convertible_to<double>;
};

namespace internal {

/// binomial(power + degree, degree + 1) for any positive power.
constexpr double leading_coefficient(double power, int degree)
{
  double result = 1;
  for (int k = 0; k <= degree; ++k)
    result *= (power + k) / (k + 1);
  return result;
}

/// The remainder of |x|^-power, divided by |x|^-power and by (mean radius / distance)^(degree + 1); see
/// `Expandable_influence`. The term of degree k of the series of |x + d|^-power is at most
/// binomial(power + k - 1, k) (|d|/|x|)^k |x|^-power, since Gegenbauer polynomials are largest at 1; and the quotient
/// of successive ones from there on is at most max(1, (power + k)/(k + 1)) |d|/|x|, so that the remainder is less than
/// a geometric series. \param ratio  largest radius / distance.
constexpr double remainder_factor(double coefficient, double power, double ratio, int degree)
{
  const double quotient = ratio * std::max(1.0, (power + degree + 1) / (degree + 2));
  return quotient < 1 ? coefficient / (1 - quotient) : std::numeric_limits<double>::infinity();
}

constexpr double integer_power(double x, int n)
{
  double result = 1;
  for (; n > 0; n /= 2, x *= x)
    if (n % 2 == 1)
      result *= x;
  return result;
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
    near_factor_ = internal::integer_power(alpha, B);
  }

  double length() const { return length_; }
  double near_factor() const { return near_factor_; } ///< alpha^B

  double operator()(double q) const
  {
    const double u = 1 / std::sqrt(q);
    return internal::integer_power(u, A) + near_factor_ * internal::integer_power(u, B);
  }

  void derivatives(double q, std::span<double> values) const
  {
    const double u = 1 / std::sqrt(q);
    double far = internal::integer_power(u, A), near = near_factor_ * internal::integer_power(u, B);
    for (std::size_t m = 0; m < values.size(); ++m)
    {
      values[m] = far + near;
      far *= -(A + 2.0 * static_cast<double>(m)) / q;
      near *= -(B + 2.0 * static_cast<double>(m)) / q;
    }
  }

  double remainder(double distance, double mean_radius, double largest_radius, int degree) const
  {
    const double inverse = 1 / distance, ratio = largest_radius * inverse;
    const auto [far, near] = coefficients(degree);
    return internal::integer_power(mean_radius * inverse, degree + 1) *
           (internal::integer_power(inverse, A) * internal::remainder_factor(far, A, ratio, degree) +
            near_factor_ * internal::integer_power(inverse, B) * internal::remainder_factor(near, B, ratio, degree));
  }

private:
  static std::array<double, 2> coefficients(int degree)
  {
    static constexpr auto table = [] {
      std::array<std::array<double, 2>, 16> result = {};
      for (int k = 0; k < 16; ++k)
        result[static_cast<std::size_t>(k)] = {internal::leading_coefficient(A, k),
                                               internal::leading_coefficient(B, k)};
      return result;
    }();
    if (degree < 16)
      return table[static_cast<std::size_t>(degree)];
    return {internal::leading_coefficient(A, degree), internal::leading_coefficient(B, degree)};
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

  double remainder(double distance, double mean_radius, double largest_radius, int degree) const
  {
    const double ratio = largest_radius / distance;
    const auto part = [&](double power) {
      return std::pow(distance, -power) *
             internal::remainder_factor(internal::leading_coefficient(power, degree), power, ratio, degree);
    };
    return internal::integer_power(mean_radius / distance, degree + 1) * (part(a_) + near_factor_ * part(b_));
  }

private:
  double length_, a_, b_, near_factor_;
};

} // namespace recurve

#endif
