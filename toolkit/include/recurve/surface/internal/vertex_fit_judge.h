#ifndef RECURVE_SURFACE_INTERNAL_VERTEX_FIT_JUDGE_H
#define RECURVE_SURFACE_INTERNAL_VERTEX_FIT_JUDGE_H

#include <recurve/surface/internal/edge_displacement.h>
#include <recurve/surface/internal/surface_arrays.h>
#include <recurve/surface/internal/vector_3.h>
#include <recurve/surface/internal/vertex_fit_draft.h>
#include <recurve/surface/reconstruction_report.h>
#include <recurve/surface/vertex_fit.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

namespace recurve::internal::surface {

/// What the fits of vertices have to keep to; see `Vertex_fit_options`.
struct Vertex_fit_bounds
{
  int degree;                               ///< of the polynomials
  int degree_at_rim;                        ///< of those whose points are on one side of a rim; at least `degree`
  double largest_displacement;              ///< of a mid-edge, in edge lengths
  double largest_disagreement;              ///< see `Vertex_fit_options`
  std::span<const Point> data_normals = {}; ///< per vertex of the surface arrays, zero for none; empty: points alone
};

/// Degree from which on two degrees less must displace the edges nearly alike, or else the points do not resolve the
/// surface, and high degrees oscillate.
inline constexpr int high_degree = 6;

/// Largest change of the displacements by the last two degrees, as part of the bend.
inline constexpr double resolved_change = 0.05;

/// The same where the degree is a raised one, and for the change by the two degrees before.
inline constexpr double resolved_change_raised = 0.005;
inline constexpr double resolved_change_before = 0.02;

/// Raised degrees must not change more than the two before either: noise makes changes grow, to more than twice for
/// each two degrees. Changes below this part of the bend may be noise and do no harm.
inline constexpr double largest_growth = 1;
inline constexpr double harmless_change = 1e-4;

/// Difference of the displacements of a fit and of the normals' estimate, over the larger: beyond it the fit
/// oscillates. At a border the estimate is half of the truth.
inline constexpr double largest_departure = 0.75;

/// From this degree on a fit must not depart so far from the normals' estimate on an edge that it bends clearly: high
/// degrees that miss a bend by as much agree with each other and with nothing else. (A rim apart, where the estimate is
/// half of the truth.) Measured on tori of ten sides and graded bands of a sphere, and so that smooth surfaces of any
/// degree pass.
inline constexpr int very_high_degree = 8;
inline constexpr double largest_departure_of_very_high = 0.6;
inline constexpr double clear_bend = 3e-2; ///< in lengths of the edge

/// Where a fit departs from the normals' estimate it must agree so many times better with the fit of two degrees less.
inline constexpr double strictness_in_doubt = 3;

/// Difference in lengths of the edge that is no oscillation, but what fits have to say where a surface is nearly flat.
inline constexpr double harmless_difference = 1e-3;

/// Displacement in lengths of the edge from which on a fit must bend an edge to the side that the normals at both ends
/// tell.
inline constexpr double clear_displacement = 1e-2;

/// A parabola is given up for the flat face only where it is farther from the displacements that the normals tell than
/// no displacement is: by this factor of the sum of squares over the edges, relative to their lengths, since normals at
/// a rim tell half.
inline constexpr double largest_square_ratio = 1.25;

/// What the normals tell at a rim may be off by the whole bend, since a normal there is that of one side: as many times
/// what is negligible elsewhere.
inline constexpr double uncertainty_at_rim = 3;

struct Fit_verdict
{
  Lowering_reason reason = Lowering_reason::undetermined;
  bool is_good = true;
};

/// Memory of a judge.
struct Judge_memory
{
  Vertex_fit_draft lower, lowest;    ///< fits of lower degrees that a fit is compared with
  std::vector<double> displacements; ///< of the middles of the edges by the fit, one per neighbour if it is good
};

/// Judges the fits of one vertex by what they do to the middles of its edges, right after they were solved for.
template <class Solver>
class Vertex_fit_judge
{
public:
  Vertex_fit_judge(const Surface_arrays& surface, const Vertex_fit_bounds& bounds, const Solver& solver,
                   const Estimated_bend& bend, Index vertex, Judge_memory& memory)
    : surface_(surface), bounds_(bounds), solver_(solver), bend_(bend), memory_(memory), vertex_(vertex),
      neighbors_(surface.neighbors_of(vertex))
  {}

