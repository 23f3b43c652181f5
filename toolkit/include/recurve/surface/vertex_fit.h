#ifndef RECURVE_SURFACE_VERTEX_FIT_H
#define RECURVE_SURFACE_VERTEX_FIT_H

#include <recurve/core/types.h>
#include <recurve/surface/local_fit.h>
#include <recurve/surface/row_circles.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

namespace recurve {

/// Largest degree of the polynomial of a `Vertex_fit`.
inline constexpr int max_vertex_fit_degree = 12;

/// What a `Vertex_fit` is good for.
enum class Vertex_fit_state : std::uint8_t
{
  none,   ///< the surface is not smooth at the vertex (a cone tip), or it has no normal: its neighbours decide alone
  planar, ///< the surface around it is planar to round-off
  flat,   ///< no fit was good enough: the straight-sided shape counts
  curved
};

/// Polynomial height function around one vertex of a surface region, over the plane across a normal. It goes through
/// the vertex.
///
/// The surface near the vertex is the set of points x with w = height(s, t), where s = (x - origin) . s_axis, t = (x -
/// origin) . t_axis and w = (x - origin) . n. The axes span the plane; they measure the neighbours of the vertex, so
/// that s and t of these are about 1 however long and thin the faces are. The height is a polynomial of s and t, or,
/// where rows of long faces bend, of the coordinates along and across these.
///
/// A view: the coefficients are kept elsewhere, by the `Vertex_fits` that a fit comes from. A copy is of use as long as
/// these, or copies of them, are there. `height()` and what builds on it read the coefficients of `degree`.
struct Vertex_fit
{
  static constexpr double no_height = 0; ///< coefficients of degree 0

  Point origin = {};               ///< the vertex
  Point n = {0, 0, 1};             ///< unit normal of the plane; at a rim that of the points, which all lie on one side
  Point s_axis = {1, 0, 0};        ///< across n, one over a length
  Point t_axis = {0, 1, 0};        ///< across n and s_axis, one over a length
  Point vertex_normal = {0, 0, 1}; ///< unit normal of the straight-sided mesh at the vertex; nodes are moved along it
  Row_circles rows = {};           ///< bend s and t within the plane
  double size = 1;                 ///< unit of the heights and mean distance of the neighbours, a length > 0
  std::int32_t degree = 0;         ///< 0 to max_vertex_fit_degree
  Vertex_fit_state state = Vertex_fit_state::none;
  std::span<const double> coefficients = {&no_height, 1}; ///< coefficient_count(degree) of them: of powers j and k at
                                                          ///< coefficient_number(j, k), in units of `size`; [0] is 0

  /// height over the plane and its derivatives by s and t; lengths in the unit of the mesh.
  struct Height
  {
    double value = 0, by_s = 0, by_t = 0;
  };

  Point local_coordinates(const Point& x) const
  {
    const Point r = {x[0] - origin[0], x[1] - origin[1], x[2] - origin[2]};
    return local_direction(r);
  }

  Point local_direction(const Point& r) const
  {
    return {r[0] * s_axis[0] + r[1] * s_axis[1] + r[2] * s_axis[2],
            r[0] * t_axis[0] + r[1] * t_axis[1] + r[2] * t_axis[2], r[0] * n[0] + r[1] * n[1] + r[2] * n[2]};
  }

  /// local coordinates along and across the rows, in which the polynomial is.
  Point row_coordinates(const Point& x) const
  {
    const Point local = local_coordinates(x);
    const auto [along, across] = rows.place(local[0], local[1]);
    return {along, across, local[2]};
  }

  double height(double s, double t) const;
  Height height_and_slopes(double s, double t) const;

  /// unit normal of the surface above (s, t).
  Point normal(double s, double t) const;

  /// the number a for which x + a * direction lies on the surface, by Newton's method from x: where the surface is not
  /// near x any number, or none.
  double way_along(const Point& x, const Point& direction) const;

