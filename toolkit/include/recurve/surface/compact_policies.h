#ifndef RECURVE_SURFACE_COMPACT_POLICIES_H
#define RECURVE_SURFACE_COMPACT_POLICIES_H

#include <recurve/surface/internal/least_squares.h>
#include <recurve/surface/policies.h>

#include <cmath>

namespace recurve {

/// Model of `Stencil`: rings and half rings until there are enough points, no more. Where the stencil touches a rim of
/// its surface region (a feature curve or a border) it sees one side only and takes more.
struct Compact_stencil
{
  double points_per_coefficient = 1.2; ///< measured: fewer are too few on some irregular triangles, more add error
  double points_per_coefficient_at_rim = 2;
  int most_rings = 12; ///< a strip one face wide never has enough

  void operator()(Stencil_builder& builder, int degree) const
  {
    const int coefficients = coefficient_count(degree);
    const auto has_enough = [&] {
      // A parabola is what is left where nothing else will do: from the nearest points alone.
      const double ratio = degree <= 2             ? 1
                           : builder.touches_rim() ? points_per_coefficient_at_rim
                                                   : points_per_coefficient;
      return static_cast<double>(builder.equations()) >= ratio * coefficients;
    };
    for (int ring = 0; ring < most_rings; ++ring)
    {
      const Index before = builder.size();
      builder.add_ring();
      if (has_enough() || builder.size() == before)
        return;
      builder.add_half_ring();
      if (has_enough())
        return;
      builder.drop_half_ring();
    }
  }
};

/// Model of `Weighting`: the cosine of the normals over the distance to a power. The steeper the weights, the nearer
/// the fit comes to interpolation of the nearest points, and the smaller the error of smooth surfaces; the less it
/// evens out noise.
struct Steep_weighting
{
  double power_per_degree = 2; ///< power = power_per_degree * degree + power_offset
  double power_offset = -2;
  double least_distance = 0.3; ///< in units of the distance; keeps the nearest of very uneven points from ruling alone

  double operator()(const Stencil_point& point, int degree) const
  {
    if (!(point.cosine > 0))
      return 0;
    const double square = point.distance * point.distance + least_distance * least_distance;
    const double half_power = 0.5 * (power_per_degree * degree + power_offset);
    const int whole = static_cast<int>(half_power);
    double power = whole == half_power ? 1 : std::pow(square, half_power - whole);
    for (int i = 0; i < whole; ++i)
      power *= square;
    return point.cosine / power;
  }
};

/// Model of `Weighting`: the cosine of the normals times exp(-(distance / width)^2). Evens out noise.
struct Gaussian_weighting
{
  double width = 2; ///< in units of the distance: sizes of the face, or mean distances of a vertex from its neighbours

  double operator()(const Stencil_point& point, int) const
  {
    const double ratio = point.distance / width;
    return point.cosine > 0 ? point.cosine * std::exp(-ratio * ratio) : 0;
  }
};

/// Model of `Least_squares_solver`: Householder's QR, column after column by ascending degree. A term that the points
/// cannot tell from the terms before it is left out (its coefficient is 0): in a strip one face wide those across the
/// strip, while those along it stay.
struct Graded_qr
{
  double least_independence = 1e-3; ///< sine of the angle between a column and those before it, below which the points
                                    ///< do not tell it from them; ten times less for each degree of the
                                    ///< polynomial above eight

  void operator()(const Weighted_points& points, int degree, std::span<double> coefficients) const
  {
    internal::surface::solve_by_graded_qr(points, degree, least_independence, coefficients);
  }

  /// the polynomial of a lower degree for the points that the calling thread solved last, with any `Graded_qr`, at next
  /// to no cost.
  void solve_lower(int degree, std::span<double> coefficients) const
  {
    internal::surface::solve_last_for_lower_degree(degree, coefficients);
  }
};

/// Model of `Least_squares_solver`: QR with column pivoting; the terms that the points determine least, of whatever
/// degree, are left out. \par Source  Businger & Golub 1965; used in MOAB's reconstruction.
struct Pivoted_qr
{
  double relative_bound = 1e-6; ///< smallest diagonal entry of R that counts, over the largest

  void operator()(const Weighted_points& points, int degree, std::span<double> coefficients) const
  {
    internal::surface::solve_by_pivoted_qr(points, degree, relative_bound, coefficients);
  }
};

/// Model of `Least_squares_solver`: the solution of least norm in scaled columns, without the directions whose singular
/// values are small. The slowest and the most forgiving.
struct Truncated_svd
{
  double relative_bound = 1e-6; ///< smallest singular value that counts, over the largest

  void operator()(const Weighted_points& points, int degree, std::span<double> coefficients) const
  {
    internal::surface::solve_by_truncated_svd(points, degree, relative_bound, coefficients);
  }
};

/// What the default preset takes.
using Compact_policies = Reconstruction_policies<Compact_stencil, Steep_weighting, Graded_qr>;

} // namespace recurve

#endif
