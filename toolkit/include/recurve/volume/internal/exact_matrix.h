#ifndef RECURVE_VOLUME_INTERNAL_EXACT_MATRIX_H
#define RECURVE_VOLUME_INTERNAL_EXACT_MATRIX_H

#include <recurve/volume/internal/exact_number.h>

#include <cstddef>
#include <utility>
#include <vector>

namespace recurve::internal {

/// Dense matrix of integers or fractions, by rows.
template <class Number>
struct Exact_matrix
{
  Exact_matrix() = default;
  Exact_matrix(int row_count, int column_count)
    : rows(row_count), columns(column_count),
      entries(static_cast<std::size_t>(row_count) * static_cast<std::size_t>(column_count))
  {}

  Number& operator()(int row, int column) { return entries[at(row, column)]; }
  const Number& operator()(int row, int column) const { return entries[at(row, column)]; }

  bool is_identity() const
  {
    for (int r = 0; r < rows; ++r)
      for (int c = 0; c < columns; ++c)
        if ((*this)(r, c) != (r == c ? 1 : 0))
          return false;
    return rows == columns;
  }

  int rows = 0;
  int columns = 0;
  std::vector<Number> entries;

private:
  std::size_t at(int row, int column) const
  {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column);
  }
};

using Rational_matrix = Exact_matrix<Rational>;
using Integer_matrix = Exact_matrix<Integer>;

/// A matrix of fractions with one denominator.
struct Fraction_matrix
{
  Integer_matrix numerators;
  Integer denominator = 1;
};

inline Fraction_matrix with_one_denominator(const Rational_matrix& matrix)
{
  Fraction_matrix result{Integer_matrix(matrix.rows, matrix.columns), 1};
  for (const Rational& entry : matrix.entries)
    result.denominator = lcm(result.denominator, denominator(entry));
  for (std::size_t m = 0; m < matrix.entries.size(); ++m)
    result.numerators.entries[m] = numerator(matrix.entries[m]) * (result.denominator / denominator(matrix.entries[m]));
  return result;
}

/// row `to` += factor * row `from`
inline void add_row(Rational_matrix& matrix, int to, const Rational& factor, int from)
{
  for (int c = 0; c < matrix.columns; ++c)
    if (!matrix(from, c).is_zero())
      matrix(to, c) += factor * matrix(from, c);
}

/// the inverse by Gauss and Jordan. \pre `matrix` is regular
inline Rational_matrix inverse(Rational_matrix matrix)
{
  const int n = matrix.rows;
  Rational_matrix result(n, n);
  for (int r = 0; r < n; ++r)
    result(r, r) = 1;
  for (int pivot = 0; pivot < n; ++pivot)
  {
    int row = pivot;
    while (matrix(row, pivot).is_zero())
      ++row;
    if (row != pivot)
      for (int c = 0; c < n; ++c)
      {
        std::swap(matrix(row, c), matrix(pivot, c));
        std::swap(result(row, c), result(pivot, c));
      }
    const Rational factor = 1 / matrix(pivot, pivot);
    for (int c = 0; c < n; ++c)
    {
      matrix(pivot, c) *= factor;
      result(pivot, c) *= factor;
    }
    for (int r = 0; r < n; ++r)
      if (r != pivot && !matrix(r, pivot).is_zero())
      {
        const Rational by = -matrix(r, pivot);
        add_row(matrix, r, by, pivot);
        add_row(result, r, by, pivot);
      }
  }
  return result;
}

} // namespace recurve::internal

#endif
