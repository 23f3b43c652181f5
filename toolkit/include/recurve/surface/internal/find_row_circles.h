#ifndef RECURVE_SURFACE_INTERNAL_FIND_ROW_CIRCLES_H
#define RECURVE_SURFACE_INTERNAL_FIND_ROW_CIRCLES_H

#include <recurve/core/types.h>
#include <recurve/surface/row_circles.h>

namespace recurve::internal::surface {

/// Finds how the rows of faces bend at a vertex. A circle through the vertex along s is where x = |x|^2 / 2 times its
/// curvature, a vector; so this is sought by linear regression of the neighbours.
class Row_finder
{
public:
  /// \param local  coordinates of a neighbour, all three as lengths.
  void add(const Point& local)
  {
    const double half_square = 0.5 * (local[0] * local[0] + local[1] * local[1] + local[2] * local[2]);
    count_ += 1;
    q_ += half_square;
    qq_ += half_square * half_square;
    t_ += local[1];
    tt_ += local[1] * local[1];
    tq_ += local[1] * half_square;
    w_ += local[2];
    wq_ += local[2] * half_square;
  }

  /// \return with units 1; straight rows where the circle does not explain most of what the neighbours differ in t: so
  /// it is for all faces that are not much longer than wide.
  Row_circles circles() const
  {
    constexpr double unexplained = 0.5; // of the sum of squares: what remains is 0.7 times as wide at most
    const double spread = count_ * qq_ - q_ * q_;
    if (!(spread > 0))
      return {};
    const double bend = (count_ * tq_ - q_ * t_) / spread;
    const double offset = (t_ - bend * q_) / count_;
    const double remaining = tt_ - offset * t_ - bend * tq_;
    if (!(remaining < unexplained * tt_))
      return {};
    return {.bend_in_plane = bend, .bend_off_plane = (count_ * wq_ - q_ * w_) / spread};
  }

private:
  double count_ = 0, q_ = 0, qq_ = 0, t_ = 0, tt_ = 0, tq_ = 0, w_ = 0, wq_ = 0;
};

} // namespace recurve::internal::surface

#endif
