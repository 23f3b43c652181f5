#ifndef RECURVE_SURFACE_POLICIES_H
#define RECURVE_SURFACE_POLICIES_H

#include <recurve/core/types.h>
#include <recurve/surface/internal/conjugate_residual.h>
#include <recurve/surface/stencil_builder.h>
#include <recurve/surface/weighted_points.h>

#include <concepts>
#include <span>

namespace recurve {

/// Chooses the vertices of a face's fit: `stencil(builder, degree)` grows the stencil, which starts as the corners of
/// the face. Called by several threads at once.
template <class S>
concept Stencil = requires(const S& stencil, Stencil_builder& builder, int degree)
{
  stencil(builder, degree);
};

/// What a `Weighting` may look at, in a fit of a face or of a vertex.
struct Stencil_point
{
  double distance = 0; ///< from the origin of the fit, over the largest distance of a corner of the face from it; in a
                       ///< fit of a vertex over the mean distance of its neighbours, in each direction
  double cosine = 1;   ///< of the normal of the face or vertex and that of the point
  bool is_corner = false; ///< whether it is a corner of the face; false in fits of vertices
};

/// Weighs a vertex of a stencil: `weighting(point, degree)` returns a weight >= 0; at 0 the vertex takes no part. Only
/// the ratios of weights in one stencil matter. Called by several threads at once.
template <class W>
concept Weighting = requires(const W& weighting, const Stencil_point& point, int degree)
{
  {
    weighting(point, degree)
    } -> std::convertible_to<double>;
};

/// Solves the weighted least-squares problem: `solver(points, degree, coefficients)` sets the coefficient_count(degree)
/// coefficients of the polynomial of degree `degree` in the coordinates of `points`, numbered by coefficient_number().
/// A coefficient that is not finite makes the caller lower the degree. Called by several threads at once.
///
/// For `fit_vertices()` it has to leave out the constant term, whose coefficient is then 0, where
/// `points.is_through_origin`, and to meet `points.slopes` where there are some. It may have a member
/// `solve_lower(degree, coefficients)` for the polynomial of a lower degree to the points that the calling thread
/// solved last; without it they are solved again.
template <class L>
concept Least_squares_solver = requires(const L& solver, const Weighted_points& points, int degree,
                                        std::span<double> coefficients)
{
  solver(points, degree, coefficients);
};

/// Half-ring count of the paper: Algorithm 1, k = d + 1/2.
struct Paper_rings
{
  constexpr double operator()(int degree) const { return degree + 0.5; }
};

/// Half-ring count of WALF on good meshes: k = (d + 1) / 2.
struct Walf_compact_rings
{
  constexpr double operator()(int degree) const { return (degree + 1) / 2.0; }
};

/// Half-ring count of WALF on poor meshes: k = d / 2 + 1.
struct Walf_wide_rings
{
  constexpr double operator()(int degree) const { return degree / 2.0 + 1; }
};

/// Model of `Stencil`: k(d) rings around the corners of the face, the last one a half ring where k(d) is not whole.
/// \par Source  Ims & Wang 2018, Algorithms 1 and 2.
template <class Rings>
struct Ring_stencil
{
  Rings rings = {};

  void operator()(Stencil_builder& builder, int degree) const
  {
    const double k = rings(degree);
    const int whole_rings = static_cast<int>(k);
    for (int ring = 0; ring < whole_rings; ++ring)
      builder.add_ring();
    if (k > whole_rings)
      builder.add_half_ring();
  }
};

using Paper_stencil = Ring_stencil<Paper_rings>;

/// Model of `Weighting`: the cosine of the normals over the distance to the power of d + 1; half of that power more for
/// the corners of the face, against oscillation.
/// \par Source  Ims & Wang 2018, formula (3).
struct Paper_weighting
{
  double least_cosine = 1e-6; ///< epsilon of formula (3): points whose normal turns away by 90 degrees take no part

  double operator()(const Stencil_point& point, int degree) const
  {
    double power = point.distance;
    for (int i = 0; i < degree; ++i)
      power *= point.distance;
    const double numerator = (point.cosine > least_cosine ? point.cosine : 0) + (point.is_corner ? 0.5 : 0);
    return numerator / power;
  }
};

/// Model of `Least_squares_solver`: conjugate residual on the scaled normal equations (4), from zero, stopped early.
///
/// The early stop is the regularisation: where points do not determine the polynomial (a strip one face wide), what
/// they leave open stays zero, that is flat. \par Source  Ims & Wang 2018, sections 3.3.4 and 3.3.5.
struct Conjugate_residual
{
  double relative_bound = 1e-8; ///< of the residual of the scaled normal equations

  void operator()(const Weighted_points& points, int degree, std::span<double> coefficients) const
  {
    internal::surface::solve_by_conjugate_residual(points, degree, relative_bound, coefficients);
  }
};

/// The variable parts of `reconstruct_surface()` and `fit_vertices()`; an aggregate:
/// `Reconstruction_policies<Paper_stencil, My_weighting>{.weighting = {.width = 2}}`. The defaults are the paper's
/// choices.
template <Stencil S = Paper_stencil, Weighting W = Paper_weighting, Least_squares_solver L = Conjugate_residual>
struct Reconstruction_policies
{
  S stencil = {};
  W weighting = {};
  L solver = {};
};

using Paper_policies = Reconstruction_policies<>;

} // namespace recurve

#endif
