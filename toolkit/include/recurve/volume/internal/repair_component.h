#ifndef RECURVE_VOLUME_INTERNAL_REPAIR_COMPONENT_H
#define RECURVE_VOLUME_INTERNAL_REPAIR_COMPONENT_H

#include <recurve/core/types.h>
#include <recurve/volume/internal/distortion_batch.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <deque>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

namespace recurve::internal {

/// Moves nodes so that the cells around them resemble their straight selves as closely as the other nodes let them:
/// the mean distortion of each cell, summed, is minimised by L-BFGS under a diagonal of 3 x 3 blocks. All sums are in
/// the order of cells and nodes: the same bits for any number of threads.
class Repair_component
{
public:
  /// \param displacements  of the nodes; the first `movable_count` of them may move.
  Repair_component(std::span<const Distorted_cell> cells, std::vector<Point> displacements, std::size_t movable_count)
    : displacements_(std::move(displacements)), movable_(movable_count), values_(cells.size()), least_(cells.size())
  {
    list_places(cells);
    make_batches(cells);
    gradients_.resize(first_slot_.back());
    blocks_.resize(first_slot_.back());
  }

  const std::vector<Point>& displacements() const { return displacements_; }
  void displace(std::vector<Point> displacements) { displacements_ = std::move(displacements); }

  /// the smallest det F at any point.
  double least_determinant()
  {
    evaluate(1, Find::value);
    return *std::min_element(least_.begin(), least_.end());
  }

  /// minimises the distortion regularised by `epsilon`, in at most `iterations` steps. Returns the smallest det F at
  /// any point.
  double minimise(double epsilon, int iterations)
  {
    constexpr double enough = 1e-6; // relative decrease of a step, after which more of them do not pay
    double value = evaluate(epsilon, Find::blocks);
    double least = *std::min_element(least_.begin(), least_.end());
    invert_blocks();
    Vector gradient = gathered_gradient();
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
      least = *std::min_element(least_.begin(), least_.end());
      const Vector next = gathered_gradient();
      remember(way, next - gradient);
      gradient = next;
      const bool is_done = value - reached <= enough * value;
      value = reached;
      if (is_done)
        break;
    }
    return least;
  }

private:
  using Vector = Eigen::VectorXd;
  using Block = std::array<double, 6>; ///< xx, yy, zz, yz, zx, xy of a symmetric matrix

  struct Pair
  {
    Vector step, change;
    double inverse; ///< 1 / their product
  };

  /// Cells of one type, by their numbers.
  struct Batch
  {
    Distortion_batch distortion;
    std::vector<std::size_t> cells;
  };

  bool may_move(int node) const { return static_cast<std::size_t>(node) < movable_; }

  /// for each movable node, where the cells keep what they contribute to it.
  void list_places(std::span<const Distorted_cell> cells)
  {
    first_slot_.push_back(0);
    slots_.resize(movable_);
    for (const Distorted_cell& cell : cells)
    {
      std::size_t slot = first_slot_.back();
      for (const int node : cell.nodes)
        if (may_move(node))
          slots_[static_cast<std::size_t>(node)].push_back(slot++);
      first_slot_.push_back(slot);
      nodes_.push_back(cell.nodes);
    }
  }

  void make_batches(std::span<const Distorted_cell> cells)
  {
    const Distortion_kernel& kernel = distortion_kernel();
    std::vector<std::size_t> order(cells.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::ranges::stable_sort(order, {}, [&](std::size_t c) { return cells[c].type; });
    for (std::size_t first = 0, last = 0; first < order.size(); first = last)
    {
      std::vector<const Distorted_cell*> own;
      while (last < order.size() && std::ssize(own) < kernel.batch &&
             cells[order[last]].type == cells[order[first]].type)
        own.push_back(&cells[order[last++]]);
      batches_.push_back(
        {Distortion_batch(kernel, own), {order.begin() + std::ptrdiff_t(first), order.begin() + std::ptrdiff_t(last)}});
    }
  }

  /// the sum of all cells.
  double evaluate(double epsilon, Find find)
  {
    tbb::parallel_for(std::size_t(0), batches_.size(), [&](std::size_t b) { evaluate(batches_[b], epsilon, find); });
    double sum = 0;
    for (const double value : values_)
      sum += value;
    return sum;
  }

  void evaluate(const Batch& batch, double epsilon, Find find)
  {
    Distortion_batch::Workspace& work = workspaces_.local();
    const auto cell = [&](int own) { return batch.cells[static_cast<std::size_t>(own)]; };
    batch.distortion.evaluate(
      [&](int own, int m) -> const Point& {
        return displacements_[static_cast<std::size_t>(nodes_[cell(own)][static_cast<std::size_t>(m)])];
      },
      epsilon, find, work,
      [&](int own, double value, double least) {
        values_[cell(own)] = value;
        least_[cell(own)] = least;
      });
    for (int own = 0; find != Find::value && own < batch.distortion.cell_count(); ++own)
      keep_derivatives(batch, own, find, work);
  }

  /// the shares of a cell in the derivatives with respect to its nodes.
  void keep_derivatives(const Batch& batch, int own, Find find, const Distortion_batch::Workspace& work)
  {
    const std::size_t c = batch.cells[static_cast<std::size_t>(own)];
    std::size_t slot = first_slot_[c];
    for (int m = 0; m < static_cast<int>(nodes_[c].size()); ++m)
    {
      if (!may_move(nodes_[c][static_cast<std::size_t>(m)]))
        continue;
      for (int d = 0; d < 3; ++d)
        gradients_[slot][static_cast<std::size_t>(d)] = batch.distortion.slope(work, own, m, d);
      if (find == Find::blocks)
        for (int entry = 0; entry < 6; ++entry)
          blocks_[slot][static_cast<std::size_t>(entry)] = batch.distortion.block(work, own, m, entry);
      ++slot;
    }
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
      // The first step is mostly taken, and then its derivatives are needed.
      const double reached = evaluate(epsilon, halving == 0 ? Find::gradient : Find::value);
      if (std::isfinite(reached) && reached <= value + decrease * length * slope)
      {
        taken_ = length;
        return halving == 0 ? reached : evaluate(epsilon, Find::gradient);
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

  std::vector<Point> displacements_;
  std::size_t movable_;
  std::vector<std::vector<int>> nodes_; ///< per cell
  std::vector<Batch> batches_;
  std::vector<std::size_t> first_slot_;         ///< per cell, and the end
  std::vector<std::vector<std::size_t>> slots_; ///< per movable node, of its cells
  std::vector<Point> gradients_;                ///< per slot
  std::vector<Eigen::Matrix3d> inverse_blocks_; ///< per movable node
  std::vector<Block> blocks_;                   ///< per slot
  std::vector<double> values_, least_;          ///< per cell; the smallest det F
  tbb::enumerable_thread_specific<Distortion_batch::Workspace> workspaces_;
  std::deque<Pair> history_;
  double taken_ = 1;
};

} // namespace recurve::internal

#endif
