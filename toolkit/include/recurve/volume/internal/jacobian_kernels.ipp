// Coefficients of det J for a batch of elements, one to a lane. jacobian_kernels.h includes this file once per
// instruction set, inside a namespace and under a target pragma, with RECURVE_SIMD_WIDTH doubles to a vector.
// Everything is plain IEEE arithmetic, lane by lane, so that the bits of an element depend neither on the width nor on
// its companions.

inline constexpr int width = RECURVE_SIMD_WIDTH;

typedef double Reals __attribute__((vector_size(width * sizeof(double)), aligned(sizeof(double)), may_alias));

inline Reals& reals(double* p, int number)
{
  return *reinterpret_cast<Reals*>(p + static_cast<std::ptrdiff_t>(number) * width);
}
inline const Reals& reals(const double* p, int number)
{
  return *reinterpret_cast<const Reals*>(p + static_cast<std::ptrdiff_t>(number) * width);
}

inline Reals larger(const Reals a, const Reals b)
{
  return a > b ? a : b;
}
inline Reals magnitude(const Reals a)
{
  return a < 0 ? -a : a;
}

/// Largest magnitudes in the three fields (rows), per component (columns).
struct Norms
{
  Reals of[3][3] = {};

  /// the sum over all ways to choose a row for each column: bounds the determinant of anything no larger.
  Reals permanent() const
  {
    return of[0][0] * (of[1][1] * of[2][2] + of[1][2] * of[2][1]) +
           of[0][1] * (of[1][0] * of[2][2] + of[1][2] * of[2][0]) +
           of[0][2] * (of[1][0] * of[2][1] + of[1][1] * of[2][0]);
  }
};

/// result = nodes `to` - nodes `from`; keeps the largest magnitudes, and in `poison` a NaN once a difference is not
/// finite.
inline void take_differences(const Field_table& field, const double* nodes, double* result, Reals* largest,
                             Reals& poison)
{
  for (int m = 0; m < field.difference_count(); ++m)
    for (int d = 0; d < 3; ++d)
    {
      const Reals difference = reals(nodes, 3 * field.to[static_cast<std::size_t>(m)] + d) -
                               reals(nodes, 3 * field.from[static_cast<std::size_t>(m)] + d);
      reals(result, 3 * m + d) = difference;
      largest[d] = larger(largest[d], magnitude(difference));
      poison += difference * 0.0;
    }
}

/// applies `factor` to the index of `size` / `stride` / columns runs of `stride` points. Returns the size of the
/// result.
inline int apply_factor(const Sparse_matrix& factor, int stride, int size, const double* given, double* result)
{
  const int runs = size / (stride * factor.columns);
  const int* const numbers = factor.numbers.data();
  const double* const values = factor.values.data();
  for (int run = 0; run < runs; ++run)
    for (int row = 0; row < factor.rows; ++row)
    {
      const int first = factor.row_starts[static_cast<std::size_t>(row)];
      const int last = factor.row_starts[static_cast<std::size_t>(row) + 1];
      for (int inner = 0; inner < 3 * stride; ++inner)
      {
        Reals sum = {};
        for (int m = first; m < last; ++m)
          sum += values[m] * reals(given, 3 * stride * (run * factor.columns + numbers[m]) + inner);
        reals(result, 3 * stride * (run * factor.rows + row) + inner) = sum;
      }
    }
  return runs * stride * factor.rows;
}

/// result = scaled coefficients of the field; keeps the largest magnitudes before scaling.
inline void make_field(const Field_table& field, double* differences, double* buffer, double* result, Reals* largest)
{
  int size = field.difference_count();
  double* given = differences;
  double* other = buffer;
  for (std::size_t f = 0; f < field.factors.size(); ++f)
  {
    size = apply_factor(field.factors[f], field.strides[f], size, given, other);
    std::swap(given, other);
  }
  for (int m = 0; m < size; ++m)
    for (int d = 0; d < 3; ++d)
    {
      const Reals value = reals(given, 3 * m + d);
      largest[d] = larger(largest[d], magnitude(value));
      reals(result, 3 * m + d) = value * field.multinomials[static_cast<std::size_t>(m)];
    }
}

/// cross = v x w, as polynomials.
inline void multiply_cross(const Jacobian_table& table, const double* v, const double* w, double* cross)
{
  const Field_table &first = table.fields[1], &second = table.fields[2];
  for (const int position : table.cross_positions)
    for (int d = 0; d < 3; ++d)
      reals(cross, 3 * position + d) = Reals{};
  const int* const positions = second.positions.data();
  const int count = second.size();
  for (int i = 0; i < first.size(); ++i)
  {
    const Reals x = reals(v, 3 * i), y = reals(v, 3 * i + 1), z = reals(v, 3 * i + 2);
    double* const shifted =
      cross + static_cast<std::ptrdiff_t>(3 * width) * first.positions[static_cast<std::size_t>(i)];
    for (int j = 0; j < count; ++j)
    {
      const Reals a = reals(w, 3 * j), b = reals(w, 3 * j + 1), c = reals(w, 3 * j + 2);
      double* const sum = shifted + static_cast<std::ptrdiff_t>(3 * width) * positions[j];
      reals(sum, 0) += y * c - z * b;
      reals(sum, 1) += z * a - x * c;
      reals(sum, 2) += x * b - y * a;
    }
  }
}

