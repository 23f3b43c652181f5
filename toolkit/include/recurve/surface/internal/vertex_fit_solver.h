#ifndef RECURVE_SURFACE_INTERNAL_VERTEX_FIT_SOLVER_H
#define RECURVE_SURFACE_INTERNAL_VERTEX_FIT_SOLVER_H

#include <recurve/surface/internal/fit_points.h>
#include <recurve/surface/vertex_fit.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

namespace recurve::internal::surface {

/// The data of the fit of one vertex after another, and the policies' solver for them.
template <class Policies>
class Vertex_fit_solver
{
public:
  explicit Vertex_fit_solver(const Policies& policies) : policies_(&policies) {}

  Fit_points& points() { return points_; }

  /// sets coefficients, degree and state of `fit`. \return whether they are finite.
  bool solve(int degree, Vertex_fit& fit) const
  {
    clear_terms_above(degree, fit);
    policies_->solver(points_.view(true), degree, coefficients(fit, degree));
    return accept(degree, fit);
  }

  /// the same for a lower degree and the points that were solved for last.
  bool solve_lower(int degree, Vertex_fit& fit) const
  {
    if constexpr (requires(std::span<double> c) { policies_->solver.solve_lower(degree, c); })
    {
      clear_terms_above(degree, fit);
      policies_->solver.solve_lower(degree, coefficients(fit, degree));
      return accept(degree, fit);
    }
    else
      return solve(degree, fit);
  }

private:
  static std::span<double> coefficients(Vertex_fit& fit, int degree)
  {
    return {fit.coefficients.data(), static_cast<std::size_t>(coefficient_count(degree))};
  }

  /// the solver sets the others.
  static void clear_terms_above(int degree, Vertex_fit& fit)
  {
    if (fit.degree > degree)
      std::fill(fit.coefficients.begin() + coefficient_count(degree),
                fit.coefficients.begin() + coefficient_count(fit.degree), 0.0);
  }

  static bool accept(int degree, Vertex_fit& fit)
  {
    fit.degree = degree;
    const std::span<const double> found = coefficients(fit, degree);
    if (!std::all_of(found.begin(), found.end(), [](double c) { return std::isfinite(c); }))
      return false;
    while (fit.degree > 0 && has_no_terms(fit, fit.degree))
      --fit.degree;
    fit.state = fit.degree > 0 ? Vertex_fit_state::curved : Vertex_fit_state::flat;
    return true;
  }

  static bool has_no_terms(const Vertex_fit& fit, int degree)
  {
    return std::all_of(fit.coefficients.begin() + coefficient_count(degree - 1),
                       fit.coefficients.begin() + coefficient_count(degree), [](double c) { return c == 0; });
  }

  const Policies* policies_;
  Fit_points points_;
};

} // namespace recurve::internal::surface

#endif
