#ifndef RECURVE_SURFACE_INTERNAL_LEAST_SQUARES_H
#define RECURVE_SURFACE_INTERNAL_LEAST_SQUARES_H

#include <recurve/surface/local_fit.h>
#include <recurve/surface/vertex_fit.h>
#include <recurve/surface/weighted_points.h>

#include <Eigen/QR>
#include <Eigen/SVD>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace recurve::internal::surface {

inline constexpr int max_columns = coefficient_count(max_vertex_fit_degree);

/// The weighted equations of one fit, column by column, with columns of unit length. Memory is kept from fit to fit.
class Scaled_equations
{
public:
  void set(const Weighted_points& points, int degree);

  int rows() const { return rows_; }
  int columns() const { return columns_; }
  int first_coefficient() const { return first_coefficient_; } ///< coefficient of column 0
  double* column(int c) { return values_.data() + static_cast<std::size_t>(c) * static_cast<std::size_t>(rows_); }
  double* rhs() { return column(columns_); }
  double scaling(int c) const { return scaling_[static_cast<std::size_t>(c)]; } ///< 0 for a column of zeros

private:
  int rows_ = 0;
  int columns_ = 0;
  int first_coefficient_ = 0;
  std::vector<double> values_;
  std::array<double, max_columns> scaling_;
};

inline double dot_product(const double* a, const double* b, int count)
{
  // Four sums at a time: the order is fixed, and the processor need not wait for each addition.
  double s0 = 0, s1 = 0, s2 = 0, s3 = 0;
  int i = 0;
  for (; i + 4 <= count; i += 4)
  {
    s0 += a[i] * b[i];
    s1 += a[i + 1] * b[i + 1];
    s2 += a[i + 2] * b[i + 2];
    s3 += a[i + 3] * b[i + 3];
  }
  for (; i < count; ++i)
    s0 += a[i] * b[i];
  return (s0 + s2) + (s1 + s3);
}

inline void Scaled_equations::set(const Weighted_points& points, int degree)
{
  rows_ = static_cast<int>(points.size());
  first_coefficient_ = points.is_through_origin ? 1 : 0;
  columns_ = coefficient_count(degree) - first_coefficient_;
  const std::size_t size = static_cast<std::size_t>(rows_) * static_cast<std::size_t>(columns_ + 2);
  if (values_.size() < size)
    values_.resize(size);
  double* const root = column(columns_ + 1);
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    root[i] = std::sqrt(points.weight[i]);
    rhs()[i] = root[i] * points.height[i];
  }
  for (int p = 0; p <= degree; ++p)
    for (int k = 0; k <= p; ++k)
    {
      const int number = coefficient_number(p - k, k);
      if (number < first_coefficient_)
        continue;
      double* const values = column(number - first_coefficient_);
      // u^j v^k from the term of one degree less, or from the weights.
      const int lower = p == 0 ? -1 : k == 0 ? coefficient_number(p - 1, 0) : coefficient_number(p - k, k - 1);
      const double* const from = lower < first_coefficient_ ? root : column(lower - first_coefficient_);
      const double* const factor = k == 0 ? points.u.data() : points.v.data();
      for (int i = 0; i < rows_; ++i)
        values[i] = p == 0 ? root[i] : from[i] * factor[i];
    }
  for (int c = 0; c < columns_; ++c)
  {
    double* const values = column(c);
    const double norm = std::sqrt(dot_product(values, values, rows_));
    scaling_[static_cast<std::size_t>(c)] = norm > 0 ? 1 / norm : 0;
    for (int i = 0; i < rows_; ++i)
      values[i] *= scaling_[static_cast<std::size_t>(c)];
  }
}

inline Scaled_equations& equations_of_thread()
{
  thread_local Scaled_equations equations;
  return equations;
}