/// result = u . cross, as polynomials.
inline void multiply_dot(const Jacobian_table& table, const double* u, const double* cross, double* result)
{
  const Field_table& field = table.fields[0];
  for (const int position : table.positions)
    reals(result, position) = Reals{};
  const int* const positions = table.cross_positions.data();
  const auto count = static_cast<int>(table.cross_positions.size());
  for (int i = 0; i < field.size(); ++i)
  {
    const Reals x = reals(u, 3 * i), y = reals(u, 3 * i + 1), z = reals(u, 3 * i + 2);
    double* const shifted = result + static_cast<std::ptrdiff_t>(width) * field.positions[static_cast<std::size_t>(i)];
    for (int j = 0; j < count; ++j)
    {
      const int at = 3 * positions[j];
      reals(shifted, positions[j]) += x * reals(cross, at) + y * reals(cross, at + 1) + z * reals(cross, at + 2);
    }
  }
}

/// The error of all coefficients: that of the products, and that of each field times the others.
inline Reals error_bound(const Jacobian_table& table, const Norms& norms, const Norms& field_errors)
{
  Norms all = norms;
  for (int f = 0; f < 3; ++f)
    for (int d = 0; d < 3; ++d)
      all.of[f][d] += field_errors.of[f][d];
  Reals error = table.product_error * all.permanent();
  for (int f = 0; f < 3; ++f)
  {
    Norms one = all;
    for (int d = 0; d < 3; ++d)
      one.of[f][d] = field_errors.of[f][d];
    error += one.permanent();
  }
  return error_margin * error + underflow_allowance;
}

/// divides by the multinomials, in place, and finds the extremes.
inline void scan(const Jacobian_table& table, double* coefficients, const Reals error, Batch_bounds& result)
{
  Reals least = reals(coefficients, 0) * table.inverse_multinomials[0], largest = least, least_corner = least;
  for (std::size_t m = 0; m < table.positions.size(); ++m)
  {
    Reals& coefficient = reals(coefficients, table.positions[m]);
    const Reals value = coefficient * table.inverse_multinomials[m];
    coefficient = value;
    least = value < least ? value : least;
    largest = larger(largest, value);
  }
  for (const int corner : table.bisections.corners)
  {
    const Reals value = reals(coefficients, table.positions[static_cast<std::size_t>(corner)]);
    least_corner = value < least_corner ? value : least_corner;
  }
  reals(result.lower, 0) = least - error;
  reals(result.upper, 0) = largest + error;
  reals(result.reached, 0) = least_corner + error;
  reals(result.error, 0) = error;
}

/// See `Jacobian_kernel`.
inline void bound_batch(const Jacobian_table& table, const double* nodes, double* work, Batch_bounds& result)
{
  const std::ptrdiff_t buffer_size = std::ptrdiff_t(3) * width * table.buffer_size;
  double* const differences = work;
  double* const buffer = work + 3 * buffer_size;
  double* fields[3];
  fields[0] = buffer + buffer_size;
  fields[1] = fields[0] + std::ptrdiff_t(3) * width * table.fields[0].size();
  fields[2] = fields[1] + std::ptrdiff_t(3) * width * table.fields[1].size();
  double* const cross = fields[2] + std::ptrdiff_t(3) * width * table.fields[2].size();
  double* const coefficients = cross + std::ptrdiff_t(3) * width * table.position_count;

  Norms given, norms, errors;
  Reals poison = {}, extent = {};
  for (int f = 0; f < 3; ++f)
  {
    take_differences(table.fields[static_cast<std::size_t>(f)], nodes, differences + f * buffer_size, given.of[f],
                     poison);
    for (int d = 0; d < 3; ++d)
      extent = larger(extent, given.of[f][d]);
  }
  alignas(64) double inverse_units[width], extents[width];
  reals(extents, 0) = extent;
  for (int lane = 0; lane < width; ++lane)
    inverse_units[lane] = inverse_unit(extents[lane], result.exponent[lane]);
  const Reals scale = reals(inverse_units, 0);

  for (int f = 0; f < 3; ++f)
  {
    const Field_table& field = table.fields[static_cast<std::size_t>(f)];
    double* const own = differences + f * buffer_size;
    for (int m = 0; m < 3 * field.difference_count(); ++m)
      reals(own, m) *= scale;
    make_field(field, own, buffer, fields[f], norms.of[f]);
    for (int d = 0; d < 3; ++d)
      errors.of[f][d] = field.error * (given.of[f][d] * scale);
  }
  multiply_cross(table, fields[1], fields[2], cross);
  multiply_dot(table, fields[0], cross, coefficients);
  scan(table, coefficients, error_bound(table, norms, errors) + poison, result);
  result.coefficients = coefficients;
}
