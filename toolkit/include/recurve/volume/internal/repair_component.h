#ifndef RECURVE_VOLUME_INTERNAL_REPAIR_COMPONENT_H
#define RECURVE_VOLUME_INTERNAL_REPAIR_COMPONENT_H

#include <recurve/core/types.h>
#include <recurve/volume/internal/distortion.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <deque>
#include <limits>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace recurve::internal {

/// Moves nodes so that the cells around them resemble their straight selves as closely as the other nodes let them:
/// the mean distortion of each cell, summed, is minimised by L-BFGS under a diagonal of 3 x 3 blocks. All sums are in
/// the order of cells and nodes: the same bits for any number of threads.
class Repair_component
{
public:
  /// A cell by its nodes: numbers in `displacements`, of which the first `movable_count` may move.
  struct Cell
  {
    Straight_shape shape;
    std::vector<int> nodes;
  };

  Repair_component(std::vector<Cell> cells, std::vector<Point> displacements, std::size_t movable_count)
    : cells_(std::move(cells)), displacements_(std::move(displacements)), movable_(movable_count)
  {
    list_places();
    gradients_.resize(first_slot_.back());
    blocks_.resize(first_slot_.back());
    values_.resize(cells_.size());
    least_.resize(cells_.size());
  }

  const Point& displacement(std::size_t movable) const { return displacements_[movable]; }

  /// the smallest det F at any point.
  double least_determinant()
  {
    evaluate(1, Find::value);
    return *std::min_element(least_.begin(), least_.end());
  }

  /// minimises the distortion regularised by `epsilon`, in at most `iterations` steps. Returns whether it got anywhere.
  bool minimise(double epsilon, int iterations)
  {
    constexpr double enough = 1e-6; // relative decrease of a step, after which more of them do not pay
    double value = evaluate(epsilon, Find::blocks);
    invert_blocks();
    Vector gradient = gathered_gradient();
    const double first = value;
    history_.clear();
    for (int step = 0; step < iterations; ++step)
    {
      const Vector way = direction(gradient);
      const double slope = way.dot(gradient);
      if (!(slope < 0) || !std::isfinite(slope))
        break;
      const std::vector<Point> before(displacements_.begin(), displacements_.begin() + std::ptrdiff_t(movable_));
      const double reached = search(before, way, value, slope, epsilon);
      if (!(reached < value))
        break;
      const Vector next = gathered_gradient();
      remember(way, next - gradient);
      gradient = next;
      const bool is_done = value - reached <= enough * value;
      value = reached;
      if (is_done)
        break;
    }
    return value < first;
  }

private:
  using Vector = Eigen::VectorXd;
  using Block = std::array<double, 6>; ///< xx, yy, zz, yz, zx, xy of a symmetric matrix

  /// What an evaluation is to find beside the value.
  enum class Find
  {
    value,
    gradient,
    blocks ///< and the gradient
  };

  struct Pair
  {
    Vector step, change;
    double inverse; ///< 1 / their product
  };

  /// for each movable node, where the cells keep what they contribute to it.
  void list_places()
  {
    first_slot_.push_back(0);
    slots_.resize(movable_);
    for (const Cell& cell : cells_)
    {
      std::size_t slot = first_slot_.back();
      for (const int node : cell.nodes)
        if (static_cast<std::size_t>(node) < movable_)
          slots_[static_cast<std::size_t>(node)].push_back(slot++);
      first_slot_.push_back(slot);
    }
  }

  /// the sum of all cells.
  double evaluate(double epsilon, Find find)
  {
    tbb::parallel_for(std::size_t(0), cells_.size(), [&](std::size_t c) { evaluate(c, epsilon, find); });
    double sum = 0;
    for (const double value : values_)
      sum += value;
    return sum;
  }

