#ifndef RECURVE_SURFACE_INTERNAL_VERTEX_FITTER_H
#define RECURVE_SURFACE_INTERNAL_VERTEX_FITTER_H

#include <recurve/surface/internal/concentrated_curvature.h>
#include <recurve/surface/internal/edge_displacement.h>
#include <recurve/surface/internal/face_normal.h>
#include <recurve/surface/internal/find_row_circles.h>
#include <recurve/surface/internal/fit_points.h>
#include <recurve/surface/internal/one_sided_distance.h>
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
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <utility>
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

/// Cosine between the normal of the vertex and the mean of the points', below which a plane across the latter is
/// better.
inline constexpr double greatest_cosine_of_tilt = 0.99;

/// Spread of the neighbours along a row over that across it, from which on the row is looked at: a ring of six faces,
/// as it lies in the plane, has 1.7.
inline constexpr double least_ratio_of_rows = 1.6;

/// The same when the row is straightened, from which on faces are long: the few neighbours of a vertex may be in a
/// circle by accident, and 2 made errors on irregular meshes nearly three times as large.
inline constexpr double least_ratio_in_rows = 4;

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
      has_twins_(std::adjacent_find(surface.original_vertices.begin(), surface.original_vertices.end()) !=
                 surface.original_vertices.end()),
      data_normals_(bounds.data_normals)
  {}

  /// makes `draft()` the fit of `vertex` with the highest degree up to `degree` that is any good, in even steps. Beyond
  /// the bounds' degree only where the stencil touches a rim.
  Vertex_result fit(Index vertex, int degree)
  {
    Vertex_result result = {.reason = Lowering_reason::no_normal};
    Vertex_fit frame = {.origin = surface_->points[vertex], .vertex_normal = surface_->normals[vertex]};
    draft_.set_flat(frame, Vertex_fit_state::none);
    if (surface_->is_tip[vertex] || has_concentrated_curvature(*surface_, vertex) ||
        frame.vertex_normal == Point{0, 0, 0})
      return result;
    const bool spans_plane = set_axes(vertex, frame.vertex_normal, frame);
    set_straight(frame, spans_plane ? Vertex_fit_state::planar : Vertex_fit_state::none);
    if (!spans_plane || is_in_planar_part(vertex, frame))
      return result;
    result.reason.reset();
    Estimated_bend bend = estimated_bend(*surface_, vertex, frame);
    const int first = gather_first(vertex, frame, degree);
    for (int d = first; d > 0; d = (d - 1) / 2 * 2)
    {
      if (d < first)
        gather_points(vertex, frame, d);
      if (!frame.rows.are_straight())
        bend = estimated_bend(*surface_, vertex, frame); // the points may have another plane
      if (is_planar_)
      {
        set_straight(frame, has_faces_in_plane(vertex, frame) ? Vertex_fit_state::planar : Vertex_fit_state::flat);
        return result;
      }
      result.stencil_size = builder_.size();
      frame.is_last_resort = d <= 2 && bounds_.degree > 2;
      draft_.set_flat(frame, Vertex_fit_state::flat);
      Fit_verdict verdict = {Lowering_reason::not_finite, false};
      if (solver_.solve(d, draft_))
        verdict = Vertex_fit_judge(*surface_, bounds_, solver_, bend, vertex, judge_memory_).judge(d, draft_.fit());
      if (verdict.is_good)
        return result;
      if (d <= bounds_.degree && !result.reason)
        result.reason = verdict.reason;
    }
    set_straight(frame, Vertex_fit_state::flat);
    return result;
  }

  const Vertex_fit& draft() const { return draft_.fit(); }

  /// how far the draft alone, if it is curved, moves the middle of each edge at its vertex, when it is corrected
  /// linearly so as to go through the other end. In the order of the neighbours.
  std::span<const double> displacements() const { return judge_memory_.displacements; }

