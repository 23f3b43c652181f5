#ifndef RECURVE_SURFACE_INTERNAL_FACE_FITTER_H
#define RECURVE_SURFACE_INTERNAL_FACE_FITTER_H

#include <recurve/surface/internal/corner_correction.h>
#include <recurve/surface/internal/face_normal.h>
#include <recurve/surface/internal/fit_points.h>
#include <recurve/surface/internal/surface_arrays.h>
#include <recurve/surface/internal/vector_3.h>
#include <recurve/surface/local_fit.h>
#include <recurve/surface/policies.h>
#include <recurve/surface/reconstruction_report.h>
#include <recurve/surface/stencil_builder.h>
#include <recurve/surface/weighted_points.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace recurve::internal::surface {

/// Tangent plane of a face and what is known of its precision.
struct Face_frame
{
  Local_fit flat_fit;     ///< frame and scale, no height
  double slope_noise = 0; ///< tilt of the normal by the resolution of the corners, per unit of that resolution
};

inline Point mean_of_corners(std::span<const Index> corners, const std::vector<Point>& points)
{
  const Point& first = points[corners[0]];
  Point sum = {0, 0, 0};
  for (const Index corner : corners)
    sum = add(sum, subtract(points[corner], first));
  return add(first, scaled(1.0 / static_cast<double>(corners.size()), sum));
}

/// the frame: n is the face's normal; u follows the face's longest edge, so that the frame turns with the mesh.
inline Face_frame face_frame(std::span<const Index> corners, const std::vector<Point>& points, const Point& normal)
{
  Face_frame frame;
  Local_fit& fit = frame.flat_fit;
  fit.origin = mean_of_corners(corners, points);
  fit.n = normal;
  fit.scale = 0;
  Point longest = {0, 0, 0};
  double square_length = 0;
  double twice_area = 0;
  for (std::size_t i = 0; i < corners.size(); ++i)
  {
    const Point& a = points[corners[i]];
    const Point& b = points[corners[(i + 1) % corners.size()]];
    const Point side = subtract(b, a);
    fit.scale = std::max(fit.scale, length(subtract(a, fit.origin)));
    twice_area += dot(normal, cross(subtract(a, fit.origin), side));
    if (dot(side, side) > square_length)
    {
      square_length = dot(side, side);
      longest = side;
    }
  }
  fit.u = normalized(subtract(longest, scaled(dot(longest, normal), normal)));
  fit.v = cross(normal, fit.u);
  // A corner that is off by delta tilts the plane by delta over the height of the face above its longest edge.
  frame.slope_noise = std::sqrt(square_length) / twice_area;
  return frame;
}

/// What became of one face.
struct Face_result
{
  Local_fit fit;
  Index stencil_size = 0;
  bool is_planar = false;
  bool is_lowered = false;
  bool has_poor_stencil = false;
  Lowering_reason reason = Lowering_reason::not_finite;
};

/// Fits one face after another; holds the memory that every fit needs, so that fits allocate nothing.
template <class Policies>
class Face_fitter
{
public:
  Face_fitter(const Surface_arrays& surface, const Policies& policies, double largest_displacement,
              bool interpolates_corners)
    : surface_(&surface), policies_(&policies), builder_(surface), largest_displacement_(largest_displacement),
      interpolates_corners_(interpolates_corners)
  {}

  Face_result fit(Index face, int degree)
  {
    Face_result result;
    const std::span<const Index> corners = surface_->corners_of_face(face);
    const Point& normal = surface_->face_normals[face];
    if (normal == Point{0, 0, 0})
    {
      result.fit.origin = mean_of_corners(corners, surface_->points);
      result.is_lowered = true;
      result.reason = Lowering_reason::no_normal;
      return result;
    }
    const Face_frame frame = face_frame(corners, surface_->points, normal);
    result.fit = frame.flat_fit;
    for (int d = degree; d > 0; --d)
    {
      gather_points(face, frame, d);
      if (is_planar_)
        break;
      result.fit.degree = d;
      if (solve(corners, result))
        return result;
      result.is_lowered = true;
    }
    result.is_planar = is_planar_;
    result.is_lowered = result.is_lowered && !is_planar_;
    result.fit.degree = 0;
    result.fit.coefficients = {};
    return result;
  }

private:
  /// sets the weighted points of the stencil, in the order of the vertices whatever the order of growth, and
  /// is_planar_.
  void gather_points(Index face, const Face_frame& frame, int degree)
  {
    builder_.start(face);
    policies_->stencil(builder_, degree);
    const std::span<Index> vertices = builder_.vertices();
    std::sort(vertices.begin(), vertices.end());
    points_.start(vertices.size());
    is_planar_ = true;
    for (std::size_t i = 0; i < vertices.size(); ++i)
      if (is_best_side(*surface_, vertices, i, frame.flat_fit.n))
        add_point(vertices[i], surface_->corners_of_face(face), frame, degree);
  }

