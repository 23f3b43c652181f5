#ifndef RECURVE_SURFACE_INTERNAL_VERTEX_FITTER_H
#define RECURVE_SURFACE_INTERNAL_VERTEX_FITTER_H

#include <recurve/surface/internal/edge_displacement.h>
#include <recurve/surface/internal/face_normal.h>
#include <recurve/surface/internal/surface_arrays.h>
#include <recurve/surface/internal/vector_3.h>
#include <recurve/surface/policies.h>
#include <recurve/surface/reconstruction_report.h>
#include <recurve/surface/stencil_builder.h>
#include <recurve/surface/vertex_fit.h>
#include <recurve/surface/weighted_points.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace recurve::internal::surface {

/// What became of one vertex.
struct Vertex_result
{
  Vertex_fit fit;
  Index stencil_size = 0;
  Lowering_reason reason = Lowering_reason::not_finite; ///< meaningful where the degree is not the one asked for
};

/// Spread of the neighbours of a vertex, the smaller over the larger, below which they count as a line.
inline constexpr double least_spread_ratio = 1e-8;

/// Difference of the displacements of a fit and of the normals' estimate, over the larger: beyond it the fit
/// oscillates. At a border the estimate is half of the truth.
inline constexpr double largest_departure = 0.75;

/// Where a fit departs from the normals' estimate it must agree so many times better with the fit of two degrees less.
inline constexpr double strictness_in_doubt = 3;

/// Differences in lengths of the edge that are no oscillation, but what fits have to say where a surface is nearly
/// flat; the second where the alternative is no fit at all.
inline constexpr double harmless_difference = 1e-3;
inline constexpr double harmless_parabola = 1e-2;

/// What the normals tell at a rim may be off by the whole bend, since a normal there is that of one side: as many times
/// what is negligible elsewhere.
inline constexpr double uncertainty_at_rim = 3;

/// Fits one vertex after another; holds the memory that every fit needs, so that fits allocate nothing.
template <class Policies>
class Vertex_fitter
{
public:
  Vertex_fitter(const Surface_arrays& surface, const Policies& policies, double largest_displacement,
                double largest_disagreement)
    : surface_(&surface), policies_(&policies), builder_(surface), largest_displacement_(largest_displacement),
      largest_disagreement_(largest_disagreement),
      has_twins_(surface.vertex_count() > 0 && surface.original_vertices.back() + 1 != surface.vertex_count())
  {}

  /// fits `vertex` with the highest degree up to `degree` that is any good, in even steps.
  Vertex_result fit(Index vertex, int degree)
  {
    Vertex_result result;
    result.reason = Lowering_reason::no_normal;
    result.fit.origin = surface_->points[vertex];
    if (surface_->is_tip[vertex] || surface_->normals[vertex] == Point{0, 0, 0} || !set_axes(vertex, result.fit))
      return result;
    const Estimated_bend bend = estimated_bend(*surface_, vertex);
    result.fit.state = Vertex_fit_state::flat;
    bool is_first = true;
    for (int d = degree; d > 0; d = (d - 1) / 2 * 2)
    {
      gather_points(vertex, result.fit, d);
      if (is_planar_)
        result.fit.state = Vertex_fit_state::planar;
      if (is_planar_)
        return result;
      result.stencil_size = builder_.size();
      const Verdict verdict =
        solve(d, result.fit) ? judge(vertex, d, result.fit, bend) : Verdict{Lowering_reason::not_finite, false};
      if (is_first && !(verdict.is_good && result.fit.degree == degree))
        result.reason = verdict.reason; // the reason of the first lowering stands
      is_first = false;
      if (verdict.is_good)
        return result;
    }
    result.fit.coefficients = {};
    result.fit.degree = 0;
    result.fit.state = Vertex_fit_state::flat;
    return result;
  }

private:
  /// sets the frame. \return whether the neighbours span a plane.
  bool set_axes(Index vertex, Vertex_fit& fit)
  {
    const Point& n = fit.n = surface_->normals[vertex];
    const Point across = std::abs(n[0]) < 0.6 ? Point{1, 0, 0} : Point{0, 1, 0};
    const Point u = normalized(subtract(across, scaled(dot(across, n), n)));
    const Point v = cross(n, u);
    double uu = 0, uv = 0, vv = 0;
    const std::span<const Index> corners = surface_->corners_of_vertex(vertex);
    for (const Index corner : corners)
      for (Index other = surface_->next_corner(corner); other != corner; other = surface_->next_corner(other))
      {
        const Point r = subtract(surface_->points[surface_->corner_vertices[other]], fit.origin);
        const double a = dot(r, u), b = dot(r, v);
        uu += a * a;
        uv += a * b;
        vv += b * b;
      }
    // Principal axes of the neighbours.
    const double angle = 0.5 * std::atan2(2 * uv, uu - vv);
    const double c = std::cos(angle), s = std::sin(angle);
    const double count = static_cast<double>(corners.size());
    const double large = std::sqrt((c * c * uu + 2 * c * s * uv + s * s * vv) / count);
    const double small = std::sqrt(std::max(0.0, s * s * uu - 2 * c * s * uv + c * c * vv) / count);
    if (!(small > least_spread_ratio * large))
      return false;
    fit.s_axis = scaled(1 / large, add(scaled(c, u), scaled(s, v)));
    fit.t_axis = scaled(1 / small, subtract(scaled(c, v), scaled(s, u)));
    fit.size = std::sqrt(large * small);
    slope_noise_ = 2 / small;
    return true;
  }