private:
  /// makes `draft()` the plane of a frame, without its rows.
  void set_straight(Vertex_fit frame, Vertex_fit_state state)
  {
    frame.rows = {};
    draft_.set_flat(frame, state);
  }

  /// sets the frame over the plane across `n`. \return whether the neighbours span a plane.
  bool set_axes(Index vertex, const Point& n, Vertex_fit& fit)
  {
    fit.n = n;
    const Point across = std::abs(n[0]) < 0.6 ? Point{1, 0, 0} : Point{0, 1, 0};
    const Point u = normalized(subtract(across, scaled(dot(across, n), n)));
    const Point v = cross(n, u);
    double uu = 0, uv = 0, vv = 0;
    for_neighbors(vertex, [&](const Point& x) {
      const Point r = subtract(x, fit.origin);
      const double a = dot(r, u), b = dot(r, v);
      uu += a * a;
      uv += a * b;
      vv += b * b;
    });
    // Principal axes of the neighbours.
    const auto [c, s] = principal_direction(uu, uv, vv);
    const double count = static_cast<double>(surface_->corners_of_vertex(vertex).size());
    const double large = std::sqrt((c * c * uu + 2 * c * s * uv + s * s * vv) / count);
    double small = std::sqrt(std::max(0.0, s * s * uu - 2 * c * s * uv + c * c * vv) / count);
    if (!(small > least_spread_ratio * large))
      return false;
    fit.s_axis = scaled(1 / large, add(scaled(c, u), scaled(s, v)));
    fit.t_axis = scaled(1 / small, subtract(scaled(c, v), scaled(s, u)));
    fit.rows = {};
    if (large > least_ratio_of_rows * small)
      small *= set_rows(vertex, large, small, fit);
    fit.size = std::sqrt(large * small);
    slope_noise_ = 2 / small;
    return true;
  }

  /// \return cosine and sine of the direction in which a symmetric matrix is largest.
  static std::array<double, 2> principal_direction(double uu, double uv, double vv)
  {
    const double radius = std::sqrt((uu - vv) * (uu - vv) + 4 * uv * uv);
    if (!(radius > 0))
      return {1, 0};
    const double large = std::sqrt(0.5 * (1 + std::abs(uu - vv) / radius)); // of cosine and sine
    const double small = std::abs(uv) / (radius * large);
    return {uu >= vv ? large : small, std::copysign(uu >= vv ? small : large, uv)};
  }

  /// has `fit` measure along and across the rows of faces, if these are long and their rows bend. \return the new unit
  /// of t, over the old.
  double set_rows(Index vertex, double s_unit, double t_unit, Vertex_fit& fit)
  {
    Row_finder finder;
    for_neighbors(vertex, [&](const Point& x) {
      const Point local = fit.local_coordinates(x);
      finder.add({s_unit * local[0], t_unit * local[1], local[2]});
    });
    Row_circles rows = finder.circles();
    if (rows.are_straight())
      return 1;
    rows.s_unit = s_unit;
    rows.t_unit = t_unit;
    bool is_near = true;
    double old_square = 0, square = 0;
    for_neighbors(vertex, [&](const Point& x) {
      const Point local = fit.local_coordinates(x);
      is_near = is_near && rows.is_on_near_side(local);
      const double across = rows.place(local)[1];
      square += across * across;
      old_square += local[1] * local[1];
    });
    const double factor = std::sqrt(square / old_square);
    if (!is_near || !(factor > least_spread_ratio) || !(factor < 1) ||
        !(s_unit > least_ratio_in_rows * factor * t_unit))
      return 1;
    rows.t_unit *= factor;
    fit.rows = rows;
    fit.t_axis = scaled(1 / factor, fit.t_axis);
    return factor;
  }

  /// calls `work` with the points of the other corners of each face at `vertex`.
  template <class Work>
  void for_neighbors(Index vertex, const Work& work) const
  {
    for (const Index corner : surface_->corners_of_vertex(vertex))
      for (Index other = surface_->next_corner(corner); other != corner; other = surface_->next_corner(other))
        work(surface_->points[surface_->corner_vertices[other]]);
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
  int gather_first(Index vertex, Vertex_fit& frame, int degree)
  {
    const int inside = std::min(degree, bounds_.degree);
    gather_points(vertex, frame, inside);
    if (degree == inside || is_planar_ || !builder_.touches_rim())
      return inside;
    const int raised = is_next_to_rim(vertex) ? degree : std::min(degree, bounds_.degree + degrees_more_near_rim);
    gather_points(vertex, frame, raised);
    // A strip has too few rows for more; and where rows are few and the same for all columns, solvers leave out the
    // terms that they do not determine only if these are in no way blurred.
    if (builder_.equations() >= coefficient_count(raised) && !is_strip_)
      return raised;
    gather_points(vertex, frame, inside);
    return inside;
  }

  /// whether `vertex` or a neighbour is on a rim.
  bool is_next_to_rim(Index vertex) const
  {
    const auto neighbors = surface_->neighbors_of(vertex);
    return surface_->is_rim[vertex] ||
           std::any_of(neighbors.begin(), neighbors.end(), [this](Index v) { return surface_->is_rim[v] != 0; });
  }

  /// sets the frame, the weighted points of the stencil and is_planar_.
  void gather_points(Index vertex, Vertex_fit& frame, int degree)
  {
    if (frame.n != frame.vertex_normal)
      set_axes(vertex, frame.vertex_normal, frame);
    builder_.start_at_vertex(vertex);
    policies_->stencil(builder_, degree);
    distance_ = {};
    is_strip_ = false;
    if (degree > bounds_.degree)
      reach_inwards(vertex, frame);
    const std::span<Index> vertices = builder_.vertices();
    if (has_twins_)
      std::sort(vertices.begin(), vertices.end());
    solver_.points().start(vertices.size());
    is_planar_ = true;
    if (has_normals()) // its own counts as much as a neighbour's
      add_slope(vertex, {0, 0, 0}, {0, 0, 0}, frame, weight_of(1, 1, degree));
    for (std::size_t i = 0; i < vertices.size(); ++i)
      if (surface_->original_vertices[vertices[i]] != surface_->original_vertices[vertex] &&
          (!has_twins_ || is_best_side(*surface_, vertices, i, frame.n)))
        add_point(vertices[i], frame, degree);
  }

  /// for a fit whose points lie on one side: takes points farther from the rim in exchange for those farthest along
  /// it, and puts the plane across the mean of their normals, since over that of the vertex, at their edge, they may be
  /// steep. Not beside a corner of the rim, where points lie on two sides. Sets is_strip_.
  void reach_inwards(Index vertex, Vertex_fit& frame)
  {
    const Index count = builder_.size();
    const One_sided_distance distance = one_sided_distance(*surface_, builder_.vertices(), frame);
    is_strip_ = has_rim_ahead(distance, frame);
    if (distance.is_round() || is_strip_ || has_corner_of_rim())
      return;
    for (Index before = 0; before < builder_.size() && builder_.size() < 2 * count;)
    {
      before = builder_.size();
      builder_.add_ring();
    }
    const std::span<Index> vertices = builder_.vertices();
    order_.clear();
    for (const Index v : vertices)
      order_.emplace_back(distance(frame.row_coordinates(surface_->points[v])), v);
    std::sort(order_.begin(), order_.end());
    std::transform(order_.begin(), order_.end(), vertices.begin(), [](const auto& at) { return at.second; });
    builder_.keep_first(end_of_ties(count));
    is_strip_ = has_rim_ahead(distance, frame);
    Point normal = {0, 0, 0};
    for (const Index v : builder_.vertices())
      normal = add(normal, surface_->normals[v]);
    normal = normalized(normal);
    if (dot(normal, frame.vertex_normal) < greatest_cosine_of_tilt && !set_axes(vertex, normal, frame))
      set_axes(vertex, frame.vertex_normal, frame);
    distance_ = one_sided_distance(*surface_, builder_.vertices(), frame);
  }

  /// the place in order_ from `count` on before which there is a clear step, so that round-off does not choose between
  /// points that are equally far.
  Index end_of_ties(Index count) const
  {
    constexpr double tie = 1e-6; // relative: far above round-off, far below what makes a difference
    const auto last = static_cast<std::size_t>(count) - 1;
    const double bound = order_[last].first * (1 + tie);
    const auto end =
      std::find_if(order_.begin() + count, order_.end(), [=](const auto& at) { return at.first > bound; });
    return static_cast<Index>(end - order_.begin());
  }

  bool has_corner_of_rim()
  {
    const std::span<const Index> vertices = builder_.vertices();
    return std::any_of(vertices.begin(), vertices.end(),
                       [this](Index v) { return surface_->is_rim[v] && is_corner_of_rim(*surface_, v); });
  }

  /// whether the stencil, which begins at a rim, ends at another one that runs across the way ahead.
  bool has_rim_ahead(const One_sided_distance& distance, const Vertex_fit& frame)
  {
    constexpr double least_slope = 2; // depth over width of what is straight ahead
    if (distance.is_round())
      return false;
    const std::span<const Index> vertices = builder_.vertices();
    double mean_depth = 0;
    for (const Index v : vertices)
      mean_depth += distance.depth(frame.row_coordinates(surface_->points[v])) / static_cast<double>(vertices.size());
    bool is_left = false, is_right = false;
    for (const Index v : vertices)
    {
      const Point local = frame.row_coordinates(surface_->points[v]);
      const double depth = distance.depth(local), width = distance.width(local);
      const bool is_ahead = surface_->is_rim[v] && depth > mean_depth && depth > least_slope * std::abs(width);
      is_left = is_left || (is_ahead && width > 0);
      is_right = is_right || (is_ahead && width < 0);
    }
    return is_left && is_right;
  }

  void add_point(Index vertex, const Vertex_fit& frame, int degree)
  {
    const Point& x = surface_->points[vertex];
    const Point straight = frame.local_coordinates(x);
    const Point local = frame.rows.place(straight);
    const double height = local[2] / frame.size;
    const double weight = weight_of(distance_(local), dot(surface_->normals[vertex], frame.n), degree);
    if (!(weight > 0) || !std::isfinite(weight))
      return;
    solver_.points().add(local[0], local[1], height, weight);
    if (has_normals())
      add_slope(vertex, straight, local, frame, weight);
    is_planar_ = is_planar_ && !is_off_plane(x, frame);
  }

  double weight_of(double distance, double cosine, int degree) const
  {
    return policies_->weighting(Stencil_point{.distance = distance, .cosine = cosine, .is_corner = false}, degree);
  }

  bool has_normals() const { return !data_normals_.empty(); }

  /// adds the slopes that the normal of `vertex` asks for, if it has one and stands up. \param local  coordinates of
  /// the vertex. \param place  the same along and across the rows.
  void add_slope(Index vertex, const Point& local, const Point& place, const Vertex_fit& frame, double weight)
  {
    const Point& normal = data_normals_[static_cast<std::size_t>(vertex)];
    const Row_circles::Turn turn = frame.rows.turn(local);
    const Point turned = frame.rows.turned_back(turn, frame.local_direction(normal));
    const double up = turned[2];
    if (!(up > least_upright) || !(weight > 0) || !std::isfinite(weight))
      return;
    // The surface is size * h(s, t) high: n - size (h_s s_axis + h_t t_axis) is across it.
    const double by_along = -turned[0] * turn.distance / (up * frame.size * dot(frame.s_axis, frame.s_axis));
    const double by_across = -turned[1] / (up * frame.size * dot(frame.t_axis, frame.t_axis));
    solver_.points().add_slope(place[0], place[1], by_along, by_across, weight);
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
  bool is_strip_ = false;                       ///< the stencil that was gathered last goes from rim to rim
  One_sided_distance distance_;                 ///< of the points that were gathered last
  std::vector<std::pair<double, Index>> order_; ///< scratch: distance, vertex
  double slope_noise_ = 0; ///< tilt of the normal by the resolution of the points, per unit of that resolution
  std::span<const Point> data_normals_; ///< per vertex; zero: none. Empty: points alone are data
};

} // namespace recurve::internal::surface

#endif
