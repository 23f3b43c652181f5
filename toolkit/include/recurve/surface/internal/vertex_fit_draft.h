#ifndef RECURVE_SURFACE_INTERNAL_VERTEX_FIT_DRAFT_H
#define RECURVE_SURFACE_INTERNAL_VERTEX_FIT_DRAFT_H

#include <recurve/surface/vertex_fit.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>

namespace recurve::internal::surface {

/// A fit in the making, with room of its own for the coefficients of any degree; used for one vertex after another.
class Vertex_fit_draft
{
public:
  Vertex_fit_draft() = default;
  Vertex_fit_draft(const Vertex_fit_draft&) = delete; ///< the fit is a view of the room
  Vertex_fit_draft& operator=(const Vertex_fit_draft&) = delete;

  const Vertex_fit& fit() const { return fit_; }

  /// makes it a fit without terms, in the frame of another.
  void set_flat(const Vertex_fit& frame, Vertex_fit_state state)
  {
    fit_ = frame;
    fit_.degree = 0;
    fit_.state = state;
    fit_.coefficients = {&Vertex_fit::no_height, 1};
  }

  /// the coefficients up to `degree`, all 0, for a solver to set.
  std::span<double> clear_coefficients(int degree)
  {
    const std::span<double> coefficients = room(degree);
    std::fill(coefficients.begin(), coefficients.end(), 0.0);
    return coefficients;
  }

  /// takes what a solver has set: sets degree and state of the fit, without terms of high degree that are all 0.
  /// \return whether the coefficients are finite.
  bool accept(int degree)
  {
    const std::span<const double> found = room(degree);
    const bool is_finite = std::all_of(found.begin(), found.end(), [](double c) { return std::isfinite(c); });
    while (is_finite && degree > 0 && has_no_terms(degree))
      --degree;
    fit_.degree = degree;
    fit_.coefficients = room(degree);
    if (is_finite)
      fit_.state = degree > 0 || !fit_.rows.are_straight() ? Vertex_fit_state::curved : Vertex_fit_state::flat;
    return is_finite;
  }

private:
  std::span<double> room(int degree) { return {room_.data(), static_cast<std::size_t>(coefficient_count(degree))}; }

  bool has_no_terms(int degree) const
  {
    return std::all_of(room_.begin() + coefficient_count(degree - 1), room_.begin() + coefficient_count(degree),
                       [](double c) { return c == 0; });
  }

  Vertex_fit fit_;
  std::array<double, static_cast<std::size_t>(coefficient_count(max_vertex_fit_degree))> room_ = {};
};

} // namespace recurve::internal::surface

#endif