  /// sets the weighted points of the stencil and is_planar_.
  void gather_points(Index vertex, const Vertex_fit& frame, int degree)
  {
    builder_.start_at_vertex(vertex);
    policies_->stencil(builder_, degree);
    const std::span<Index> vertices = builder_.vertices();
    if (has_twins_)
      std::sort(vertices.begin(), vertices.end());
    s_.clear();
    t_.clear();
    height_.clear();
    weight_.clear();
    is_planar_ = true;
    for (std::size_t i = 0; i < vertices.size(); ++i)
      if (surface_->original_vertices[vertices[i]] != surface_->original_vertices[vertex] &&
          (!has_twins_ || is_best_twin(vertices, i, frame.n)))
        add_point(vertices[i], frame, degree);
  }

  /// Where a feature curve ends within a surface, a stencil may hold both sides of one vertex: the point counts once,
  /// with the normal that agrees better.
  bool is_best_twin(std::span<const Index> vertices, std::size_t i, const Point& normal) const
  {
    const auto original = [&](std::size_t j) { return surface_->original_vertices[vertices[j]]; };
    const auto cosine = [&](std::size_t j) { return dot(surface_->normals[vertices[j]], normal); };
    for (std::size_t j = i; j-- > 0 && original(j) == original(i);)
      if (cosine(j) >= cosine(i))
        return false;
    for (std::size_t j = i + 1; j < vertices.size() && original(j) == original(i); ++j)
      if (cosine(j) > cosine(i))
        return false;
    return true;
  }

  void add_point(Index vertex, const Vertex_fit& frame, int degree)
  {
    const Point& x = surface_->points[vertex];
    const Point way = subtract(x, frame.origin);
    const Point local = frame.local_direction(way);
    const double height = local[2] / frame.size;
    const double weight =
      policies_->weighting(Stencil_point{.distance = std::sqrt(local[0] * local[0] + local[1] * local[1]),
                                         .cosine = dot(surface_->normals[vertex], frame.n),
                                         .is_corner = false},
                           degree);
    if (!(weight > 0) || !std::isfinite(weight))
      return;
    s_.push_back(local[0]);
    t_.push_back(local[1]);
    height_.push_back(height);
    weight_.push_back(weight);
    // Heights that the resolution of the points and of the normal can explain are none.
    const double resolution = coordinate_resolution * std::max(largest_coordinate(x), largest_coordinate(frame.origin));
    if (std::abs(local[2]) > 2 * resolution * (1 + length(way) * slope_noise_))
      is_planar_ = false;
  }