  void add_point(Index vertex, std::span<const Index> corners, const Face_frame& frame, int degree)
  {
    const Local_fit& plane = frame.flat_fit;
    const Point& x = surface_->points[vertex];
    const Point local = plane.local_coordinates(x);
    const double distance = length(local);
    const double weight = policies_->weighting(
      Stencil_point{.distance = distance / plane.scale,
                    .cosine = dot(surface_->normals[vertex], plane.n),
                    .is_corner = std::find(corners.begin(), corners.end(), vertex) != corners.end()},
      degree);
    if (!(weight > 0) || !std::isfinite(weight))
      return;
    points_.add(local[0] / plane.scale, local[1] / plane.scale, local[2] / plane.scale, weight);
    // Heights that the resolution of the point, of the origin and of the normal can explain are none.
    const double resolution = coordinate_resolution * std::max(largest_coordinate(x), largest_coordinate(plane.origin));
    if (std::abs(local[2]) > 2 * resolution * (1 + distance * frame.slope_noise))
      is_planar_ = false;
  }

  /// sets the coefficients of `result`. \return whether they pass the checks; if not, the reason is in `result`.
  bool solve(std::span<const Index> corners, Face_result& result)
  {
    Local_fit& fit = result.fit;
    const std::size_t count = static_cast<std::size_t>(coefficient_count(fit.degree));
    const std::span<double> coefficients(fit.coefficients.data(), count);
    fit.coefficients = {};
    policies_->solver(points_.view(false), fit.degree, coefficients);
    result.stencil_size = builder_.size();
    result.has_poor_stencil = points_.size() < count;
    if (interpolates_corners_)
      meet_corners(corners, fit);
    if (!std::all_of(coefficients.begin(), coefficients.end(), [](double c) { return std::isfinite(c); }))
      result.reason = Lowering_reason::not_finite;
    else if (!is_sane(corners, fit))
      result.reason = Lowering_reason::displacement;
    else
      return true;
    return false;
  }

  void meet_corners(std::span<const Index> corners, Local_fit& fit)
  {
    residuals_.clear();
    for (const Index corner : corners)
    {
      const Point local = fit.local_coordinates(surface_->points[corner]);
      residuals_.push_back(
        {local[0] / fit.scale, local[1] / fit.scale, (local[2] - fit.height(local[0], local[1])) / fit.scale});
    }
    pass_through_corners(residuals_, fit);
  }

  /// whether corners, mid-edges and centre of the face stay near the face.
  bool is_sane(std::span<const Index> corners, const Local_fit& fit) const
  {
    const double bound = largest_displacement_ * fit.scale;
    const auto stays_near = [&](const Point& local) {
      return std::abs(fit.height(local[0], local[1]) - local[2]) <= bound;
    };
    Point previous = fit.local_coordinates(surface_->points[corners.back()]);
    for (const Index corner : corners)
    {
      const Point local = fit.local_coordinates(surface_->points[corner]);
      if (!stays_near(local) || !stays_near(scaled(0.5, add(previous, local))))
        return false;
      previous = local;
    }
    return stays_near({0, 0, 0});
  }

  const Surface_arrays* surface_;
  const Policies* policies_;
  Stencil_builder builder_;
  double largest_displacement_;
  bool interpolates_corners_;
  bool is_planar_ = false;
  Fit_points points_;
  std::vector<Corner_residual> residuals_;
};

} // namespace recurve::internal::surface

#endif