  /// the two principal curvatures at the vertex, the larger first; one over a length, positive where the surface bends
  /// away from the normal (a sphere with outward normals).
  std::array<double, 2> principal_curvatures() const;
};

inline double Vertex_fit::height(double s, double t) const
{
  const auto [along, across] = rows.place(s, t);
  double sum = 0;
  for (int j = degree; j >= 0; --j)
  {
    double row = 0;
    for (int k = degree - j; k >= 0; --k)
      row = row * across + coefficients[static_cast<std::size_t>(coefficient_number(j, k))];
    sum = sum * along + row;
  }
  return size * sum;
}

inline Vertex_fit::Height Vertex_fit::height_and_slopes(double s, double t) const
{
  const auto [along, across] = rows.place(s, t);
  double sum = 0, by_along = 0, by_across = 0;
  for (int j = degree; j >= 0; --j)
  {
    double row = 0, row_by_across = 0;
    for (int k = degree - j; k >= 0; --k)
    {
      row_by_across = row_by_across * across + row;
      row = row * across + coefficients[static_cast<std::size_t>(coefficient_number(j, k))];
    }
    by_along = by_along * along + sum;
    sum = sum * along + row;
    by_across = by_across * along + row_by_across;
  }
  const Row_circles::Slopes slopes = rows.slopes(s, t);
  return {size * sum, size * (by_along * slopes.along_by_s + by_across * slopes.across_by_s),
          size * (by_along * slopes.along_by_t + by_across * slopes.across_by_t)};
}

inline Point Vertex_fit::normal(double s, double t) const
{
  const Height at = height_and_slopes(s, t);
  Point sum = {};
  double square = 0;
  for (std::size_t i = 0; i < 3; ++i)
  {
    sum[i] = n[i] - at.by_s * s_axis[i] - at.by_t * t_axis[i];
    square += sum[i] * sum[i];
  }
  const double factor = 1 / std::sqrt(square);
  return {factor * sum[0], factor * sum[1], factor * sum[2]};
}

inline double Vertex_fit::way_along(const Point& x, const Point& direction) const
{
  // Newton's method. The surface is nearly across the direction, so that three steps give all digits.
  constexpr int most_steps = 5;
  const Point start = local_coordinates(x);
  const Point step = local_direction(direction);
  double way = 0;
  for (int i = 0; i < most_steps; ++i)
  {
    const Height at = height_and_slopes(start[0] + way * step[0], start[1] + way * step[1]);
    const double change = (at.value - start[2] - way * step[2]) / (step[2] - at.by_s * step[0] - at.by_t * step[1]);
    way += change;
    if (std::abs(change) <= 1e-15 * size)
      break;
  }
  return way;
}

inline std::array<double, 2> Vertex_fit::principal_curvatures() const
{
  if (degree < 1)
    return {0, 0};
  const auto square = [](const Point& a) { return a[0] * a[0] + a[1] * a[1] + a[2] * a[2]; };
  const double a = std::sqrt(square(s_axis)), b = std::sqrt(square(t_axis));
  const double p = size * coefficients[1] * a, q = size * coefficients[2] * b; // slopes
  const bool has_bend = degree >= 2;
  const double r =
    (has_bend ? 2 * size * coefficients[3] * a * a : 0) + size * coefficients[2] * rows.across_by_ss() * a * a;
  const double m =
    (has_bend ? size * coefficients[4] * a * b : 0) + size * coefficients[1] * rows.along_by_st() * a * b;
  const double t = has_bend ? 2 * size * coefficients[5] * b * b : 0;
  const double stretch = 1 + p * p + q * q;
  const double mean = -((1 + q * q) * r - 2 * p * q * m + (1 + p * p) * t) / (2 * stretch * std::sqrt(stretch));
  const double gauss = (r * t - m * m) / (stretch * stretch);
  const double spread = std::sqrt(std::max(0.0, mean * mean - gauss));
  return {mean + spread, mean - spread};
}

} // namespace recurve

#endif
