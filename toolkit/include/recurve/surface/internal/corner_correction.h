#ifndef RECURVE_SURFACE_INTERNAL_CORNER_CORRECTION_H
#define RECURVE_SURFACE_INTERNAL_CORNER_CORRECTION_H

#include <recurve/surface/local_fit.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <span>

namespace recurve::internal::surface {

/// A corner of a face in the frame of its fit, in units of the fit: place in the plane and how far above the fit it is.
struct Corner_residual
{
  double u = 0, v = 0, residual = 0;
};

/// the numbers n_i with sum n_i = sum n_i u_i = sum n_i v_i = 0 of four corners: what no linear function of (u, v)
/// meets. Up to a factor; all zero for corners on a line.
inline std::array<double, 4> twist_of_quad(std::span<const Corner_residual> corners)
{
  const auto area = [&](std::size_t a, std::size_t b, std::size_t c) {
    return (corners[b].u - corners[a].u) * (corners[c].v - corners[a].v) -
           (corners[c].u - corners[a].u) * (corners[b].v - corners[a].v);
  };
  return {area(1, 2, 3), -area(0, 2, 3), area(0, 1, 3), -area(0, 1, 2)};
}

/// adds to `fit` what the residuals of four corners have that no linear function meets: a multiple of the harmonic
/// quadratic that tells the corners apart best, whichever way the frame is turned. Takes it off the residuals.
inline void correct_twist(std::span<Corner_residual> corners, Local_fit& fit)
{
  constexpr double least_twist = 1e-3; // of a square's; below it the corners are not those of a convex quad
  const std::array<double, 4> n = twist_of_quad(corners);
  double a = 0, b = 0, residual = 0, size = 0;
  for (std::size_t i = 0; i < 4; ++i)
  {
    const double u = corners[i].u, v = corners[i].v;
    a += n[i] * (u * u - v * v);
    b += n[i] * 2 * u * v;
    residual += n[i] * corners[i].residual;
    size += std::abs(n[i]) * (u * u + v * v);
  }
  if (!(std::hypot(a, b) > least_twist * size))
    return;
  const double factor = residual / (a * a + b * b);
  for (Corner_residual& corner : corners)
    corner.residual -= factor * (a * (corner.u * corner.u - corner.v * corner.v) + b * 2 * corner.u * corner.v);
  fit.coefficients[static_cast<std::size_t>(coefficient_number(2, 0))] += factor * a;
  fit.coefficients[static_cast<std::size_t>(coefficient_number(1, 1))] += 2 * factor * b;
  fit.coefficients[static_cast<std::size_t>(coefficient_number(0, 2))] -= factor * a;
}

/// makes `fit` go through the corners of its face: adds the linear function of their residuals, and for a quad of a fit
/// of degree 2 or more the quadratic that is left. The origin is the mean of the corners.
inline void pass_through_corners(std::span<Corner_residual> corners, Local_fit& fit)
{
  if (corners.size() == 4 && fit.degree >= 2)
    correct_twist(corners, fit);
  double uu = 0, uv = 0, vv = 0, ur = 0, vr = 0, mean = 0;
  for (const Corner_residual& corner : corners)
  {
    uu += corner.u * corner.u;
    uv += corner.u * corner.v;
    vv += corner.v * corner.v;
    ur += corner.u * corner.residual;
    vr += corner.v * corner.residual;
    mean += corner.residual / static_cast<double>(corners.size());
  }
  fit.coefficients[0] += mean;
  const double determinant = uu * vv - uv * uv;
  if (!(determinant > 0))
    return;
  fit.coefficients[1] += (vv * ur - uv * vr) / determinant;
  fit.coefficients[2] += (uu * vr - uv * ur) / determinant;
}

} // namespace recurve::internal::surface

#endif
