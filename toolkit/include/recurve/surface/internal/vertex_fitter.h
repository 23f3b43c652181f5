#ifndef RECURVE_SURFACE_INTERNAL_VERTEX_FITTER_H
#define RECURVE_SURFACE_INTERNAL_VERTEX_FITTER_H

#include <recurve/surface/internal/concentrated_curvature.h>
#include <recurve/surface/internal/edge_displacement.h>
#include <recurve/surface/internal/face_normal.h>
#include <recurve/surface/internal/fit_points.h>
#include <recurve/surface/internal/surface_arrays.h>
#include <recurve/surface/internal/vector_3.h>
#include <recurve/surface/internal/vertex_fit_draft.h>
#include <recurve/surface/internal/vertex_fit_judge.h>
#include <recurve/surface/internal/vertex_fit_solver.h>
#include <recurve/surface/policies.h>
#include <recurve/surface/reconstruction_report.h>
#include <recurve/surface/stencil_builder.h>
#include <recurve/surface/vertex_fit.h>
#include <recurve/surface/weighted_points.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

namespace recurve::internal::surface {

/// Degrees more where a stencil touches a rim that is two or more edges away.
inline constexpr int degrees_more_near_rim = 2;

/// What became of one vertex.
struct Vertex_result
{
  Index stencil_size = 0;
  std::optional<Lowering_reason> reason; ///< of the first lowering below the degree that is wanted off rims
};

/// Spread of the neighbours of a vertex, the smaller over the larger, below which they count as a line.
inline constexpr double least_spread_ratio = 1e-8;

/// Cosine between the normal of a fit and one that is data, from which on it is of use: slopes below ten.
inline constexpr double least_upright = 0.1;

/// Fits one vertex after another; holds the memory that every fit needs, so that fits allocate nothing.
template <class Policies>
class Vertex_fitter
{
public:
  Vertex_fitter(const Surface_arrays& surface, const Policies& policies, const Vertex_fit_bounds& bounds)
    : surface_(&surface), policies_(&policies), solver_(policies),
      builder_(surface, bounds.data_normals.empty() ? 1 : 3), bounds_(bounds),
      has_twins_(surface.vertex_count() > 0 && surface.original_vertices.back() + 1 != surface.vertex_count()),
      data_normals_(bounds.data_normals)
  {}

  /// makes `draft()` the fit of `vertex` with the highest degree up to `degree` that is any good, in even steps. Beyond
  /// the bounds' degree only where the stencil touches a rim.
  Vertex_result fit(Index vertex, int degree)
  {
    Vertex_result result = {.reason = Lowering_reason::no_normal};
    Vertex_fit frame = {.origin = surface_->points[vertex]};
    draft_.set_flat(frame, Vertex_fit_state::none);
    if (surface_->is_tip[vertex] || has_concentrated_curvature(*surface_, vertex) ||
        surface_->normals[vertex] == Point{0, 0, 0})
      return result;
    const bool spans_plane = set_axes(vertex, frame);
    draft_.set_flat(frame, spans_plane ? Vertex_fit_state::planar : Vertex_fit_state::none);
    if (!spans_plane || is_in_planar_part(vertex, frame))
      return result;
    result.reason.reset();
    const Estimated_bend bend = estimated_bend(*surface_, vertex);
    const int first = gather_first(vertex, frame, degree);
    for (int d = first; d > 0; d = (d - 1) / 2 * 2)
    {
      if (d < first)
        gather_points(vertex, frame, d);
      if (is_planar_)
      {
        draft_.set_flat(frame, has_faces_in_plane(vertex, frame) ? Vertex_fit_state::planar : Vertex_fit_state::flat);
        return result;
      }
      result.stencil_size = builder_.size();
      Fit_verdict verdict = {Lowering_reason::not_finite, false};
      if (solver_.solve(d, draft_))
        verdict = Vertex_fit_judge(*surface_, bounds_, solver_, bend, vertex, judge_memory_).judge(d, draft_.fit());
      if (verdict.is_good)
        return result;
      if (d <= bounds_.degree && !result.reason)
        result.reason = verdict.reason;
    }
    draft_.set_flat(frame, Vertex_fit_state::flat);
    return result;
  }

  const Vertex_fit& draft() const { return draft_.fit(); }

  /// how far the draft alone, if it is curved, moves the middle of each edge at its vertex, when it is corrected
  /// linearly so as to go through the other end. In the order of the neighbours.
  std::span<const double> displacements() const { return judge_memory_.displacements; }

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

  /// whether `vertex` is in a planar part of the surface, even where a wider stencil would see the bend beside it: the
  /// faces around it are in one plane, and so are those around each corner of one of them. (Where a surface changes the
  /// side to which it bends, a row of vertices may have that too, but no face; and on a rim one face alone says
  /// nothing.)
  bool is_in_planar_part(Index vertex, const Vertex_fit& frame) const
  {
    if (!has_faces_in_plane(vertex, frame))
      return false;
    const auto corners = surface_->corners_of_vertex(vertex);
    return std::any_of(corners.begin(), corners.end(), [&](Index corner) {
      const auto of_face = surface_->corners_of_face(surface_->corner_faces[corner]);
      return std::any_of(of_face.begin(), of_face.end(), [&](Index v) { return !surface_->is_rim[v]; }) &&
             std::all_of(of_face.begin(), of_face.end(), [&](Index v) { return has_faces_in_plane(v, frame); });
    });
  }

