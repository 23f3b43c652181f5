#ifndef RECURVE_SURFACE_INTERNAL_LEAST_SQUARES_H
#define RECURVE_SURFACE_INTERNAL_LEAST_SQUARES_H

#include <recurve/surface/internal/number_pair.h>
#include <recurve/surface/local_fit.h>
#include <recurve/surface/vertex_fit.h>
#include <recurve/surface/weighted_points.h>

#include <Eigen/QR>
#include <Eigen/SVD>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace recurve::internal::surface {

inline constexpr int max_columns = coefficient_count(max_vertex_fit_degree);

/// The weighted equations of one fit, column by column; an odd number of rows is followed by one of zeros. Memory is
/// kept from fit to fit.
class Weighted_equations
{
public:
  void set(const Weighted_points& points, int degree);

  int rows() const { return rows_; }
  int columns() const { return columns_; }
  int stride() const { return stride_; }                       ///< between columns, even
  int first_coefficient() const { return first_coefficient_; } ///< coefficient of column 0
  std::uint64_t number() const { return number_; }             ///< of calls of set()
  double* column(int c) { return values_.data() + static_cast<std::size_t>(c) * static_cast<std::size_t>(stride_); }
  double* rhs() { return column(columns_); }
  double* spare() { return column(columns_ + 1); } ///< as long as a column

  /// as they were set.
  double column_length(int c) const { return lengths_[static_cast<std::size_t>(c)]; }

private:
  void set_points(const Weighted_points& points, int degree);
  void set_slopes(const Weighted_points& points, int degree);

  int rows_ = 0;
  int stride_ = 0;
  int columns_ = 0;
  int first_coefficient_ = 0;
  std::uint64_t number_ = 0;
  std::vector<double> values_;
  std::array<double, max_columns> lengths_;
};

inline double dot_product(const double* a, const double* b, int count)
{
  // Four sums at a time: the order is fixed, and the processor need not wait for each addition.
  Number_pair first = {}, second = {};
  int i = 0;
  for (; i + 4 <= count; i += 4)
  {
    first += load_pair(a + i) * load_pair(b + i);
    second += load_pair(a + i + 2) * load_pair(b + i + 2);
  }
  for (; i < count; ++i)
    first[0] += a[i] * b[i];
  const Number_pair sum = first + second;
  return sum[0] + sum[1];
}

/// writes the products of `a` and `b`.
inline void multiply(const double* a, const double* b, int count, double* products)
{
  int i = 0;
  for (; i + 2 <= count; i += 2)
    store_pair(load_pair(a + i) * load_pair(b + i), products + i);
  if (i < count)
    products[i] = a[i] * b[i];
}

inline void Weighted_equations::set(const Weighted_points& points, int degree)
{
  ++number_;
  rows_ = static_cast<int>(points.size() + 2 * points.slopes.size());
  first_coefficient_ = points.is_through_origin ? 1 : 0;
  columns_ = coefficient_count(degree) - first_coefficient_;
  stride_ = rows_ + rows_ % 2;
  const std::size_t size = static_cast<std::size_t>(stride_) * static_cast<std::size_t>(columns_ + 2);
  if (values_.size() < size)
    values_.resize(size);
  set_points(points, degree);
  if (points.slopes.size() > 0)
    set_slopes(points, degree);
  for (int c = 0; c <= columns_ && stride_ > rows_; ++c)
    column(c)[rows_] = 0;
  for (int c = 0; c < columns_; ++c)
    lengths_[static_cast<std::size_t>(c)] = std::sqrt(dot_product(column(c), column(c), rows_));
}

/// the first rows: one per height.
inline void Weighted_equations::set_points(const Weighted_points& points, int degree)
{
  const int count = static_cast<int>(points.size());
  double* const root = spare();
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
      if (p == 0)
        std::copy_n(root, count, values);
      else
        multiply(from, k == 0 ? points.u.data() : points.v.data(), count, values);
    }
}

/// the rows after them: two per slope.
inline void Weighted_equations::set_slopes(const Weighted_points& points, int degree)
{
  const Weighted_slopes& slopes = points.slopes;
  std::array<double, max_columns> monomials;
  for (std::size_t i = 0; i < slopes.size(); ++i)
  {
    const std::size_t row = points.size() + 2 * i;
    const double root = std::sqrt(slopes.weight[i]);
    rhs()[row] = root * slopes.by_u[i];
    rhs()[row + 1] = root * slopes.by_v[i];
    monomials[0] = root;
    for (int p = 0; p <= degree; ++p)
      for (int k = 0; k <= p; ++k)
      {
        const int j = p - k;
        const auto lower = [&](int a, int b) { return monomials[static_cast<std::size_t>(coefficient_number(a, b))]; };
        const int number = coefficient_number(j, k);
        if (p > 0)
          monomials[static_cast<std::size_t>(number)] =
            j > 0 ? slopes.u[i] * lower(j - 1, k) : slopes.v[i] * lower(0, k - 1);
        if (number < first_coefficient_)
          continue;
        double* const values = column(number - first_coefficient_);
        values[row] = j > 0 ? j * lower(j - 1, k) : 0;
        values[row + 1] = k > 0 ? k * lower(j, k - 1) : 0;
      }
  }
}

