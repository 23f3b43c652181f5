#ifndef RECURVE_FEATURES_INTERNAL_CURVE_POLYNOMIALS_H
#define RECURVE_FEATURES_INTERNAL_CURVE_POLYNOMIALS_H

#include <recurve/core/exceptions.h>
#include <recurve/features/internal/vector_3.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace recurve::internal::features {

/// the highest degree of a segment.
inline constexpr int max_curve_degree = 7;

/// One polynomial between two points: the straight segment plus t (1 - t) (c_0 + c_1 t + ...). Written as a correction
/// of the segment it is exact at its ends, and a vanishing correction leaves exactly the segment.
struct Curve_segment
{
  Point first{}, last{};
  std::array<Vector, max_curve_degree - 1> coefficients{};

  Point position(double t) const
  {
    const Vector chord = last - first;
    const Point straight = t <= 0.5 ? first + t * chord : last - (1 - t) * chord;
    return straight + t * (1 - t) * bend(t);
  }

  Vector derivative(double t) const
  {
    Vector bend_derivative{};
    for (int k = static_cast<int>(coefficients.size()) - 1; k >= 1; --k)
      bend_derivative = t * bend_derivative + static_cast<double>(k) * coefficients[k];
    return last - first + (1 - 2 * t) * bend(t) + t * (1 - t) * bend_derivative;
  }

  /// by the Gauss-Legendre rule of five points.
  double length() const
  {
    constexpr double x[] = {0.5384693101056831, 0.9061798459386640};
    constexpr double w[] = {0.5688888888888889, 0.4786286704993665, 0.2369268850561891};
    double sum = w[0] * norm(derivative(0.5));
    for (int i = 0; i < 2; ++i)
      sum += w[i + 1] * (norm(derivative(0.5 - x[i] / 2)) + norm(derivative(0.5 + x[i] / 2)));
    return sum / 2;
  }

  /// drops a correction that is within round-off of the positions, so that a straight curve is exactly straight.
  void straighten_if_negligible()
  {
    constexpr double ulps = 16; // differences of rounded positions, amplified by up to about ten at one-sided ends
    double magnitude = 0, correction = 0;
    for (int i = 0; i < 3; ++i)
      magnitude = std::max({magnitude, std::abs(first[i]), std::abs(last[i])});
    for (const Vector& c : coefficients)
      correction += norm(c) / 4;
    if (correction <= ulps * std::numeric_limits<double>::epsilon() * magnitude)
      coefficients.fill({});
  }

private:
  Vector bend(double t) const
  {
    Vector sum{};
    for (int k = static_cast<int>(coefficients.size()) - 1; k >= 0; --k)
      sum = t * sum + coefficients[k];
    return sum;
  }
};

inline void require_finite(std::span<const Point> points)
{
  for (std::size_t i = 0; i < points.size(); ++i)
    for (const double x : points[i])
      if (!std::isfinite(x))
        throw Input_error("Curve_spline: point " + std::to_string(i) + " is not finite");
}

/// The points of a curve without repetitions, and which segment of the curve each gap between them is.
struct Distinct_points
{
  std::vector<Point> points;
  std::vector<Index> segment_of; ///< per gap; as many gaps as points on a closed curve, one less on an open one
};

inline Distinct_points distinct(std::span<const Point> points, bool is_closed)
{
  Distinct_points d;
  const std::size_t n = points.size();
  for (std::size_t i = 0; i < n; ++i)
  {
    const bool has_gap = i + 1 < n ? points[i] != points[i + 1] : is_closed && points[i] != points[0];
    if (has_gap || (i + 1 == n && !is_closed))
      d.points.push_back(points[i]);
    if (has_gap)
      d.segment_of.push_back(static_cast<Index>(i));
  }
  return d;
}

/// the segments of a polygon, all straight.
inline std::vector<Curve_segment> straight_segments(std::span<const Point> points, bool is_closed)
{
  std::vector<Curve_segment> segments(is_closed ? points.size() : points.size() - 1);
  for (std::size_t i = 0; i < segments.size(); ++i)
    segments[i].first = points[i], segments[i].last = points[(i + 1) % points.size()];
  return segments;
}

/// A tridiagonal system with three right-hand sides at once: lower[i] x[i-1] + diagonal[i] x[i] + upper[i] x[i+1].
struct Tridiagonal
{
  std::vector<double> lower, diagonal, upper;

  explicit Tridiagonal(std::size_t n) : lower(n, 0), diagonal(n, 0), upper(n, 0) {}