  /// whether all faces around `vertex` lie in the plane of `frame`, to round-off.
  bool has_faces_in_plane(Index vertex, const Vertex_fit& frame) const
  {
    const std::span<const Index> corners = surface_->corners_of_vertex(vertex);
    return std::all_of(corners.begin(), corners.end(), [&](Index corner) {
      for (Index other = surface_->next_corner(corner); other != corner; other = surface_->next_corner(other))
        if (is_off_plane(surface_->points[surface_->corner_vertices[other]], frame))
          return false;
      return true;
    });
  }

  /// whether `x` has a height that the resolution of the points and of the normal cannot explain.
  bool is_off_plane(const Point& x, const Vertex_fit& frame) const
  {
    const Point way = subtract(x, frame.origin);
    const double resolution = coordinate_resolution * std::max(largest_coordinate(x), largest_coordinate(frame.origin));
    return std::abs(dot(way, frame.n)) > 2 * resolution * (1 + length(way) * slope_noise_);
  }

  /// gathers the points of the first fit. \return its degree.
  int gather_first(Index vertex, const Vertex_fit& frame, int degree)
  {
    const int inside = std::min(degree, bounds_.degree);
    gather_points(vertex, frame, inside);
    if (degree == inside || is_planar_ || !builder_.touches_rim())
      return inside;
    const int raised = is_next_to_rim(vertex) ? degree : std::min(degree, bounds_.degree + degrees_more_near_rim);
    gather_points(vertex, frame, raised);
    if (builder_.equations() >= coefficient_count(raised))
      return raised;
    gather_points(vertex, frame, inside); // a small region
    return inside;
  }

  /// whether `vertex` or a neighbour is on a rim.
  bool is_next_to_rim(Index vertex) const
  {
    const auto neighbors = surface_->neighbors_of(vertex);
    return surface_->is_rim[vertex] ||
           std::any_of(neighbors.begin(), neighbors.end(), [this](Index v) { return surface_->is_rim[v] != 0; });
  }

  /// sets the weighted points of the stencil and is_planar_.
  void gather_points(Index vertex, const Vertex_fit& frame, int degree)
  {
    builder_.start_at_vertex(vertex);
    policies_->stencil(builder_, degree);
    const std::span<Index> vertices = builder_.vertices();
    if (has_twins_)
      std::sort(vertices.begin(), vertices.end());
    solver_.points().start(vertices.size());
    is_planar_ = true;
    if (has_normals())
      add_slope(vertex, {0, 0, 0}, frame, weight_of(1, 1, degree)); // its own normal counts as much as a neighbour's
    for (std::size_t i = 0; i < vertices.size(); ++i)
      if (surface_->original_vertices[vertices[i]] != surface_->original_vertices[vertex] &&
          (!has_twins_ || is_best_side(*surface_, vertices, i, frame.n)))
        add_point(vertices[i], frame, degree);
  }

  void add_point(Index vertex, const Vertex_fit& frame, int degree)
  {
    const Point& x = surface_->points[vertex];
    const Point way = subtract(x, frame.origin);
    const Point local = frame.local_direction(way);
    const double height = local[2] / frame.size;
    const double weight =
      weight_of(std::sqrt(local[0] * local[0] + local[1] * local[1]), dot(surface_->normals[vertex], frame.n), degree);
    if (!(weight > 0) || !std::isfinite(weight))
      return;
    solver_.points().add(local[0], local[1], height, weight);
    if (has_normals())
      add_slope(vertex, local, frame, weight);
    is_planar_ = is_planar_ && !is_off_plane(x, frame);
  }

  double weight_of(double distance, double cosine, int degree) const
  {
    return policies_->weighting(Stencil_point{.distance = distance, .cosine = cosine, .is_corner = false}, degree);
  }

  bool has_normals() const { return !data_normals_.empty(); }

  /// adds the slopes that the normal of `vertex` asks for at `local`, if it has one and stands up.
  void add_slope(Index vertex, const Point& local, const Vertex_fit& frame, double weight)
  {
    const Point& normal = data_normals_[static_cast<std::size_t>(vertex)];
    const double up = dot(normal, frame.n);
    if (!(up > least_upright) || !(weight > 0) || !std::isfinite(weight))
      return;
    // The surface is size * h(s, t) high: n - size (h_s s_axis + h_t t_axis) is across it.
    const double by_s = -dot(normal, frame.s_axis) / (up * frame.size * dot(frame.s_axis, frame.s_axis));
    const double by_t = -dot(normal, frame.t_axis) / (up * frame.size * dot(frame.t_axis, frame.t_axis));
    solver_.points().add_slope(local[0], local[1], by_s, by_t, weight);
  }

  const Surface_arrays* surface_;
  const Policies* policies_;
  Vertex_fit_solver<Policies> solver_;
  Vertex_fit_draft draft_;
  Judge_memory judge_memory_;
  Stencil_builder builder_;
  Vertex_fit_bounds bounds_;
  bool has_twins_; ///< some vertices are on several regions
  bool is_planar_ = false;
  double slope_noise_ = 0; ///< tilt of the normal by the resolution of the points, per unit of that resolution
  std::span<const Point> data_normals_; ///< per vertex; zero: none. Empty: points alone are data
};

} // namespace recurve::internal::surface

#endif
