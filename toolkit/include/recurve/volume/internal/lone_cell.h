#ifndef RECURVE_VOLUME_INTERNAL_LONE_CELL_H
#define RECURVE_VOLUME_INTERNAL_LONE_CELL_H

#include <recurve/core/types.h>
#include <recurve/elements/element.h>
#include <recurve/volume/internal/distortion.h>
#include <recurve/volume/internal/repair_component.h>
#include <recurve/volume/internal/untangle.h>

#include <Eigen/Core>
#include <Eigen/LU>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

namespace recurve::internal {

/// A cell without its neighbours, to be asked how good it can get with some of its nodes fixed.
class Lone_cell
{
public:
  /// \param straight  positions of all nodes in the straight cell. \pre it is valid
  /// \param may_move  callable (number of a node) -> bool: whether it may be anywhere.
  template <class MayMove>
  Lone_cell(Element_type type, int degree, std::vector<Point> straight, const MayMove& may_move)
    : points_(&distortion_points(type, degree)), straight_(std::move(straight)), order_(straight_.size()),
      movable_(split(order_, may_move)), repair_(std::vector{distorted(type)}, straight_, movable_)
  {
    find_fixed_points();
  }

  /// the smallest determinant, relative to that of the straight cell and at the points where distortion is measured,
  /// with the movable nodes where they distort the cell least; 0 if it is not valid there, or if that is less than
  /// `least` since the fixed nodes leave no more.
  ///
  /// \param positions  of all nodes; the movable ones start there.
  /// \param enough     more is not looked for.
  /// \param is_valid   callable (positions) -> bool.
  template <class IsValid>
  double room(std::vector<Point> positions, double least, double enough, const IsValid& is_valid)
  {
    const double fixed = fixed_room(positions);
    if (!(fixed > 0 && fixed >= least))
      return 0;
    std::vector<Point> displacements;
    for (const std::size_t m : order_)
      displacements.push_back(difference(positions[m], straight_[m]));
    repair_.displace(std::move(displacements));
    const auto is_done = [&] {
      for (std::size_t k = 0; k < movable_; ++k)
        for (std::size_t d = 0; d < 3; ++d)
          positions[order_[k]][d] = straight_[order_[k]][d] + repair_.displacements()[k][d];
      return is_valid(positions);
    };
    const bool has_room = movable_ == 0 ? is_done() : untangle(repair_, is_done, enough);
    return has_room ? std::max(repair_.least_determinant(), 0.0) : 0;
  }

private:
  /// A point where the movable nodes have no say, and the determinant there in the straight cell.
  struct Fixed_point
  {
    std::size_t point = 0;
    double straight = 0;
  };

  /// fills `order` with the numbers of nodes, those first that may move. Returns how many these are.
  template <class MayMove>
  static std::size_t split(std::vector<std::size_t>& order, const MayMove& may_move)
  {
    std::iota(order.begin(), order.end(), std::size_t(0));
    const auto fixed = std::stable_partition(order.begin(), order.end(), may_move);
    return static_cast<std::size_t>(fixed - order.begin());
  }

  Distorted_cell distorted(Element_type type) const
  {
    Distorted_cell cell{type, points_, straight_, std::vector<int>(order_.size())};
    for (std::size_t k = 0; k < order_.size(); ++k)
      cell.nodes[order_[k]] = static_cast<int>(k);
    return cell;
  }

  static Point difference(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

  void find_fixed_points()
  {
    constexpr double none = 1e-9; // of a derivative; they are sums of a few numbers of the size of the degree
    for (std::size_t q = 0; q < static_cast<std::size_t>(points_->count()); ++q)
      if (std::all_of(order_.begin(), order_.begin() + static_cast<std::ptrdiff_t>(movable_),
                      [&](std::size_t m) { return slope(q, m).cwiseAbs().maxCoeff() < none; }))
        if (const double det = determinant(q, straight_); det > 0)
          fixed_points_.push_back({q, det});
  }

  Eigen::Map<const Eigen::RowVector3d> slope(std::size_t point, std::size_t node) const
  {
    return Eigen::Map<const Eigen::RowVector3d>(points_->view().derivatives + 3 * (straight_.size() * point + node));
  }

  double determinant(std::size_t point, std::span<const Point> positions) const
  {
    Eigen::Matrix3d jacobian = Eigen::Matrix3d::Zero();
    for (std::size_t m = 1; m < positions.size(); ++m)
    {
      const Point v = difference(positions[m], positions[0]); // the place of the cell does not matter
      jacobian += Eigen::Vector3d(v[0], v[1], v[2]) * slope(point, m);
    }
    return jacobian.determinant();
  }

  double fixed_room(std::span<const Point> positions) const
  {
    double least = std::numeric_limits<double>::infinity();
    for (const Fixed_point& fixed : fixed_points_)
      least = std::min(least, determinant(fixed.point, positions) / fixed.straight);
    return least;
  }

  const Distortion_points* points_;
  std::vector<Point> straight_;
  std::vector<std::size_t> order_; ///< numbers of nodes, movable ones first
  std::size_t movable_;
  Repair_component repair_;
  std::vector<Fixed_point> fixed_points_;
};

} // namespace recurve::internal

#endif