  void evaluate(std::size_t c, double epsilon, Find find)
  {
    const Cell& cell = cells_[c];
    std::array<Point, node_count(Element_type::hexahedron, max_degree)> own;
    for (std::size_t m = 0; m < cell.nodes.size(); ++m)
      own[m] = displacements_[static_cast<std::size_t>(cell.nodes[m])];
    const double weight = 1 / static_cast<double>(cell.shape.point_count());
    values_[c] = 0;
    least_[c] = std::numeric_limits<double>::infinity();
    const auto clear = [&](auto& list) {
      std::fill(list.begin() + std::ptrdiff_t(first_slot_[c]), list.begin() + std::ptrdiff_t(first_slot_[c + 1]),
                typename std::decay_t<decltype(list)>::value_type{});
    };
    if (find != Find::value)
      clear(gradients_);
    if (find == Find::blocks)
      clear(blocks_);
    for (std::size_t q = 0; q < cell.shape.point_count(); ++q)
    {
      const Matrix_3 f = cell.shape.gradient(q, std::span<const Point>(own.data(), cell.nodes.size()));
      const Matrix_3 by_det = cofactors(f);
      const double det = determinant(f, by_det);
      double square = 0;
      for (const double entry : f)
        square += entry * entry;
      const Distortion distortion(square, det, epsilon);
      values_[c] += weight * distortion.value;
      least_[c] = std::min(least_[c], std::isnan(det) ? -std::numeric_limits<double>::infinity() : det);
      if (find != Find::value)
        add_gradient(c, q, f, by_det, distortion, weight);
      if (find == Find::blocks)
        add_blocks(c, q, by_det, distortion, weight);
    }
  }

  /// calls visit(slot, derivatives of the node's function) for the nodes of a cell that may move.
  template <class Visit>
  void for_each_movable(std::size_t c, std::size_t q, const Visit& visit) const
  {
    const auto derivatives = cells_[c].shape.derivatives(q);
    std::size_t slot = first_slot_[c];
    for (std::size_t m = 0; m < cells_[c].nodes.size(); ++m)
      if (static_cast<std::size_t>(cells_[c].nodes[m]) < movable_)
        visit(slot++, derivatives[m]);
  }

  static Point times(const Matrix_3& a, const Point& v)
  {
    return {a[0] * v[0] + a[1] * v[1] + a[2] * v[2], a[3] * v[0] + a[4] * v[1] + a[5] * v[2],
            a[6] * v[0] + a[7] * v[1] + a[8] * v[2]};
  }

  void add_gradient(std::size_t c, std::size_t q, const Matrix_3& f, const Matrix_3& by_det,
                    const Distortion& distortion, double weight)
  {
    Matrix_3 stress;
    for (std::size_t i = 0; i < 9; ++i)
      stress[i] = weight * (2 * distortion.by_square * f[i] + distortion.by_det * by_det[i]);
    stress = product_transposed(stress, cells_[c].shape.inverse(q));
    for_each_movable(c, q, [&](std::size_t slot, const Point& derivative) {
      const Point g = times(stress, derivative);
      for (std::size_t d = 0; d < 3; ++d)
        gradients_[slot][d] += g[d];
    });
  }

  void add_blocks(std::size_t c, std::size_t q, const Matrix_3& by_det, const Distortion& distortion, double weight)
  {
    const Matrix_3& inverse = cells_[c].shape.inverse(q);
    const Matrix_3 metric = product_transposed(inverse, inverse), normal = product_transposed(by_det, inverse);
    for_each_movable(c, q, [&](std::size_t slot, const Point& derivative) {
      const Point m = times(metric, derivative), n = times(normal, derivative);
      const double stretching =
        2 * weight * distortion.by_square * (m[0] * derivative[0] + m[1] * derivative[1] + m[2] * derivative[2]);
      const double w = weight * distortion.inflating;
      Block& block = blocks_[slot];
      for (std::size_t d = 0; d < 3; ++d)
      {
        block[d] += stretching + w * n[d] * n[d];
        block[3 + d] += w * n[(d + 1) % 3] * n[(d + 2) % 3];
      }
    });
  }