inline Weighted_equations& equations_of_thread()
{
  thread_local Weighted_equations equations;
  return equations;
}

/// subtracts factor * (v . a) * v from each of `Columns` columns a, which are `stride` apart. Several at a time load v
/// once. \param count  even.
template <int Columns>
void reflect(const double* v, double* first, int stride, int count, double factor)
{
  const auto column = [&](int c) { return first + static_cast<std::ptrdiff_t>(c) * stride; };
  std::array<Number_pair, Columns> sums = {};
  for (int i = 0; i < count; i += 2)
  {
    const Number_pair x = load_pair(v + i);
    for (int c = 0; c < Columns; ++c)
      sums[static_cast<std::size_t>(c)] += x * load_pair(column(c) + i);
  }
  std::array<Number_pair, Columns> amounts;
  for (std::size_t c = 0; c < Columns; ++c)
  {
    const double amount = factor * (sums[c][0] + sums[c][1]);
    amounts[c] = Number_pair{amount, amount};
  }
  for (int i = 0; i < count; i += 2)
  {
    const Number_pair x = load_pair(v + i);
    for (int c = 0; c < Columns; ++c)
      store_pair(load_pair(column(c) + i) - amounts[static_cast<std::size_t>(c)] * x, column(c) + i);
  }
}

/// the same for `columns` columns, as many at a time as the processor has registers for their sums.
inline void reflect_all(const double* v, double* first, int stride, int columns, int count, double factor)
{
  constexpr int most = 8;
  for (; columns >= most; columns -= most, first += static_cast<std::ptrdiff_t>(most) * stride)
    reflect<most>(v, first, stride, count, factor);
  switch (columns)
  {
  case 7: return reflect<7>(v, first, stride, count, factor);
  case 6: return reflect<6>(v, first, stride, count, factor);
  case 5: return reflect<5>(v, first, stride, count, factor);
  case 4: return reflect<4>(v, first, stride, count, factor);
  case 3: return reflect<3>(v, first, stride, count, factor);
  case 2: return reflect<2>(v, first, stride, count, factor);
  case 1: return reflect<1>(v, first, stride, count, factor);
  default: return;
  }
}

/// Which columns of the equations are in the triangle.
struct Triangle
{
  int size = 0;
  std::array<int, max_columns> columns; ///< entry c is the column with the diagonal entry in row c; ascending
};

/// Weights are the steeper the higher the degree; above this one even independent columns look alike when all points
/// lie on one side. The bound on what counts as independent is eased by a factor for each degree more.
inline constexpr int ordinary_degree = 8;
inline constexpr double easing_per_degree = 0.1;

/// turns the equations to triangular form. A column whose part across those before it is not longer than
/// `least_independence` times its length is left out; its rows stay as they are. On return column triangle.columns[c]
/// holds column c of R in its first rows, and the first rows of the right-hand side belong to it.
inline Triangle triangulate(Weighted_equations& equations, double least_independence)
{
  const int rows = equations.rows();
  const int columns = equations.columns();
  double* const v = equations.spare();
  Triangle triangle;
  for (int c = 0; c < columns && triangle.size < rows; ++c)
  {
    const int row = triangle.size;
    double* const pivot = equations.column(c);
    const double length = std::sqrt(dot_product(pivot + row, pivot + row, rows - row));
    if (!(length > least_independence * equations.column_length(c)))
      continue;
    const double diagonal = pivot[row] > 0 ? -length : length;
    const int first = row - row % 2; // pairs of numbers: a zero may come before Householder's vector
    for (int i = first; i < equations.stride(); i += 2)
      store_pair(load_pair(pivot + i), v + i);
    v[first] = 0;
    v[row] = pivot[row] - diagonal;
    const double factor = -1 / (diagonal * v[row]);
    reflect_all(v + first, equations.column(c + 1) + first, equations.stride(), columns - c, equations.stride() - first,
                factor);
    pivot[row] = diagonal;
    triangle.columns[static_cast<std::size_t>(triangle.size++)] = c;
  }
  return triangle;
}

inline void subtract_multiple(double factor, const double* a, int count, double* b)
{
  const Number_pair factors = {factor, factor};
  int i = 0;
  for (; i + 2 <= count; i += 2)
    store_pair(load_pair(b + i) - factors * load_pair(a + i), b + i);
  if (i < count)
    b[i] -= factor * a[i];
}

