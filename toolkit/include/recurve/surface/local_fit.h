#ifndef RECURVE_SURFACE_LOCAL_FIT_H
#define RECURVE_SURFACE_LOCAL_FIT_H

#include <recurve/core/types.h>

#include <array>
#include <cmath>

namespace recurve {

/// Largest degree d of a fit.
inline constexpr int max_fit_degree = 6;

/// number of coefficients of a polynomial of degree `degree` in two variables: 1, 3, 6, 10, 15, 21, 28.
constexpr int coefficient_count(int degree)
{
  return (degree + 1) * (degree + 2) / 2;
}

/// where `Local_fit::coefficients` holds the coefficient of u^j v^k.
constexpr int coefficient_number(int j, int k)
{
  return (j + k) * (j + k + 1) / 2 + k;
}

/// Polynomial height function of one face over its tangent plane: the surface near the face is the set of points
/// origin + u * this->u + v * this->v + height(u, v) * n.
///
/// A value without heap memory, to be kept in flat arrays and property maps. A fit of degree 0 is *flat*: either the
/// surface around the face is planar to round-off, or no fit of a higher degree was good enough. A face with a flat fit
/// keeps its straight-sided shape; nothing is ever projected onto the plane of such a fit.
struct Local_fit
{
  Point origin = {};   ///< mean of the corners of the face, in the unit and coordinates of the mesh
  Point u = {1, 0, 0}; ///< unit tangent
  Point v = {0, 1, 0}; ///< unit tangent; u, v, n are a right-handed orthonormal frame
  Point n = {0, 0, 1}; ///< unit normal of the face (Newell), on the side of its counter-clockwise view
  double scale = 1;    ///< local unit of length (> 0): the largest distance of a corner from the origin
  int degree = 0;      ///< 0 to max_fit_degree
  std::array<double, 28> coefficients = {}; ///< of (u/scale)^j (v/scale)^k at coefficient_number(j, k), in units of
                                            ///< `scale`. The paper's c_jk is j! k! scale^(1-j-k) times this.

  /// whether the face keeps its straight-sided shape.
  bool is_flat() const { return degree == 0; }

  /// coordinates (u, v, w) of `x` in the frame; w is the distance above the tangent plane.
  Point local_coordinates(const Point& x) const
  {
    const Point r = {x[0] - origin[0], x[1] - origin[1], x[2] - origin[2]};
    return {r[0] * u[0] + r[1] * u[1] + r[2] * u[2], r[0] * v[0] + r[1] * v[1] + r[2] * v[2],
            r[0] * n[0] + r[1] * n[1] + r[2] * n[2]};
  }

  /// height of the surface above the tangent plane at (`u_coordinate`, `v_coordinate`); all lengths in the unit of the
  /// mesh.
  double height(double u_coordinate, double v_coordinate) const;

  /// point of the surface above (`u_coordinate`, `v_coordinate`).
  Point point(double u_coordinate, double v_coordinate) const;

  /// unit normal of the surface above (`u_coordinate`, `v_coordinate`).
  Point normal(double u_coordinate, double v_coordinate) const;

  /// way from `x` along n to the surface; {0, 0, 0} if the fit is flat.
  Point displacement(const Point& x) const;
};

inline double Local_fit::height(double u_coordinate, double v_coordinate) const
{
  const double s = u_coordinate / scale;
  const double t = v_coordinate / scale;
  double sum = 0;
  for (int j = degree; j >= 0; --j)
  {
    double row = 0;
    for (int k = degree - j; k >= 0; --k)
      row = row * t + coefficients[coefficient_number(j, k)];
    sum = sum * s + row;
  }
  return scale * sum;
}

inline Point Local_fit::point(double u_coordinate, double v_coordinate) const
{
  const double h = height(u_coordinate, v_coordinate);
  Point x = {};
  for (int i = 0; i < 3; ++i)
    x[i] = origin[i] + (u_coordinate * u[i] + v_coordinate * v[i] + h * n[i]);
  return x;
}

inline Point Local_fit::normal(double u_coordinate, double v_coordinate) const
{
  const double s = u_coordinate / scale;
  const double t = v_coordinate / scale;
  // Horner's scheme for the polynomial and its two derivatives at once; lengths cancel in the slopes.
  double sum = 0, by_s = 0, by_t = 0;
  for (int j = degree; j >= 0; --j)
  {
    double row = 0, row_by_t = 0;
    for (int k = degree - j; k >= 0; --k)
    {
      row_by_t = row_by_t * t + row;
      row = row * t + coefficients[coefficient_number(j, k)];
    }
    by_s = by_s * s + sum;
    sum = sum * s + row;
    by_t = by_t * s + row_by_t;
  }
  const double length = std::sqrt(1 + by_s * by_s + by_t * by_t);
  Point normal = {};
  for (int i = 0; i < 3; ++i)
    normal[i] = (n[i] - by_s * u[i] - by_t * v[i]) / length;
  return normal;
}

inline Point Local_fit::displacement(const Point& x) const
{
  if (is_flat())
    return {0, 0, 0};
  const Point local = local_coordinates(x);
  const double way = height(local[0], local[1]) - local[2];
  return {way * n[0], way * n[1], way * n[2]};
}

} // namespace recurve

#endif