  Vector gathered_gradient() const
  {
    Vector result = Vector::Zero(static_cast<Eigen::Index>(3 * movable_));
    for (std::size_t n = 0; n < movable_; ++n)
      for (const std::size_t slot : slots_[n])
        for (std::size_t d = 0; d < 3; ++d)
          result[static_cast<Eigen::Index>(3 * n + d)] += gradients_[slot][d];
    return result;
  }

  /// inverts the diagonal of blocks of the last evaluation that found them.
  void invert_blocks()
  {
    inverse_blocks_.resize(movable_);
    for (std::size_t n = 0; n < movable_; ++n)
    {
      Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
      for (const std::size_t slot : slots_[n])
      {
        const Block& b = blocks_[slot];
        sum += (Eigen::Matrix3d() << b[0], b[5], b[4], b[5], b[1], b[3], b[4], b[3], b[2]).finished();
      }
      inverse_blocks_[n] = sum.ldlt().solve(Eigen::Matrix3d::Identity());
    }
  }

  Vector preconditioned(const Vector& v) const
  {
    Vector result(v.size());
    for (std::size_t n = 0; n < movable_; ++n)
      result.segment<3>(static_cast<Eigen::Index>(3 * n)) =
        inverse_blocks_[n] * v.segment<3>(static_cast<Eigen::Index>(3 * n));
    return result;
  }

  /// the two-loop recursion of L-BFGS.
  Vector direction(const Vector& gradient) const
  {
    Vector v = -gradient;
    std::vector<double> factors;
    for (auto pair = history_.rbegin(); pair != history_.rend(); ++pair)
    {
      factors.push_back(pair->inverse * pair->step.dot(v));
      v -= factors.back() * pair->change;
    }
    v = preconditioned(v);
    for (const Pair& pair : history_)
    {
      v += (factors.back() - pair.inverse * pair.change.dot(v)) * pair.step;
      factors.pop_back();
    }
    return v;
  }

  /// goes along `way`, halving until the value falls as it should. Returns the value there; derivatives are current.
  double search(std::span<const Point> before, const Vector& way, double value, double slope, double epsilon)
  {
    constexpr double decrease = 1e-4; // of what the slope promises; Armijo
    constexpr int most_halvings = 20;
    double length = 1;
    for (int halving = 0; halving < most_halvings; ++halving, length /= 2)
    {
      step(before, way, length);
      const double reached = evaluate(epsilon, Find::value);
      if (std::isfinite(reached) && reached <= value + decrease * length * slope)
      {
        taken_ = length;
        return evaluate(epsilon, Find::gradient);
      }
    }
    step(before, way, 0);
    return value;
  }

  void step(std::span<const Point> before, const Vector& way, double length)
  {
    for (std::size_t n = 0; n < movable_; ++n)
      for (std::size_t d = 0; d < 3; ++d)
        displacements_[n][d] = before[n][d] + length * way[static_cast<Eigen::Index>(3 * n + d)];
  }

  void remember(const Vector& way, const Vector& change)
  {
    constexpr std::size_t memory = 8;
    const Vector step = taken_ * way;
    const double product = step.dot(change);
    if (!(product > 1e-12 * step.norm() * change.norm()))
      return; // not convex along the way
    if (history_.size() == memory)
      history_.pop_front();
    history_.push_back({step, change, 1 / product});
  }

  std::vector<Cell> cells_;
  std::vector<Point> displacements_;
  std::size_t movable_;
  std::vector<std::size_t> first_slot_;         ///< per cell, and the end
  std::vector<std::vector<std::size_t>> slots_; ///< per movable node, of its cells
  std::vector<Point> gradients_;                ///< per slot
  std::vector<Eigen::Matrix3d> inverse_blocks_; ///< per movable node
  std::vector<Block> blocks_;                   ///< per slot
  std::vector<double> values_, least_;          ///< per cell
  std::deque<Pair> history_;
  double taken_ = 1;
};

} // namespace recurve::internal

#endif
