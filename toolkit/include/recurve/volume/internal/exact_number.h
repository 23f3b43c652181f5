#ifndef RECURVE_VOLUME_INTERNAL_EXACT_NUMBER_H
#define RECURVE_VOLUME_INTERNAL_EXACT_NUMBER_H

#include <boost/multiprecision/cpp_int.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace recurve::internal {

using Integer = boost::multiprecision::cpp_int;
using Rational = boost::multiprecision::cpp_rational;

/// A double as mantissa * 2^exponent.
struct Binary_number
{
  std::int64_t mantissa = 0;
  int exponent = 0;
};

/// \pre `x` is finite
inline Binary_number binary_number(double x)
{
  int exponent = 0;
  const double fraction = std::frexp(x, &exponent);
  return {static_cast<std::int64_t>(std::ldexp(fraction, 53)), exponent - 53};
}

/// Largest relative error of the conversions below: a cut after 64 bits, and one rounding or two.
inline constexpr double conversion_error = 0x1p-51;

/// `number` * 2^`exponent` within `conversion_error`, with the sign of `number` even where it underflows.
inline double to_double(const Integer& number, int exponent = 0)
{
  if (number.is_zero())
    return 0;
  const Integer magnitude = abs(number);
  const int excess = std::max(0, static_cast<int>(msb(magnitude)) - 63);
  const auto leading = static_cast<std::uint64_t>(magnitude >> excess);
  const double result =
    std::max(std::ldexp(static_cast<double>(leading), exponent + excess), std::numeric_limits<double>::denorm_min());
  return number.sign() < 0 ? -result : result;
}

/// `number` within `conversion_error`, to the nearest double if numerator and denominator have at most 53 bits.
inline double to_double(const Rational& number)
{
  const Integer top = numerator(number), bottom = denominator(number);
  if (top.is_zero())
    return 0;
  const int top_bits = static_cast<int>(msb(abs(top))), bottom_bits = static_cast<int>(msb(bottom));
  if (top_bits < 53 && bottom_bits < 53)
    return to_double(top) / to_double(bottom);
  const int shift = std::max(0, 66 + bottom_bits - top_bits);
  return to_double(Integer((top << shift) / bottom), -shift);
}

} // namespace recurve::internal

#endif
