#ifndef RECURVE_VOLUME_INTERNAL_DERIVATIVE_FIELDS_H
#define RECURVE_VOLUME_INTERNAL_DERIVATIVE_FIELDS_H

#include <recurve/volume/internal/exact_conversion.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace recurve::internal {

/// How the Bernstein coefficients of one derivative of x come from the nodes: differences of two nodes, to which
/// matrices are applied, one along each simplex of the domain (their Kronecker product, the first factor running
/// fastest). Differences along the direction of the derivative keep its error relative to itself: the short edges of a
/// flat cell do not suffer from the long ones.
struct Derivative_field
{
  Bernstein_space space;
  std::vector<std::array<int, 2>> differences; ///< canonical numbers of nodes: first minus second
  std::vector<Rational_matrix> factors;
};

/// the three fields whose determinant is det J: the derivatives with respect to the reference coordinates. On a
/// pyramid, in the coordinates of the collapsed cube, x_a / (1 - c), x_b / (1 - c) and x_c; see
/// doc/certified_validity.md.
inline std::array<Derivative_field, 3> derivative_fields(Element_type type, int degree);

/// The derivative of a polynomial on a simplex along axis `axis`.
class Simplex_derivative
{
public:
  Simplex_derivative(int dimension, int degree, int axis)
    : axis_(static_cast<std::size_t>(axis)), nodes_(simplex_lattice(dimension, degree)),
      lattice_(simplex_lattice(dimension, degree - 1)), conversion_(simplex_conversion(dimension, degree)),
      degree_(degree)
  {}

  /// its coefficients from the differences of nodes at lattice points I + e_axis and I, I in the lattice of degree - 1.
  /// The weights of the nodes of one line along the axis have sum 0, since a function that is constant along the axis
  /// may have any value on each line; hence a difference gets the sum of the weights of all nodes beyond it.
  Rational_matrix matrix() const
  {
    const auto n = static_cast<int>(lattice_.size());
    Rational_matrix result(n, n);
    for (int row = 0; row < n; ++row)
    {
      const int upper = number_of(next(lattice_[static_cast<std::size_t>(row)]), nodes_);
      const int lower = number_of(lattice_[static_cast<std::size_t>(row)], nodes_);
      for (int column = 0; column < n; ++column)
        for (Lattice_point node = next(lattice_[static_cast<std::size_t>(column)]); is_node(node); node = next(node))
        {
          const int m = number_of(node, nodes_);
          result(row, column) += degree_ * (conversion_(upper, m) - conversion_(lower, m));
        }
    }
    return result;
  }

private:
  Lattice_point next(Lattice_point i) const
  {
    ++i[axis_];
    return i;
  }

  bool is_node(const Lattice_point& i) const { return i[0] + i[1] + i[2] <= degree_; }

  std::size_t axis_;
  std::vector<Lattice_point> nodes_, lattice_;
  Rational_matrix conversion_;
  int degree_;
};

/// the derivative along reference axis `axis` on a product of simplices.
inline Derivative_field product_field(Element_type type, int degree, int axis)
{
  const std::vector<int> dimensions = simplex_dimensions(type);
  Derivative_field field;
  std::vector<int> degrees;
  int first_axis = 0;
  for (const int dimension : dimensions)
  {
    const bool is_along = first_axis <= axis && axis < first_axis + dimension;
    degrees.push_back(is_along ? degree - 1 : degree);
    field.factors.push_back(is_along ? Simplex_derivative(dimension, degree, axis - first_axis).matrix()
                                     : simplex_conversion(dimension, degree));
    first_axis += dimension;
  }
  field.space = bernstein_space(dimensions, degrees);
  const auto nodes = canonical_nodes(type, degree);
  for (const Lattice_point& from : field.space.indices)
  {
    Lattice_point to = from;
    ++to[static_cast<std::size_t>(axis)];
    field.differences.push_back({number_of(to, nodes), number_of(from, nodes)});
  }
  return field;
}

/// The fields of a pyramid. Its map is x = sum over levels k of C(p,k) c^k (1-c)^(p-k) g_k(a, b), where g_k has degree
/// p - k in a and in b, and its Bernstein coefficients come from the nodes by `Pyramid_conversion`.
class Pyramid_fields
{
public:
  explicit Pyramid_fields(int degree)
    : degree_(degree), nodes_(canonical_nodes(Element_type::pyramid, degree)),
      conversion_(with_one_denominator(Pyramid_conversion(degree).matrix()))
  {}

  /// x_a / (1 - c) for axis 0, x_b / (1 - c) for axis 1: on level k, p times the differences of the coefficients of g_k
  /// along the axis, of degree p - k - 1 along it and p - k across, raised to p - 1 and p.
  Derivative_field across(int axis) const
  {
    std::vector<int> degrees = {degree_, degree_, degree_ - 1};
    --degrees[static_cast<std::size_t>(axis)];
    Derivative_field field{bernstein_space({1, 1, 1}, degrees), {}, {}};
    const Rational_matrix by_node = rows(field.space, [&](Level& row, int k) { row.add(k, axis, degree_); });
    take_differences(field, by_node, axis);
    return field;
  }

