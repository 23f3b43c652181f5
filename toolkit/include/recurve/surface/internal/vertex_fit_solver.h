#ifndef RECURVE_SURFACE_INTERNAL_VERTEX_FIT_SOLVER_H
#define RECURVE_SURFACE_INTERNAL_VERTEX_FIT_SOLVER_H

#include <recurve/surface/internal/fit_points.h>
#include <recurve/surface/internal/vertex_fit_draft.h>
#include <recurve/surface/vertex_fit.h>

#include <span>

namespace recurve::internal::surface {

/// The data of the fit of one vertex after another, and the policies' solver for them.
template <class Policies>
class Vertex_fit_solver
{
public:
  explicit Vertex_fit_solver(const Policies& policies) : policies_(&policies) {}

  Fit_points& points() { return points_; }

  /// sets coefficients, degree and state of `draft`. \return whether they are finite.
  bool solve(int degree, Vertex_fit_draft& draft) const
  {
    policies_->solver(points_.view(true), degree, draft.clear_coefficients(degree));
    return draft.accept(degree);
  }

  /// the same for a lower degree and the points that were solved for last.
  bool solve_lower(int degree, Vertex_fit_draft& draft) const
  {
    if constexpr (requires(std::span<double> c) { policies_->solver.solve_lower(degree, c); })
    {
      policies_->solver.solve_lower(degree, draft.clear_coefficients(degree));
      return draft.accept(degree);
    }
    else
      return solve(degree, draft);
  }

private:
  const Policies* policies_;
  Fit_points points_;
};

} // namespace recurve::internal::surface

#endif