/// turns the equations to triangular form: on return the upper triangle of the first columns is R, and the first rows
/// of the right-hand side belong to it. \return the number of columns done: it stops at the first one whose part across
/// those before is not longer than `least_independence` (at 0 it stops only for what is not a number).
inline int triangulate(Scaled_equations& equations, double least_independence)
{
  const int rows = equations.rows();
  const int columns = equations.columns();
  int c = 0;
  for (; c < std::min(rows, columns); ++c)
  {
    double* const pivot = equations.column(c);
    const int rest = rows - c;
    const double norm = std::sqrt(dot_product(pivot + c, pivot + c, rest));
    if (norm == 0 && least_independence == 0)
      continue; // triangular already
    if (!(norm > least_independence))
      break;
    const double diagonal = pivot[c] > 0 ? -norm : norm;
    pivot[c] -= diagonal; // pivot[c...] is now Householder's vector
    const double factor = -1 / (diagonal * pivot[c]);
    for (int other = c + 1; other <= columns; ++other)
    {
      double* const values = equations.column(other);
      const double amount = factor * dot_product(pivot + c, values + c, rest);
      for (int i = c; i < rows; ++i)
        values[i] -= amount * pivot[i];
    }
    pivot[c] = diagonal;
  }
  return c;
}

/// solves the first `count` rows of the triangular equations.
inline void substitute_back(Scaled_equations& equations, int count, std::span<double> coefficients)
{
  double* const rhs = equations.rhs();
  for (int c = count - 1; c >= 0; --c)
  {
    const double* const column = equations.column(c);
    const double x = rhs[c] / column[c];
    for (int i = 0; i < c; ++i)
      rhs[i] -= x * column[i];
    coefficients[static_cast<std::size_t>(c + equations.first_coefficient())] = x * equations.scaling(c);
  }
}

inline void solve_by_graded_qr(const Weighted_points& points, int degree, double least_independence,
                               std::span<double> coefficients)
{
  std::fill(coefficients.begin(), coefficients.end(), 0.0);
  Scaled_equations& equations = equations_of_thread();
  equations.set(points, degree);
  const int done = triangulate(equations, least_independence);
  int whole = degree; // the highest degree whose terms are all there
  while (whole > 0 && coefficient_count(whole) - equations.first_coefficient() > done)
    --whole;
  if (coefficient_count(whole) - equations.first_coefficient() <= done)
    substitute_back(equations, coefficient_count(whole) - equations.first_coefficient(), coefficients);
}

/// Square matrix that needs no heap.
using Small_matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, max_columns, max_columns>;
using Small_vector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, max_columns, 1>;

/// applies `solve(matrix, rhs)` to the triangular form of the equations, whose size does not grow with the points.
template <class Solve>
void solve_compressed(const Weighted_points& points, int degree, std::span<double> coefficients, const Solve& solve)
{
  std::fill(coefficients.begin(), coefficients.end(), 0.0);
  Scaled_equations& equations = equations_of_thread();
  equations.set(points, degree);
  const int columns = equations.columns();
  const int done = triangulate(equations, 0);
  const int rows = std::min(equations.rows(), columns);
  Small_matrix matrix = Small_matrix::Zero(rows, columns);
  Small_vector rhs(rows);
  for (int i = 0; i < rows; ++i)
    rhs[i] = equations.rhs()[i];
  for (int c = 0; c < columns; ++c)
    for (int i = 0; i < (c < done ? std::min(c + 1, rows) : rows); ++i)
      matrix(i, c) = equations.column(c)[i];
  const Small_vector x = solve(matrix, rhs);
  for (int c = 0; c < columns; ++c)
    coefficients[static_cast<std::size_t>(c + equations.first_coefficient())] = x[c] * equations.scaling(c);
}

inline void solve_by_pivoted_qr(const Weighted_points& points, int degree, double relative_bound,
                                std::span<double> coefficients)
{
  solve_compressed(points, degree, coefficients, [&](const Small_matrix& matrix, const Small_vector& rhs) {
    Eigen::ColPivHouseholderQR<Small_matrix> qr(matrix.rows(), matrix.cols());
    qr.setThreshold(relative_bound);
    qr.compute(matrix);
    return Small_vector(qr.solve(rhs));
  });
}

inline void solve_by_truncated_svd(const Weighted_points& points, int degree, double relative_bound,
                                   std::span<double> coefficients)
{
  solve_compressed(points, degree, coefficients, [&](const Small_matrix& matrix, const Small_vector& rhs) {
    Eigen::JacobiSVD<Small_matrix> svd(matrix, Eigen::ComputeThinU | Eigen::ComputeThinV);
    svd.setThreshold(relative_bound);
    return Small_vector(svd.solve(rhs));
  });
}

} // namespace recurve::internal::surface

#endif
