#ifndef RECURVE_FEATURES_INTERNAL_SYMMETRIC_EIGEN_H
#define RECURVE_FEATURES_INTERNAL_SYMMETRIC_EIGEN_H

#include <recurve/features/internal/vector_3.h>

#include <array>
#include <cmath>
#include <utility>

namespace recurve::internal::features {

/// A symmetric 3 x 3 matrix: xx, xy, xz, yy, yz, zz.
using Symmetric_matrix = std::array<double, 6>;

/// Eigenvalues in descending order, and the eigenvector of the smallest, of length 1.
struct Symmetric_eigen
{
  std::array<double, 3> values{};
  Vector smallest{};
};

/// the eigenvalues of `m` by Jacobi rotations: slower than a closed formula, but as accurate for nearly equal
/// eigenvalues, which flat and conical vertices have.
inline Symmetric_eigen eigen(const Symmetric_matrix& m)
{
  double a[3][3] = {{m[0], m[1], m[2]}, {m[1], m[3], m[4]}, {m[2], m[4], m[5]}};
  double vectors[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  constexpr int most_sweeps = 30; // quadratic convergence: six are enough in practice
  for (int sweep = 0; sweep < most_sweeps; ++sweep)
  {
    const double off = std::abs(a[0][1]) + std::abs(a[0][2]) + std::abs(a[1][2]);
    if (off <= 1e-17 * (std::abs(a[0][0]) + std::abs(a[1][1]) + std::abs(a[2][2])))
      break;
    for (const auto& [p, q] : {std::pair{0, 1}, std::pair{0, 2}, std::pair{1, 2}})
    {
      if (a[p][q] == 0)
        continue;
      const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
      const double t = (theta >= 0 ? 1 : -1) / (std::abs(theta) + std::sqrt(theta * theta + 1));
      const double c = 1 / std::sqrt(t * t + 1), s = t * c;
      for (auto& row : a)
      {
        const double x = row[p], y = row[q];
        row[p] = c * x - s * y;
        row[q] = s * x + c * y;
      }
      for (int k = 0; k < 3; ++k)
      {
        const double x = a[p][k], y = a[q][k];
        a[p][k] = c * x - s * y;
        a[q][k] = s * x + c * y;
      }
      for (auto& row : vectors)
      {
        const double x = row[p], y = row[q];
        row[p] = c * x - s * y;
        row[q] = s * x + c * y;
      }
    }
  }
  std::array<int, 3> order = {0, 1, 2};
  for (const auto& [i, j] : {std::pair{0, 1}, std::pair{1, 2}, std::pair{0, 1}})
    if (a[order[i]][order[i]] < a[order[j]][order[j]])
      std::swap(order[i], order[j]);
  Symmetric_eigen result;
  for (int i = 0; i < 3; ++i)
    result.values[i] = a[order[i]][order[i]];
  result.smallest = {vectors[0][order[2]], vectors[1][order[2]], vectors[2][order[2]]};
  return result;
}

} // namespace recurve::internal::features

#endif
