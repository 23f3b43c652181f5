#ifndef RECURVE_SURFACE_INTERNAL_FIND_ROW_CIRCLES_H
#define RECURVE_SURFACE_INTERNAL_FIND_ROW_CIRCLES_H

#include <recurve/core/types.h>
#include <recurve/surface/row_circles.h>

namespace recurve::internal::surface {

/// Finds how the rows of faces bend at a vertex. A circle through the vertex along s is where x = |x|^2 / 2 times its
/// curvature, a vector; so this is sought by linear regression of the neighbours. (Without a constant term: that would
/// explain what neighbours on one side of a rim have in common.)
class Row_finder
{
public:
  /// \param local  coordinates of a neighbour, all three as lengths.
  void add(const Point& local)
  {
    const double half_square = 0.5 * (local[0] * local[0] + local[1] * local[1] + local[2] * local[2]);
    qq_ += half_square * half_square;
    tt_ += local[1] * local[1];
    tq_ += local[1] * half_square;
    wq_ += local[2] * half_square;
  }

  /// \return with units 1; straight rows where the circle does not explain most of what the neighbours differ in t: so
  /// it is for all faces that are not much longer than wide.
  Row_circles circles() const
  {
    constexpr double explained = 0.5; // of the sum of squares: what remains is 0.7 times as wide at most
    if (!(tq_ * tq_ > explained * tt_ * qq_))
      return {};
    return {.bend_in_plane = tq_ / qq_, .bend_off_plane = wq_ / qq_};
  }

private:
  double qq_ = 0, tt_ = 0, tq_ = 0, wq_ = 0;
};

} // namespace recurve::internal::surface

#endif