  /// whether `fit` can be trusted on the edges at the vertex. Where it departs from what the normals tell, it must
  /// agree with the fit of two degrees less: a series that converges does.
  Fit_verdict judge(int degree, const Vertex_fit& fit) const
  {
    memory_.displacements.clear();
    if (degree <= 2)
      return judge_parabola(fit);
    if ((degree >= high_degree || degree > bounds_.degree) && !is_resolved(degree, fit))
      return {Lowering_reason::disagreement, false};
    Vertex_fit_draft& lower = memory_.lower;
    bool has_lower = false;
    for (const Index neighbor : neighbors_)
    {
      const Point& end = surface_.points[neighbor];
      const double edge_length = length(subtract(end, fit.origin));
      const double own = middle_displacement(fit, end);
      memory_.displacements.push_back(own);
      if (!(std::abs(own) <= bounds_.largest_displacement * edge_length))
        return {Lowering_reason::displacement, false};
      const double estimate = bend_.displacement(surface_, fit, vertex_, neighbor);
      if (own * estimate < 0 && std::min(std::abs(own), std::abs(estimate)) > clear_displacement * edge_length)
        return {Lowering_reason::disagreement, false};
      const double negligible = bend_.negligible_displacement(edge_length);
      if (std::abs(own - estimate) <= negligible)
        continue;
      const bool is_at_rim = surface_.is_rim[vertex_] || surface_.is_rim[neighbor];
      if (!is_at_rim && misses_bend(degree, own, estimate, edge_length))
        return {Lowering_reason::disagreement, false};
      const double unsure = is_at_rim ? uncertainty_at_rim * negligible : negligible;
      const double strictness = departs(own, estimate, largest_departure, unsure) ? strictness_in_doubt : 1;
      if (!has_lower && !solve_next_lower(degree, fit, lower))
        return {Lowering_reason::not_finite, false};
      has_lower = true;
      if (departs(own, middle_displacement(lower.fit(), end), bounds_.largest_disagreement / strictness,
                  std::max(negligible / strictness, harmless_difference * edge_length)))
        return {Lowering_reason::disagreement, false};
    }
    return {};
  }

private:
  /// whether two displacements differ by more than `least` and by more than a part of the larger, or are no numbers.
  static bool departs(double own, double other, double part, double least)
  {
    const double difference = std::abs(own - other);
    return !(difference <= least) && !(difference <= part * std::max(std::abs(own), std::abs(other)));
  }

  /// whether a fit of very high degree bends an edge clearly and quite unlike what the normals tell.
  bool misses_bend(int degree, double own, double estimate, double edge_length) const
  {
    return degree >= very_high_degree && degree <= bounds_.degree && std::abs(own) > clear_bend * edge_length &&
           departs(own, estimate, largest_departure_of_very_high, 0);
  }

  /// whether a fit of degree 2 or less, after which there is none, is better than no displacement at all.
  Fit_verdict judge_parabola(const Vertex_fit& fit) const
  {
    double departure = 0, flat_departure = 0;
    for (const Index neighbor : neighbors_)
    {
      const Point& end = surface_.points[neighbor];
      const double edge_length = length(subtract(end, fit.origin));
      memory_.displacements.push_back(middle_displacement(fit, end));
      if (!(edge_length > 0))
        continue;
      const double own = memory_.displacements.back() / edge_length;
      if (!(std::abs(own) <= bounds_.largest_displacement))
        return {Lowering_reason::displacement, false};
      const double estimate = bend_.displacement(surface_, fit, vertex_, neighbor) / edge_length;
      departure += (own - estimate) * (own - estimate);
      flat_departure += estimate * estimate;
    }
    if (departure > largest_square_ratio * flat_departure)
      return {Lowering_reason::disagreement, false};
    return {};
  }

