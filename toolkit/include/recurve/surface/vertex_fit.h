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
/// that s and t of these are about 1 however long and thin the faces are. The height is a polynomial of s and t; where
/// rows of long faces bend, all three coordinates are first turned back about the axis of their row.
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
  Row_circles rows = {};           ///< turn the coordinates back where rows of faces bend
  double size = 1;                 ///< unit of the heights and mean distance of the neighbours, a length > 0
  std::int32_t degree = 0;         ///< 0 to max_vertex_fit_degree
  Vertex_fit_state state = Vertex_fit_state::none;
  bool is_last_resort = false;                            ///< a parabola where higher degrees were asked for and failed
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

  /// coordinates along and across the rows, and the height over these, which the polynomial tells from the former.
  Point row_coordinates(const Point& x) const { return rows.place(local_coordinates(x)); }

  /// the polynomial.
  double height_in_rows(double along, double across) const;
  Height height_and_slopes_in_rows(double along, double across) const;

  /// over the plane; where bent rows are far from it any number, or none.
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

private:
  /// the number a for which start + a * step, in local coordinates, lies on the surface.
  double way_from(const Point& start, const Point& step) const;
};

inline double Vertex_fit::height_in_rows(double along, double across) const
{
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

inline Vertex_fit::Height Vertex_fit::height_and_slopes_in_rows(double along, double across) const
{
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
  return {size * sum, size * by_along, size * by_across};
}

inline double Vertex_fit::height(double s, double t) const
{
  return rows.are_straight() ? height_in_rows(s, t) : way_from({s, t, 0}, {0, 0, 1});
}

inline Vertex_fit::Height Vertex_fit::height_and_slopes(double s, double t) const
{
  if (rows.are_straight())
    return height_and_slopes_in_rows(s, t);
  const Point local = {s, t, height(s, t)};
  const Point at = rows.place(local);
  const Height surface = height_and_slopes_in_rows(at[0], at[1]);
  // what the point rises over the surface by, on a way
  const auto rise = [&](const Point& way) {
    const Point change = rows.change(local, way);
    return change[2] - surface.by_s * change[0] - surface.by_t * change[1];
  };
  const double by_height = rise({0, 0, 1});
  return {local[2], -rise({1, 0, 0}) / by_height, -rise({0, 1, 0}) / by_height};
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
  return way_from(local_coordinates(x), local_direction(direction));
}

inline double Vertex_fit::way_from(const Point& start, const Point& step) const
{
  // Newton's method. The surface is nearly across the direction, so that three steps give all digits; over bent rows,
  // far along them, it takes more.
  constexpr int most_steps = 10;
  double way = 0;
  for (int i = 0; i < most_steps; ++i)
  {
    const Point local = {start[0] + way * step[0], start[1] + way * step[1], start[2] + way * step[2]};
    const Point at = rows.place(local);
    const Height surface = height_and_slopes_in_rows(at[0], at[1]);
    const Point ahead = rows.change(local, step);
    const double change = (surface.value - at[2]) / (ahead[2] - surface.by_s * ahead[0] - surface.by_t * ahead[1]);
    way += change;
    if (std::abs(change) <= 1e-15 * std::max(size, std::abs(way)))
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
  // of the height over the plane, where the polynomial is one over the rows
  double r = rows.bend_off_plane * (1 + 2 * p * p) - rows.bend_in_plane * q;
  double m = p * (rows.bend_in_plane + rows.bend_off_plane * q);
  double t = 0;
  if (degree >= 2)
  {
    r += 2 * size * coefficients[3] * a * a;
    m += size * coefficients[4] * a * b;
    t += 2 * size * coefficients[5] * b * b;
  }
  const double stretch = 1 + p * p + q * q;
  const double mean = -((1 + q * q) * r - 2 * p * q * m + (1 + p * p) * t) / (2 * stretch * std::sqrt(stretch));
  const double gauss = (r * t - m * m) / (stretch * stretch);
  const double spread = std::sqrt(std::max(0.0, mean * mean - gauss));
  return {mean + spread, mean - spread};
}

} // namespace recurve

#endif
