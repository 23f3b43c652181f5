#ifndef RECURVE_SURFACE_WEIGHTED_POINTS_H
#define RECURVE_SURFACE_WEIGHTED_POINTS_H

#include <cstddef>
#include <span>

namespace recurve {

/// Slopes of the height that a least-squares problem is to meet too (Hermite fits). Views into arrays of one length.
struct Weighted_slopes
{
  std::span<const double> u; ///< place
  std::span<const double> v;
  std::span<const double> by_u; ///< derivative of the height by u there
  std::span<const double> by_v;
  std::span<const double> weight; ///< > 0, of each of the two equations

  std::size_t size() const { return u.size(); }
};

/// The data of one least-squares problem: heights over a plane, in units of the face's size. Views into arrays of one
/// length.
struct Weighted_points
{
  std::span<const double> u;
  std::span<const double> v;
  std::span<const double> height;
  std::span<const double> weight; ///< > 0
  bool is_through_origin = false; ///< the polynomial has no constant term: its coefficient is to be 0
  Weighted_slopes slopes = {};    ///< none unless normals are data

  std::size_t size() const { return u.size(); }
};

} // namespace recurve

#endif