  /// sets coefficients, degree and state of `fit`. \return whether they are finite.
  bool solve(int degree, Vertex_fit& fit) const
  {
    const std::span<double> coefficients(fit.coefficients.data(), static_cast<std::size_t>(coefficient_count(degree)));
    fit.coefficients = {};
    policies_->solver(Weighted_points{s_, t_, height_, weight_, true}, degree, coefficients);
    if (!std::all_of(coefficients.begin(), coefficients.end(), [](double c) { return std::isfinite(c); }))
      return false;
    fit.degree = degree;
    while (fit.degree > 0 && has_no_terms(fit, fit.degree))
      --fit.degree;
    fit.state = fit.degree > 0 ? Vertex_fit_state::curved : Vertex_fit_state::flat;
    return true;
  }

  struct Verdict
  {
    Lowering_reason reason = Lowering_reason::undetermined;
    bool is_good = true;
  };

  /// whether `fit` can be trusted on the edges at `vertex`. Where it departs from what the normals tell, it must agree
  /// with the fit of two degrees less: a series that converges does.
  Verdict judge(Index vertex, int degree, const Vertex_fit& fit, const Estimated_bend& bend) const
  {
    Vertex_fit lower;
    bool has_lower = false;
    for (const Index neighbor : surface_->neighbors_of(vertex))
    {
      const Point& end = surface_->points[neighbor];
      const double edge_length = length(subtract(end, fit.origin));
      const double own = middle_displacement(fit, end);
      if (!(std::abs(own) <= largest_displacement_ * edge_length))
        return {Lowering_reason::displacement, false};
      const double estimate = estimated_displacement(*surface_, vertex, neighbor);
      if (own * estimate < 0 && std::min(std::abs(own), std::abs(estimate)) > harmless_parabola * edge_length)
        return {Lowering_reason::disagreement, false}; // bent the other way than the normals at both ends say
      const double negligible = bend.negligible_displacement(edge_length);
      if (std::abs(own - estimate) <= negligible)
        continue;
      if (degree <= 2 && bend.is_short(edge_length))
        continue; // flat would be worse: it gives up the long edges for the short ones
      const auto departs = [&](double other, double bound, double least) {
        const double difference = std::abs(own - other);
        return difference > least && difference > bound * std::max(std::abs(own), std::abs(other));
      };
      const bool is_at_rim = surface_->is_rim[vertex] || surface_->is_rim[neighbor];
      const double unsure = is_at_rim ? uncertainty_at_rim * negligible : negligible;
      const bool is_doubtful = departs(estimate, largest_departure, unsure);
      if (degree <= 2)
      {
        if (is_doubtful && departs(estimate, largest_departure, harmless_parabola * edge_length))
          return {Lowering_reason::disagreement, false};
        continue;
      }
      if (!has_lower)
      {
        lower = fit;
        if (!solve(degree - 2, lower))
          return {Lowering_reason::not_finite, false};
        has_lower = true;
      }
      const double strictness = is_doubtful ? strictness_in_doubt : 1;
      if (departs(middle_displacement(lower, end), largest_disagreement_ / strictness,
                  std::max(negligible / strictness, harmless_difference * edge_length)))
        return {Lowering_reason::disagreement, false};
    }
    return {};
  }

  static bool has_no_terms(const Vertex_fit& fit, int degree)
  {
    return std::all_of(fit.coefficients.begin() + coefficient_count(degree - 1),
                       fit.coefficients.begin() + coefficient_count(degree), [](double c) { return c == 0; });
  }

  const Surface_arrays* surface_;
  const Policies* policies_;
  Stencil_builder builder_;
  double largest_displacement_;
  double largest_disagreement_;
  bool has_twins_; ///< some vertices are on several regions
  bool is_planar_ = false;
  double slope_noise_ = 0; ///< tilt of the normal by the resolution of the points, per unit of that resolution
  std::vector<double> s_, t_, height_, weight_;
};

} // namespace recurve::internal::surface

#endif