  /// by elimination without pivoting, for diagonally dominant systems.
  template <class Value>
  std::vector<Value> solve(std::vector<Value> x) const
  {
    const std::size_t n = diagonal.size();
    std::vector<double> pivot = diagonal;
    for (std::size_t i = 1; i < n; ++i)
    {
      const double factor = lower[i] / pivot[i - 1];
      pivot[i] -= factor * upper[i - 1];
      x[i] = x[i] - factor * x[i - 1];
    }
    x[n - 1] = (1 / pivot[n - 1]) * x[n - 1];
    for (std::size_t i = n - 1; i-- > 0;)
      x[i] = (1 / pivot[i]) * (x[i] - upper[i] * x[i + 1]);
    return x;
  }
};

/// the second derivatives at the points of the cubic spline through `p` with the gaps `h`, not-a-knot at both ends.
inline std::vector<Vector> open_second_derivatives(const std::vector<Vector>& slope, const std::vector<double>& h)
{
  const std::size_t n = h.size() + 1;
  std::vector<Vector> m(n, Vector{});
  if (n == 2)
    return m;
  std::vector<Vector> right(n - 2);
  for (std::size_t i = 0; i < n - 2; ++i)
    right[i] = 6. * (slope[i + 1] - slope[i]);
  if (n == 3)
    m.assign(3, 1 / (3 * (h[0] + h[1])) * right[0]);
  else
  {
    Tridiagonal a(n - 2);
    for (std::size_t i = 0; i < n - 2; ++i)
      a.lower[i] = h[i], a.diagonal[i] = 2 * (h[i] + h[i + 1]), a.upper[i] = h[i + 1];
    // one polynomial over the two gaps at an end: the outermost second derivative continues the next two linearly
    const double first = h[0] / h[1], last = h[n - 2] / h[n - 3];
    a.diagonal[0] += h[0] * (1 + first), a.upper[0] -= h[0] * first;
    a.diagonal[n - 3] += h[n - 2] * (1 + last), a.lower[n - 3] -= h[n - 2] * last;
    const std::vector<Vector> inner = a.solve(right);
    std::copy(inner.begin(), inner.end(), m.begin() + 1);
    m[0] = m[1] - first * (m[2] - m[1]);
    m[n - 1] = m[n - 2] + last * (m[n - 2] - m[n - 3]);
  }
  return m;
}

/// the same for a closed curve: a cyclic system, solved as a tridiagonal one plus a correction of rank one.
inline std::vector<Vector> closed_second_derivatives(const std::vector<Vector>& slope, const std::vector<double>& h)
{
  const std::size_t n = h.size();
  Tridiagonal a(n);
  std::vector<Vector> right(n);
  for (std::size_t i = 0; i < n; ++i)
  {
    const std::size_t before = (i + n - 1) % n;
    a.lower[i] = h[before], a.diagonal[i] = 2 * (h[before] + h[i]), a.upper[i] = h[i];
    right[i] = 6. * (slope[i] - slope[before]);
  }
  const double corner = h[n - 1], gamma = -a.diagonal[0];
  a.diagonal[0] -= gamma;
  a.diagonal[n - 1] -= corner * corner / gamma;
  std::vector<Vector> x = a.solve(right);
  std::vector<Vector> unit(n, Vector{});
  unit[0][0] = gamma, unit[n - 1][0] = corner;
  const std::vector<Vector> z = a.solve(unit);
  const double denominator = 1 + z[0][0] + corner / gamma * z[n - 1][0];
  const Vector factor = (1 / denominator) * (x[0] + (corner / gamma) * x[n - 1]);
  for (std::size_t i = 0; i < n; ++i)
    x[i] = x[i] - z[i][0] * factor;
  return x;
}

/// the cubic spline over chord lengths.
inline std::vector<Curve_segment> cubic_spline(std::span<const Point> points, bool is_closed)
{
  std::vector<Curve_segment> segments = straight_segments(points, is_closed);
  const Distinct_points d = distinct(points, is_closed);
  const std::size_t gaps = d.segment_of.size();
  if (gaps < 2 || (is_closed && gaps < 3))
    return segments;
  std::vector<double> h;
  std::vector<Vector> slope;
  for (const Index i : d.segment_of)
  {
    const Vector chord = segments[i].last - segments[i].first;
    h.push_back(norm(chord));
    slope.push_back((1 / h.back()) * chord);
  }
  const auto m = is_closed ? closed_second_derivatives(slope, h) : open_second_derivatives(slope, h);
  for (std::size_t k = 0; k < gaps; ++k)
  {
    const Vector &m0 = m[k], &m1 = m[(k + 1) % m.size()];
    Curve_segment& segment = segments[d.segment_of[k]];
    segment.coefficients[0] = (-h[k] * h[k] / 6) * (2. * m0 + m1);
    segment.coefficients[1] = (-h[k] * h[k] / 6) * (m1 - m0);
    segment.straighten_if_negligible();
  }
  return segments;
}

/// Interpolates the points nearest to each segment in turn.
class Local_interpolator
{
public:
  Local_interpolator(const std::vector<Point>& points, bool is_closed) : points_(points), is_closed_(is_closed) {}

