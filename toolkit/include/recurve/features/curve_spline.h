#ifndef RECURVE_FEATURES_CURVE_SPLINE_H
#define RECURVE_FEATURES_CURVE_SPLINE_H

#include <recurve/core/exceptions.h>
#include <recurve/core/types.h>
#include <recurve/features/internal/curve_polynomials.h>

#include <span>
#include <string>
#include <vector>

namespace recurve {

/// How a `Curve_spline` goes through its points.
enum class Curve_method
{
  automatic,    ///< `cubic_spline` up to degree 3, `local` above
  cubic_spline, ///< twice continuously differentiable; rate 4
  local         ///< each segment from the nearest points, of the next odd degree above the given one; rate > degree + 1
};

/// What the construction of a `Curve_spline` may vary.
struct Curve_fit_options
{
  Curve_method method = Curve_method::automatic;
  int degree = 3; ///< of the surface that the curve bounds; 1 <= degree <= 6
};

/// A curve through points, parameterised by its approximate arc length.
///
/// The cubic spline takes chord lengths as the parameter and is "interpolated" at open ends: the first two and the
/// last two polynomials are one (not-a-knot), so that no end slope is invented; two points give their line, three their
/// parabola. Closed curves are periodic. `Curve_method::local` interpolates the nearest points around each segment and
/// finds the arc length by iteration; where terms of higher degree do not get smaller (a bend too tight for its points)
/// they are left out. Points on a line give exactly the line, and where a coordinate of the points is constant, the
/// curve has exactly that coordinate.
class Curve_spline
{
public:
  /// goes through `points` in their order; a closed curve (the first point not repeated) returns to the first. Segment
  /// i goes from point i to the next one. Consecutive equal points are allowed.
  /// \throws Input_error for fewer than two points, one that is not finite, or a degree out of range.
  /// \par Complexity  linear in the points.
  Curve_spline(std::span<const Point> points, bool is_closed, const Curve_fit_options& options = {})
  {
    if (points.size() < 2)
      throw Input_error("Curve_spline: needs at least two points, but has " + std::to_string(points.size()));
    if (options.degree < 1 || options.degree > 6)
      throw Input_error("Curve_spline: the degree must be 1 to 6, but is " + std::to_string(options.degree));
    namespace f = internal::features;
    f::require_finite(points);
    const bool is_cubic = options.method == Curve_method::cubic_spline ||
                          (options.method == Curve_method::automatic && options.degree <= 3);
    segments_ = is_cubic ? f::cubic_spline(points, is_closed)
                         : f::local_interpolation(points, is_closed, options.degree + 1 + options.degree % 2);
  }

  Index number_of_segments() const { return static_cast<Index>(segments_.size()); }

  /// the position at the fraction `t` of the parameter of `segment`; exactly its points at 0 and 1.
  Point operator()(Index segment, double t) const { return segments_[segment].position(t); }

  /// the derivative by `t` there.
  Point derivative(Index segment, double t) const { return segments_[segment].derivative(t); }

  /// the arc length of `segment`.
  double length(Index segment) const { return segments_[segment].length(); }

private:
  std::vector<internal::features::Curve_segment> segments_;
};

} // namespace recurve

#endif
