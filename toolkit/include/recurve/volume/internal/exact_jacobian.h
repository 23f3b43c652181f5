#ifndef RECURVE_VOLUME_INTERNAL_EXACT_JACOBIAN_H
#define RECURVE_VOLUME_INTERNAL_EXACT_JACOBIAN_H

#include <recurve/core/types.h>
#include <recurve/volume/internal/jacobian_table.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace recurve::internal {

/// A `Derivative_field` in integers: coefficients times a denominator.
struct Exact_field
{
  std::vector<std::array<int, 2>> differences;
  std::vector<Integer_matrix> factors;
  std::vector<Integer> multinomials;
};

/// What exact evaluation needs beside the `Jacobian_table`.
struct Exact_table
{
  std::array<Exact_field, 3> fields;
  std::vector<Integer> weights; ///< least common multiple of all multinomials of det J, divided by each
  Integer denominator = 1;      ///< of the coefficients
};

inline Exact_table make_exact_table(Element_type type, int degree)
{
  Exact_table table;
  const auto fields = derivative_fields(type, degree);
  for (std::size_t f = 0; f < 3; ++f)
  {
    Exact_field& field = table.fields[f];
    field.differences = fields[f].differences;
    for (const Rational_matrix& factor : fields[f].factors)
    {
      Fraction_matrix integers = with_one_denominator(factor);
      table.denominator *= integers.denominator;
      field.factors.push_back(std::move(integers.numerators));
    }
    for (const double m : fields[f].space.multinomials)
      field.multinomials.push_back(static_cast<Integer>(m));
  }
  const Bernstein_space all = product_space(fields[0].space, product_space(fields[1].space, fields[2].space));
  Integer multiple = 1;
  for (const double m : all.multinomials)
    multiple = lcm(multiple, static_cast<Integer>(m));
  for (const double m : all.multinomials)
    table.weights.push_back(multiple / static_cast<Integer>(m));
  table.denominator *= multiple;
  return table;
}

inline const Exact_table& exact_table(Element_type type, int degree)
{
  static Table_store<Exact_table> store;
  return store.get(type, degree, make_exact_table);
}

/// The coefficients of det J of one element as integers. The steps are those of jacobian_kernels.ipp.
class Exact_jacobian
{
public:
  /// \pre the nodes are finite, as many as the type and degree have
  Exact_jacobian(const Jacobian_table& table, std::span<const Point> nodes)
    : table_(table), exact_(exact_table(table.type, table.degree))
  {
    set_nodes(nodes);
    std::array<std::vector<Integer>, 3> fields;
    for (std::size_t f = 0; f < 3; ++f)
      fields[f] = field(exact_.fields[f]);
    const std::vector<Integer> cross = multiply_cross(fields[1], fields[2]);
    multiply_dot(fields[0], cross);
  }

  /// det J = coefficient * 2^(3 exponent) * 2^-shift / denominator.
  const std::vector<Integer>& coefficients() const { return coefficients_; }
  int exponent() const { return largest_exponent_; }
  int shift() const { return 3 * (largest_exponent_ - least_exponent_); }
  const Integer& denominator() const { return exact_.denominator; }

private:
  void set_nodes(std::span<const Point> nodes)
  {
    least_exponent_ = std::numeric_limits<int>::max();
    for (const Point& p : nodes)
      for (const double x : p)
        if (x != 0)
          least_exponent_ = std::min(least_exponent_, binary_number(x).exponent);
    if (least_exponent_ == std::numeric_limits<int>::max())
      least_exponent_ = 0;
    largest_exponent_ = least_exponent_;
    for (const Point& p : nodes)
      for (const double x : p)
      {
        const Binary_number number = binary_number(x);
        nodes_.push_back(x == 0 ? Integer(0) : Integer(number.mantissa) << (number.exponent - least_exponent_));
      }
  }

  std::vector<Integer> field(const Exact_field& field)
  {
    std::vector<Integer> values;
    for (const auto& [to, from] : field.differences)
      for (int d = 0; d < 3; ++d)
      {
        values.push_back(nodes_[static_cast<std::size_t>(3 * to + d)] - nodes_[static_cast<std::size_t>(3 * from + d)]);
        if (!values.back().is_zero())
          largest_exponent_ = std::max(largest_exponent_, least_exponent_ + static_cast<int>(msb(abs(values.back()))));
      }
    std::size_t stride = 3;
    for (const Integer_matrix& factor : field.factors)
    {
      values = applied(factor, stride, values);
      stride *= static_cast<std::size_t>(factor.rows);
    }
    for (std::size_t m = 0; m < values.size(); ++m)
      values[m] *= field.multinomials[m / 3];
    return values;
  }

  static std::vector<Integer> applied(const Integer_matrix& factor, std::size_t stride,
                                      const std::vector<Integer>& given)
  {
    const auto rows = static_cast<std::size_t>(factor.rows), columns = static_cast<std::size_t>(factor.columns);
    const std::size_t runs = given.size() / (stride * columns);
    std::vector<Integer> result(runs * rows * stride);
    for (std::size_t run = 0; run < runs; ++run)
      for (std::size_t r = 0; r < rows; ++r)
        for (std::size_t c = 0; c < columns; ++c)
        {
          const Integer& entry = factor(static_cast<int>(r), static_cast<int>(c));
          if (entry.is_zero())
            continue;
          for (std::size_t inner = 0; inner < stride; ++inner)
            result[stride * (run * rows + r) + inner] += entry * given[stride * (run * columns + c) + inner];
        }
    return result;
  }

  std::vector<Integer> multiply_cross(const std::vector<Integer>& v, const std::vector<Integer>& w) const
  {
    const auto &first = table_.fields[1].positions, &second = table_.fields[2].positions;
    std::vector<Integer> cross(3 * static_cast<std::size_t>(table_.position_count));
    for (std::size_t i = 0; i < first.size(); ++i)
      for (std::size_t j = 0; j < second.size(); ++j)
      {
        Integer* const sum = cross.data() + 3 * static_cast<std::size_t>(first[i] + second[j]);
        for (std::size_t d = 0; d < 3; ++d)
        {
          const std::size_t e = (d + 1) % 3, f = (d + 2) % 3;
          sum[d] += v[3 * i + e] * w[3 * j + f];
          sum[d] -= v[3 * i + f] * w[3 * j + e];
        }
      }
    return cross;
  }

  void multiply_dot(const std::vector<Integer>& u, const std::vector<Integer>& cross)
  {
    const auto& first = table_.fields[0].positions;
    std::vector<Integer> box(static_cast<std::size_t>(table_.position_count));
    for (std::size_t i = 0; i < first.size(); ++i)
      for (const int position : table_.cross_positions)
        for (std::size_t d = 0; d < 3; ++d)
          box[static_cast<std::size_t>(first[i] + position)] +=
            u[3 * i + d] * cross[3 * static_cast<std::size_t>(position) + d];
    coefficients_.reserve(table_.positions.size());
    for (std::size_t m = 0; m < table_.positions.size(); ++m)
      coefficients_.push_back(box[static_cast<std::size_t>(table_.positions[m])] * exact_.weights[m]);
  }

  const Jacobian_table& table_;
  const Exact_table& exact_;
  std::vector<Integer> nodes_, coefficients_;
  int least_exponent_ = 0, largest_exponent_ = 0;
};

} // namespace recurve::internal

#endif