  /// sets the coefficients of the gap `k`, interpolating up to degree + 1 points whose parameters are the sums of
  /// `gaps`.
  void fit(Index k, int degree, const std::vector<double>& gaps, Curve_segment& segment)
  {
    choose_points(k, degree, gaps);
    divide_differences();
    const std::size_t terms = useful_terms();
    segment.coefficients.fill({});
    // (t - 0)(t - 1)(d_2 + (t - t_2)(d_3 + ...)) as powers of t
    auto& c = segment.coefficients;
    for (std::size_t i = terms; i-- > 2;)
    {
      for (std::size_t j = c.size(); j-- > 1;)
        c[j] = c[j - 1] - t_[i] * c[j];
      c[0] = difference_[i] - t_[i] * c[0];
    }
    for (Vector& x : c)
      x = -1. * x;
    segment.straighten_if_negligible();
  }

private:
  /// lists the points of the stencil with their parameters, 0 and 1 at the ends of the gap `k`: its ends first, then
  /// outwards in turn, so that the terms of Newton's formula get smaller.
  void choose_points(Index k, int degree, const std::vector<double>& gaps)
  {
    const Index n = static_cast<Index>(points_.size()), gap_count = static_cast<Index>(gaps.size());
    const auto point = [&](Index i) { return points_[((i % n) + n) % n] - points_[k]; };
    t_ = {0, 1};
    difference_ = {Vector{}, point(k + 1)};
    Index before = k, after = k + 1;
    double t_before = 0, t_after = 1;
    while (static_cast<int>(t_.size()) <= degree)
    {
      const bool has_before = is_closed_ ? after - before < n : before > 0;
      const bool has_after = is_closed_ ? after - before < n : after < n - 1;
      if (!has_before && !has_after)
        break;
      const bool is_before = has_before && (!has_after || k - before <= after - k - 1);
      if (is_before)
      {
        --before;
        t_before -= gaps[((before % gap_count) + gap_count) % gap_count] / gaps[k];
        t_.push_back(t_before);
        difference_.push_back(point(before));
      }
      else
      {
        t_after += gaps[((after % gap_count) + gap_count) % gap_count] / gaps[k];
        ++after;
        t_.push_back(t_after);
        difference_.push_back(point(after));
      }
    }
  }

  void divide_differences()
  {
    const std::size_t n = t_.size();
    for (std::size_t order = 1; order < n; ++order)
      for (std::size_t i = n - 1; i >= order; --i)
        difference_[i] = (1 / (t_[i] - t_[i - order])) * (difference_[i] - difference_[i - 1]);
  }

  /// how many terms to use: pairs of terms (one more point on either side) as long as what they change gets smaller.
  /// Measured at places and in steps that do not depend on the direction of the curve.
  std::size_t useful_terms() const
  {
    constexpr double places[] = {0.25, 0.5, 0.75};
    double product[] = {1, 1, 1}, previous = std::numeric_limits<double>::infinity();
    std::size_t used = 2;
    while (used < t_.size())
    {
      const std::size_t end = std::min(used + 2, t_.size());
      double change = 0;
      for (int j = 0; j < 3; ++j)
      {
        const double t = places[j];
        Vector sum{};
        for (std::size_t i = used; i < end; ++i, product[j] *= t - t_[i - 1])
          sum = sum + product[j] * difference_[i];
        change += t * (1 - t) * norm(sum);
      }
      if (change > previous)
        break;
      previous = change;
      used = end;
    }
    return used;
  }

  const std::vector<Point>& points_;
  bool is_closed_;
  std::vector<double> t_;
  std::vector<Vector> difference_;
};

/// polynomials of the odd `degree` through the nearest points. Their parameter has to be the arc length to as many
/// orders as they are to gain: the length of interpolants of degree q gives it to order q + 2, so it is raised in
/// steps.
inline std::vector<Curve_segment> local_interpolation(std::span<const Point> points, bool is_closed, int degree)
{
  std::vector<Curve_segment> segments = straight_segments(points, is_closed);
  const Distinct_points d = distinct(points, is_closed);
  if (d.segment_of.size() < 2 || (is_closed && d.segment_of.size() < 3))
    return segments;
  Local_interpolator interpolator(d.points, is_closed);
  std::vector<double> gaps(d.segment_of.size());
  for (int raised = 3; raised <= degree; raised += 2)
  {
    for (std::size_t k = 0; k < gaps.size(); ++k)
      gaps[k] = segments[d.segment_of[k]].length();
    for (std::size_t k = 0; k < gaps.size(); ++k)
      interpolator.fit(static_cast<Index>(k), raised, gaps, segments[d.segment_of[k]]);
  }
  return segments;
}

} // namespace recurve::internal::features

#endif