  static constexpr double no_number = std::numeric_limits<double>::infinity(); ///< no fit is near to that

  /// The largest change of the displacements from one fit to another, and the largest displacement by the first.
  struct Change
  {
    double largest = 0;
    double bend = 0;
  };

  Change change(const Vertex_fit& from, const Vertex_fit& to) const
  {
    Change result;
    for (const Index neighbor : neighbors_)
    {
      const Point& end = surface_.points[neighbor];
      const double before = middle_displacement(from, end);
      result.bend = std::max(result.bend, std::abs(before));
      const double change = std::abs(middle_displacement(to, end) - before);
      result.largest = std::isfinite(change) ? std::max(result.largest, change) : no_number;
    }
    return result;
  }

  /// whether the fits of two and, for a raised degree, of four degrees less, to the same points, come near enough to
  /// `fit`.
  bool is_resolved(int degree, const Vertex_fit& fit) const
  {
    Vertex_fit_draft& lower = memory_.lower;
    if (degree <= bounds_.degree)
    {
      if (!solve_next_lower(degree, fit, lower))
        return false;
      const Change last = change(lower.fit(), fit);
      return last.largest <= resolved_change * last.bend;
    }
    Vertex_fit_draft& lowest = memory_.lowest;
    lower.set_flat(fit, Vertex_fit_state::flat);
    lowest.set_flat(fit, Vertex_fit_state::flat);
    if (degree < 5 || !solver_.solve_lower(degree - 2, lower) || !solver_.solve_lower(degree - 4, lowest) ||
        (has_missing_terms(fit, degree) && agree(fit, lower.fit())))
      return false;
    const Change last = change(lower.fit(), fit);
    const double before = change(lowest.fit(), lower.fit()).largest;
    const bool is_growing = last.largest > largest_growth * before && last.largest > harmless_change * last.bend;
    return !is_growing && last.largest <= resolved_change_raised * last.bend &&
           before <= resolved_change_before * last.bend;
  }

  /// sets `lower` to the fit of two degrees less, for comparison with `fit`. Where the points do not determine all
  /// terms of `fit`, those of so many degrees may be missing that both are the same and their agreement means nothing:
  /// then to the first lower one that differs.
  bool solve_next_lower(int degree, const Vertex_fit& fit, Vertex_fit_draft& lower) const
  {
    const bool lacks_terms = has_missing_terms(fit, degree);
    lower.set_flat(fit, Vertex_fit_state::flat);
    for (int d = degree - 2; d > 0; d -= 2)
    {
      if (!solver_.solve_lower(d, lower))
        return false;
      if (!lacks_terms || !agree(fit, lower.fit()))
        break;
    }
    return true;
  }

  /// whether two fits displace all edges alike, to round-off.
  bool agree(const Vertex_fit& a, const Vertex_fit& b) const
  {
    constexpr double round_off = 1e-9; // of edges: far above that of the solver, far below any shape
    return std::all_of(neighbors_.begin(), neighbors_.end(), [&](Index neighbor) {
      const Point& end = surface_.points[neighbor];
      const double of_a = middle_displacement(a, end), of_b = middle_displacement(b, end);
      return std::abs(of_a - of_b) <= round_off * std::max(std::abs(of_a), length(subtract(end, a.origin)));
    });
  }

  /// whether the solver left out terms that the points do not determine.
  static bool has_missing_terms(const Vertex_fit& fit, int degree)
  {
    return fit.degree < degree ||
           std::find(fit.coefficients.begin() + 1, fit.coefficients.end(), 0.0) != fit.coefficients.end();
  }

  const Surface_arrays& surface_;
  const Vertex_fit_bounds& bounds_;
  const Solver& solver_;
  const Estimated_bend& bend_;
  Judge_memory& memory_;
  Index vertex_;
  std::span<const Index> neighbors_;
};

} // namespace recurve::internal::surface

#endif