/// solves the triangular equations.
inline void substitute_back(Weighted_equations& equations, const Triangle& triangle, std::span<double> coefficients)
{
  double* const rhs = equations.rhs();
  double value = triangle.size > 0 ? rhs[triangle.size - 1] : 0;
  for (int row = triangle.size - 1; row >= 0; --row)
  {
    const int c = triangle.columns[static_cast<std::size_t>(row)];
    const double* const column = equations.column(c);
    const double x = value / column[row];
    if (row > 0)
      value = rhs[row - 1] - x * column[row - 1]; // first: the next quotient waits for it
    subtract_multiple(x, column, row - 1, rhs);
    coefficients[static_cast<std::size_t>(c + equations.first_coefficient())] = x;
  }
}

/// The triangle that a thread solved last, for lower degrees of the same equations.
struct Last_triangle
{
  Triangle triangle;
  std::uint64_t equations = 0; ///< Weighted_equations::number()
  int degree = 0;
  std::array<double, max_columns> rhs; ///< as long as the triangle
};

inline Last_triangle& last_triangle_of_thread()
{
  thread_local Last_triangle last;
  return last;
}

inline void solve_by_graded_qr(const Weighted_points& points, int degree, double least_independence,
                               std::span<double> coefficients)
{
  std::fill(coefficients.begin(), coefficients.end(), 0.0);
  Weighted_equations& equations = equations_of_thread();
  equations.set(points, degree);
  Last_triangle& last = last_triangle_of_thread();
  for (int d = ordinary_degree; d < degree; ++d)
    least_independence *= easing_per_degree;
  last.triangle = triangulate(equations, least_independence);
  last.equations = equations.number();
  last.degree = degree;
  std::copy_n(equations.rhs(), last.triangle.size, last.rhs.begin());
  substitute_back(equations, last.triangle, coefficients);
}

/// the solution of the equations that this thread solved last by `solve_by_graded_qr()`, for a lower degree. Columns
/// come by degree: what is left of the triangle is that of the lower degree, with the terms that were told apart then.
/// Not a number if there are no such equations.
inline void solve_last_for_lower_degree(int degree, std::span<double> coefficients)
{
  Weighted_equations& equations = equations_of_thread();
  const Last_triangle& last = last_triangle_of_thread();
  const bool is_known = last.equations == equations.number() && degree <= last.degree;
  std::fill(coefficients.begin(), coefficients.end(), is_known ? 0 : std::numeric_limits<double>::quiet_NaN());
  if (!is_known)
    return;
  Triangle triangle = last.triangle;
  const int columns = coefficient_count(degree) - equations.first_coefficient();
  while (triangle.size > 0 && triangle.columns[static_cast<std::size_t>(triangle.size) - 1] >= columns)
    --triangle.size;
  std::copy_n(last.rhs.begin(), triangle.size, equations.rhs());
  substitute_back(equations, triangle, coefficients);
}

/// Square matrix that needs no heap.
using Small_matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, max_columns, max_columns>;
using Small_vector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, max_columns, 1>;

/// one over the length of a column, 0 for a column of zeros.
inline double column_scaling(const Weighted_equations& equations, int c)
{
  return equations.column_length(c) > 0 ? 1 / equations.column_length(c) : 0;
}

/// applies `solve(matrix, rhs)` to the triangular form of the equations, whose size does not grow with the points; its
/// columns are scaled to the length that they had.
template <class Solve>
void solve_compressed(const Weighted_points& points, int degree, std::span<double> coefficients, const Solve& solve)
{
  std::fill(coefficients.begin(), coefficients.end(), 0.0);
  Weighted_equations& equations = equations_of_thread();
  equations.set(points, degree);
  const int columns = equations.columns();
  const Triangle triangle = triangulate(equations, 0);
  const int rows = triangle.size;
  Small_matrix matrix = Small_matrix::Zero(rows, columns);
  Small_vector rhs(rows);
  for (int i = 0; i < rows; ++i)
    rhs[i] = equations.rhs()[i];
  for (int c = 0, diagonal = 0; c < columns; ++c)
  {
    const bool is_inside = diagonal < rows && triangle.columns[static_cast<std::size_t>(diagonal)] == c;
    diagonal += is_inside ? 1 : 0; // a column that was left out ends above the diagonal
    const double scaling = column_scaling(equations, c);
    for (int i = 0; i < diagonal; ++i)
      matrix(i, c) = scaling * equations.column(c)[i];
  }
  if (rows == 0)
    return;
  const Small_vector x = solve(matrix, rhs);
  for (int c = 0; c < columns; ++c)
    coefficients[static_cast<std::size_t>(c + equations.first_coefficient())] = x[c] * column_scaling(equations, c);
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
