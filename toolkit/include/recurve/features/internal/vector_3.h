#ifndef RECURVE_FEATURES_INTERNAL_VECTOR_3_H
#define RECURVE_FEATURES_INTERNAL_VECTOR_3_H

#include <recurve/core/types.h>

#include <cmath>
#include <numbers>

namespace recurve::internal::features {

using Vector = Point;

inline constexpr double degrees_per_radian = 180 / std::numbers::pi;

inline Vector operator-(const Vector& a, const Vector& b)
{
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline Vector operator+(const Vector& a, const Vector& b)
{
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
inline Vector operator*(double s, const Vector& a)
{
  return {s * a[0], s * a[1], s * a[2]};
}
inline double dot(const Vector& a, const Vector& b)
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline Vector cross(const Vector& a, const Vector& b)
{
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline double norm(const Vector& a)
{
  return std::sqrt(dot(a, a));
}

/// `a` with length 1, or the zero vector if `a` is zero.
inline Vector normalized(const Vector& a)
{
  const double length = norm(a);
  return length > 0 ? (1 / length) * a : Vector{};
}

/// the angle between `a` and `b` in degrees, in [0, 180], accurate near both ends; 0 if one of them is zero.
inline double angle_between(const Vector& a, const Vector& b)
{
  return degrees_per_radian * std::atan2(norm(cross(a, b)), dot(a, b));
}

} // namespace recurve::internal::features

#endif
