#ifndef RECURVE_SURFACE_INTERNAL_ONE_SIDED_DISTANCE_H
#define RECURVE_SURFACE_INTERNAL_ONE_SIDED_DISTANCE_H

#include <recurve/core/types.h>
#include <recurve/surface/internal/surface_arrays.h>
#include <recurve/surface/vertex_fit.h>

#include <cmath>
#include <cstddef>
#include <span>

namespace recurve::internal::surface {

/// Distance from the origin of a fit in its plane. Away from a rim it counts less than along the rim: at a rim a fit
/// extrapolates, and its error falls with every row of points that it sees behind the first, while along the rim it
/// has points on both sides and does not need them as far away.
struct One_sided_distance
{
  double s = 1, t = 0;     ///< unit vector away from the rim, in the coordinates of the fit
  double depth_factor = 1; ///< over which ways in that direction are divided

  bool is_round() const { return depth_factor == 1; }

  double depth(const Point& local) const { return local[0] * s + local[1] * t; }

  double width(const Point& local) const { return local[1] * s - local[0] * t; }

  double operator()(const Point& local) const
  {
    if (is_round())
      return std::sqrt(local[0] * local[0] + local[1] * local[1]);
    const double shortened = depth(local) / depth_factor;
    return std::sqrt(shortened * shortened + width(local) * width(local));
  }
};

/// the distance for `fit` to `vertices`: away from the rim is where their mean lies. Where that is near the fit's
/// vertex, they lie all around it.
inline One_sided_distance one_sided_distance(const Surface_arrays& surface, std::span<const Index> vertices,
                                             const Vertex_fit& fit)
{
  // Measured on half-spheres, lenses, cylinders and cones: 1 leaves 100 times the error, 3 is worse on spheres.
  constexpr double depth_factor = 2;
  constexpr double least_offset = 0.2; // of the mean, in root mean square distances; a half disc has 0.6
  double s = 0, t = 0, square = 0;
  for (const Index v : vertices)
  {
    const Point local = fit.row_coordinates(surface.points[static_cast<std::size_t>(v)]);
    s += local[0];
    t += local[1];
    square += local[0] * local[0] + local[1] * local[1];
  }
  const double norm = std::sqrt(s * s + t * t);
  const double count = static_cast<double>(vertices.size());
  if (!(norm > least_offset * std::sqrt(count * square)))
    return {};
  return {s / norm, t / norm, depth_factor};
}

} // namespace recurve::internal::surface

#endif