  /// x_c: p times the differences of consecutive levels, raised to degree p in a and b. There are no lines of nodes
  /// along c: the differences are those from node 0.
  Derivative_field upwards() const
  {
    Derivative_field field{bernstein_space({1, 1, 1}, {degree_, degree_, degree_ - 1}), {}, {}};
    const Rational_matrix by_node = rows(field.space, [&](Level& row, int k) {
      row.add(k + 1, no_axis, degree_);
      row.add(k, no_axis, -degree_);
    });
    Rational_matrix matrix(by_node.rows, by_node.columns - 1);
    for (int m = 1; m < by_node.columns; ++m)
    {
      field.differences.push_back({m, 0});
      for (int row = 0; row < by_node.rows; ++row)
        matrix(row, m - 1) = by_node(row, m);
    }
    field.factors.push_back(std::move(matrix));
    return field;
  }

private:
  static constexpr int no_axis = -1;

  /// One coefficient of a field: the weights of the nodes times the conversion's denominator and the binomials of the
  /// field's degrees, which is an integer.
  class Level
  {
  public:
    Level(const Pyramid_fields& fields, int i, int j, int a_degree, int b_degree)
      : fields_(fields), index_{i, j}, degrees_{a_degree, b_degree}, weights_(fields.nodes_.size())
    {}

    /// adds `factor` times the coefficient of g_k, or of its differences along `axis`, raised to the field's degrees.
    void add(int k, int axis, int factor)
    {
      const int n = fields_.degree_ - k;
      const std::array<int, 2> from = {axis == 0 ? n - 1 : n, axis == 1 ? n - 1 : n};
      for (int b = 0; b <= from[1]; ++b)
        for (int a = 0; a <= from[0]; ++a)
        {
          const std::int64_t weight = factor * raised(0, from[0], a) * raised(1, from[1], b);
          if (weight == 0)
            continue;
          if (axis == no_axis)
            add_coefficient(weight, {a, b, k});
          else
          {
            add_coefficient(weight, {a + (axis == 0), b + (axis == 1), k});
            add_coefficient(-weight, {a, b, k});
          }
        }
    }

    const std::vector<Integer>& weights() const { return weights_; }

    Integer denominator() const
    {
      return fields_.conversion_.denominator * binomial(degrees_[0], index_[0]) * binomial(degrees_[1], index_[1]);
    }

  private:
    /// the weight of coefficient m of degree `from` in that of the raised degree, times a binomial.
    std::int64_t raised(std::size_t axis, int from, int m) const
    {
      return binomial(from, m) * binomial(degrees_[axis] - from, index_[axis] - m);
    }

    void add_coefficient(std::int64_t weight, const Lattice_point& index)
    {
      const int f = number_of(index, fields_.nodes_);
      for (std::size_t m = 0; m < weights_.size(); ++m)
        weights_[m] += weight * fields_.conversion_.numerators(f, static_cast<int>(m));
    }

    const Pyramid_fields& fields_;
    std::array<int, 2> index_, degrees_;
    std::vector<Integer> weights_;
  };

  /// the weights of the nodes in all coefficients of a field, where `fill(row, k)` makes that of level k.
  template <class Fill>
  Rational_matrix rows(const Bernstein_space& space, Fill fill) const
  {
    Rational_matrix result(space.size(), static_cast<int>(nodes_.size()));
    for (int r = 0; r < result.rows; ++r)
    {
      const Lattice_point& index = space.indices[static_cast<std::size_t>(r)];
      Level row(*this, index[0], index[1], space.degrees[0], space.degrees[1]);
      fill(row, index[2]);
      for (int m = 0; m < result.columns; ++m)
        result(r, m) = Rational(row.weights()[static_cast<std::size_t>(m)], row.denominator());
    }
    return result;
  }

  /// replaces nodes by differences along lines of nodes, as `Simplex_derivative::matrix()` does.
  void take_differences(Derivative_field& field, const Rational_matrix& by_node, int axis) const
  {
    const auto next = [axis](Lattice_point i) {
      ++i[static_cast<std::size_t>(axis)];
      return i;
    };
    std::vector<std::vector<int>> beyond;
    for (const Lattice_point& from : nodes_)
    {
      std::vector<int> line;
      for (Lattice_point i = next(from); i[static_cast<std::size_t>(axis)] <= degree_ - i[2]; i = next(i))
        line.push_back(number_of(i, nodes_));
      if (line.empty())
        continue;
      field.differences.push_back({line.front(), number_of(from, nodes_)});
      beyond.push_back(std::move(line));
    }
    Rational_matrix matrix(by_node.rows, static_cast<int>(beyond.size()));
    for (int row = 0; row < matrix.rows; ++row)
      for (int column = 0; column < matrix.columns; ++column)
        for (const int m : beyond[static_cast<std::size_t>(column)])
          matrix(row, column) += by_node(row, m);
    field.factors.push_back(std::move(matrix));
  }

  int degree_;
  std::span<const Lattice_point> nodes_;
  Fraction_matrix conversion_;
};

inline std::array<Derivative_field, 3> derivative_fields(Element_type type, int degree)
{
  if (type != Element_type::pyramid)
    return {product_field(type, degree, 0), product_field(type, degree, 1), product_field(type, degree, 2)};
  const Pyramid_fields fields(degree);
  return {fields.across(0), fields.across(1), fields.upwards()};
}

} // namespace recurve::internal

#endif
