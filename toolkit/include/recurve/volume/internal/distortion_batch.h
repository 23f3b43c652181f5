#ifndef RECURVE_VOLUME_INTERNAL_DISTORTION_BATCH_H
#define RECURVE_VOLUME_INTERNAL_DISTORTION_BATCH_H

#include <recurve/core/types.h>
#include <recurve/volume/internal/distortion.h>
#include <recurve/volume/internal/distortion_kernels.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace recurve::internal {

/// A cell of a repair: where its nodes are when it is straight, and their numbers in the repair.
struct Distorted_cell
{
  Element_type type = Element_type::tetrahedron;
  const Distortion_points* points = nullptr; ///< of its type
  std::vector<Point> straight;
  std::vector<int> nodes;
};

/// What an evaluation of distortions is to find beside the value.
enum class Find
{
  value,
  gradient,
  blocks ///< and the gradient
};

/// Cells of one type, one to a lane, with the inverse Jacobian matrices of their straight selves.
class Distortion_batch
{
public:
  /// Numbers of an evaluation, for one thread; they grow to what the largest batch needs.
  struct Workspace
  {
    std::vector<double> vectors, gradients, squares, determinants, by_square, by_det, inflating, slopes, blocks;
  };

  /// \param cells  of one type, as many as there are lanes or fewer. \pre valid when straight
  Distortion_batch(const Distortion_kernel& kernel, std::span<const Distorted_cell* const> cells)
    : kernel_(&kernel), points_(cells[0]->points->view()), cells_(static_cast<int>(cells.size()))
  {
    std::vector<double> vectors(numbers(3 * points_.nodes));
    for (int lane = 0; lane < kernel_->batch; ++lane)
    {
      const std::vector<Point>& straight = cells[own_cell(lane)]->straight;
      for (std::size_t m = 0; m < straight.size(); ++m)
        for (std::size_t d = 0; d < 3; ++d) // from the first corner: the place of the cell does not matter
          vectors[at(static_cast<int>(3 * m + d), lane)] = straight[m][d] - straight[0][d];
    }
    inverses_.resize(numbers(9 * points_.count));
    kernel_->find_reference_gradients(points_, vectors.data(), inverses_.data());
    for (int q = 0; q < points_.count; ++q)
      for (int lane = 0; lane < kernel_->batch; ++lane)
        invert(q, lane);
  }

  int cell_count() const { return cells_; }

  /// evaluates the mean distortion of each cell.
  /// \param displacement  callable (cell of the batch, its node) -> const Point&
  /// \param take          callable (cell of the batch, value, smallest det F): its results
  template <class Displacement, class Take>
  void evaluate(const Displacement& displacement, double epsilon, Find find, Workspace& work, const Take& take) const
  {
    resize(work);
    for (int lane = 0; lane < kernel_->batch; ++lane)
      for (int m = 0; m < points_.nodes; ++m)
      {
        const Point& s = displacement(static_cast<int>(own_cell(lane)), m);
        for (int d = 0; d < 3; ++d)
          work.vectors[at(3 * m + d, lane)] = s[static_cast<std::size_t>(d)];
      }
    kernel_->find_reference_gradients(points_, work.vectors.data(), work.gradients.data());
    kernel_->find_map_gradients(points_, inverses_.data(), work.gradients.data(), work.squares.data(),
                                work.determinants.data());
    for (int cell = 0; cell < cells_; ++cell)
      measure(cell, epsilon, work, take);
    if (find != Find::value)
      kernel_->find_slopes(points_, inverses_.data(), work.gradients.data(), work.by_square.data(), work.by_det.data(),
                           work.slopes.data());
    if (find == Find::blocks)
      kernel_->find_blocks(points_, inverses_.data(), work.gradients.data(), work.by_square.data(),
                           work.inflating.data(), work.blocks.data());
  }

  /// of the last evaluation with this workspace, with respect to the displacement of a node.
  double slope(const Workspace& work, int cell, int node, int component) const
  {
    return work.slopes[at(3 * node + component, cell)];
  }
  double block(const Workspace& work, int cell, int node, int entry) const
  {
    return work.blocks[at(6 * node + entry, cell)];
  }

private:
  std::size_t numbers(int count) const { return static_cast<std::size_t>(count) * std::size_t(kernel_->batch); }
  std::size_t at(int number, int lane) const { return numbers(number) + static_cast<std::size_t>(lane); }

  /// Lanes that are left over repeat the last cell.
  std::size_t own_cell(int lane) const { return static_cast<std::size_t>(std::min(lane, cells_ - 1)); }

  void resize(Workspace& work) const
  {
    work.vectors.resize(numbers(3 * points_.nodes));
    work.slopes.resize(numbers(3 * points_.nodes));
    work.blocks.resize(numbers(6 * points_.nodes));
    work.gradients.resize(numbers(9 * points_.count));
    for (auto* list : {&work.squares, &work.determinants, &work.by_square, &work.by_det, &work.inflating})
      list->resize(numbers(points_.count));
  }

  void invert(int q, int lane)
  {
    std::array<double, 9> j;
    for (int i = 0; i < 9; ++i)
      j[static_cast<std::size_t>(i)] = inverses_[at(9 * q + i, lane)];
    const std::array<double, 9> cofactors = {
      j[4] * j[8] - j[5] * j[7], j[5] * j[6] - j[3] * j[8], j[3] * j[7] - j[4] * j[6],
      j[2] * j[7] - j[1] * j[8], j[0] * j[8] - j[2] * j[6], j[1] * j[6] - j[0] * j[7],
      j[1] * j[5] - j[2] * j[4], j[2] * j[3] - j[0] * j[5], j[0] * j[4] - j[1] * j[3]};
    const double inverse = 1 / (j[0] * cofactors[0] + j[1] * cofactors[1] + j[2] * cofactors[2]);
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c)
        inverses_[at(9 * q + 3 * r + c, lane)] = inverse * cofactors[static_cast<std::size_t>(3 * c + r)];
  }

  template <class Take>
  void measure(int cell, double epsilon, Workspace& work, const Take& take) const
  {
    const double weight = 1.0 / points_.count;
    double value = 0, least = std::numeric_limits<double>::infinity();
    for (int q = 0; q < points_.count; ++q)
    {
      const std::size_t n = at(q, cell);
      const double det = work.determinants[n];
      const Distortion distortion(work.squares[n], det, epsilon);
      value += weight * distortion.value;
      least = std::min(least, std::isnan(det) ? -std::numeric_limits<double>::infinity() : det);
      work.by_square[n] = weight * distortion.by_square;
      work.by_det[n] = weight * distortion.by_det;
      work.inflating[n] = weight * distortion.inflating;
    }
    take(cell, value, least);
  }

  const Distortion_kernel* kernel_;
  Distortion_view points_;
  int cells_;
  std::vector<double> inverses_;
};

} // namespace recurve::internal

#endif
