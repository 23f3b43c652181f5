#ifndef RECURVE_SURFACE_WEIGHTED_POINTS_H
#define RECURVE_SURFACE_WEIGHTED_POINTS_H

#include <cstddef>
#include <span>

namespace recurve {

/// The data of one least-squares problem: heights over a plane, in units of the face's size. Views into arrays of one
/// length.
struct Weighted_points
{
  std::span<const double> u;
  std::span<const double> v;
  std::span<const double> height;
  std::span<const double> weight; ///< > 0
  bool is_through_origin = false; ///< the polynomial has no constant term: its coefficient is to be 0

  std::size_t size() const { return u.size(); }
};

} // namespace recurve

#endif
