#ifndef RECURVE_VOLUME_INTERNAL_DISTORTION_H
#define RECURVE_VOLUME_INTERNAL_DISTORTION_H

#include <recurve/core/types.h>
#include <recurve/elements/basis.h>
#include <recurve/elements/element.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace recurve::internal {

/// Derivatives of the Lagrange functions at the points of a cell where its distortion is measured: a closed lattice
/// that is finer than the nodes. (That a cell is valid between them is for the certificate to say.)
class Distortion_points
{
public:
  Distortion_points(Element_type type, int degree) : nodes_(static_cast<std::size_t>(node_count(type, degree)))
  {
    const int n = degree + 1;
    std::vector<std::array<double, 3>> derivatives(nodes_);
    for (int k = 0; k <= n; ++k)
      for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i)
        {
          Reference_point p = {double(i) / n, double(j) / n, double(k) / n};
          if ((type == Element_type::tetrahedron && i + j + k > n) || (type == Element_type::prism && i + j > n))
            continue;
          if (type == Element_type::pyramid)
          {
            if (k == n && i + j > 0)
              continue; // the apex, once
            p[0] *= 1 - p[2];
            p[1] *= 1 - p[2];
          }
          lagrange_derivatives(type, degree, p, derivatives);
          derivatives_.insert(derivatives_.end(), derivatives.begin(), derivatives.end());
        }
  }

  std::size_t count() const { return derivatives_.size() / nodes_; }

  /// of all functions at one point.
  std::span<const std::array<double, 3>> at(std::size_t point) const
  {
    return std::span(derivatives_).subspan(point * nodes_, nodes_);
  }

private:
  std::size_t nodes_;
  std::vector<std::array<double, 3>> derivatives_;
};

/// 3 x 3, row by row. Plain numbers: these loops are what a repair spends its time in.
using Matrix_3 = std::array<double, 9>;

inline Matrix_3 product(const Matrix_3& a, const Matrix_3& b)
{
  Matrix_3 result;
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 3; ++c)
      result[3 * r + c] = a[3 * r] * b[c] + a[3 * r + 1] * b[3 + c] + a[3 * r + 2] * b[6 + c];
  return result;
}

/// a times the transpose of b.
inline Matrix_3 product_transposed(const Matrix_3& a, const Matrix_3& b)
{
  Matrix_3 result;
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 3; ++c)
      result[3 * r + c] = a[3 * r] * b[3 * c] + a[3 * r + 1] * b[3 * c + 1] + a[3 * r + 2] * b[3 * c + 2];
  return result;
}

/// derivative of the determinant.
inline Matrix_3 cofactors(const Matrix_3& f)
{
  return {f[4] * f[8] - f[5] * f[7], f[5] * f[6] - f[3] * f[8], f[3] * f[7] - f[4] * f[6],
          f[2] * f[7] - f[1] * f[8], f[0] * f[8] - f[2] * f[6], f[1] * f[6] - f[0] * f[7],
          f[1] * f[5] - f[2] * f[4], f[2] * f[3] - f[0] * f[5], f[0] * f[4] - f[1] * f[3]};
}

inline double determinant(const Matrix_3& f, const Matrix_3& cofactors)
{
  return f[0] * cofactors[0] + f[1] * cofactors[1] + f[2] * cofactors[2];
}

/// How far a map with the gradient F is from a rotation: |F|^2 / det F^(2/3) (shape) + (det F + 1 / det F) / 2
/// (volume), which grow beyond all bounds as det F tends to 0. So that it is finite and points the way out where
/// det F <= 0, det F in the denominators is replaced by chi = (det F + sqrt(det F^2 + epsilon^2)) / 2 > 0.
/// \par Source  Garanzha, Kaporin, Kudryavtseva, Protais, Ray & Sokolov 2021, ACM Trans. Graph. 40.
struct Distortion
{
  double value;
  double by_square; ///< derivative with respect to |F|^2
  double by_det;    ///< derivative with respect to det F
  double inflating; ///< second derivative with respect to det F, without negative parts

  Distortion(double square, double det, double epsilon)
  {
    const double root = std::sqrt(epsilon * epsilon + det * det);
    const double chi = det > 0 ? (det + root) / 2 : epsilon * epsilon / (2 * (root - det));
    const double slope = chi / root; // of chi
    const double third = std::cbrt(chi), shape = 1 / (third * third);
    value = square * shape + (det * det + 1) / (2 * chi);
    by_square = shape;
    by_det = -2.0 / 3 * square * shape / chi * slope + det / chi - (det * det + 1) * slope / (2 * chi * chi);
    inflating = (10.0 / 9 * square * shape / chi + (det * det + 1) / (chi * chi)) * slope * slope / chi;
  }
};

/// The inverse Jacobian matrices of a straight cell at the distortion points.
class Straight_shape
{
public:
  /// \param nodes  positions of the nodes in the straight cell. \pre that one is valid
  Straight_shape(const Distortion_points& points, std::span<const Point> nodes) : points_(&points)
  {
    inverses_.reserve(points.count());
    for (std::size_t q = 0; q < points.count(); ++q)
    {
      Matrix_3 j = {};
      const auto derivatives = points.at(q);
      for (std::size_t m = 0; m < nodes.size(); ++m)
        for (std::size_t r = 0; r < 3; ++r)
          for (std::size_t c = 0; c < 3; ++c)
            // Differences from the first corner: the place of the cell does not matter.
            j[3 * r + c] += (nodes[m][r] - nodes[0][r]) * derivatives[m][c];
      const Matrix_3 k = cofactors(j);
      const double inverse = 1 / determinant(j, k);
      inverses_.push_back({k[0] * inverse, k[3] * inverse, k[6] * inverse, k[1] * inverse, k[4] * inverse,
                           k[7] * inverse, k[2] * inverse, k[5] * inverse, k[8] * inverse});
    }
  }

  std::size_t point_count() const { return inverses_.size(); }
  const Matrix_3& inverse(std::size_t point) const { return inverses_[point]; }
  std::span<const std::array<double, 3>> derivatives(std::size_t point) const { return points_->at(point); }

  /// gradient of the map that displaces the nodes of the straight cell.
  Matrix_3 gradient(std::size_t point, std::span<const Point> displacements) const
  {
    Matrix_3 j = {};
    const auto d = derivatives(point);
    for (std::size_t m = 0; m < displacements.size(); ++m)
      for (std::size_t r = 0; r < 3; ++r)
        for (std::size_t c = 0; c < 3; ++c)
          j[3 * r + c] += displacements[m][r] * d[m][c];
    Matrix_3 f = product(j, inverses_[point]);
    f[0] += 1;
    f[4] += 1;
    f[8] += 1;
    return f;
  }

private:
  const Distortion_points* points_;
  std::vector<Matrix_3> inverses_;
};

} // namespace recurve::internal

#endif
