#ifndef RECURVE_VOLUME_INTERNAL_JACOBIAN_TABLE_H
#define RECURVE_VOLUME_INTERNAL_JACOBIAN_TABLE_H

#include <recurve/volume/internal/bernstein_bisection.h>
#include <recurve/volume/internal/derivative_fields.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <memory>
#include <mutex>
#include <vector>

namespace recurve::internal {

/// Half the distance of 1 from the next double: relative error of one operation rounded to nearest.
inline constexpr double unit_roundoff = std::numeric_limits<double>::epsilon() / 2;

/// A bound of the relative error of `n` operations in a row: n u / (1 - n u), here for n u < 1e-6.
inline constexpr double rounding_error(int n)
{
  return n * unit_roundoff * (1 + 1e-6);
}

/// A small matrix without its zeros, by rows.
struct Sparse_matrix
{
  int rows = 0;
  int columns = 0;
  std::vector<int> row_starts; ///< in the following, and their end
  std::vector<int> numbers;    ///< of columns
  std::vector<double> values;
};

/// A `Derivative_field` in doubles.
struct Field_table
{
  std::vector<int> to, from;          ///< nodes of the differences
  std::vector<Sparse_matrix> factors; ///< identities are left out
  std::vector<int> strides;           ///< per factor: number of entries that the simplices before it make together
  std::vector<double> multinomials;   ///< by which the coefficients are scaled
  std::vector<int> positions;         ///< of the coefficients; see `Jacobian_table`
  double error = 0; ///< largest error of a coefficient before scaling, relative to the largest difference

  int difference_count() const { return static_cast<int>(to.size()); }
  int size() const { return static_cast<int>(positions.size()); }
};

/// All that det J of an element type and degree needs and that does not depend on the nodes. Coefficients of all
/// factors and products are kept at positions of one box of indices, so that the positions of a product are the sums of
/// those of its factors.
struct Jacobian_table
{
  Element_type type = Element_type::tetrahedron;
  int degree = 1;
  int node_count = 4;
  std::array<Field_table, 3> fields;
  std::vector<int> cross_positions;         ///< of the product of fields 1 and 2
  std::vector<int> positions;               ///< of det J
  std::vector<double> inverse_multinomials; ///< of det J; rounded
  int position_count = 0;                   ///< of the box
  int buffer_size = 0;                      ///< numbers that a field needs while its factors are applied
  double product_error = 0; ///< largest error of a coefficient of det J, from the products, relative to the permanent
                            ///< of the fields' largest coefficients
  Bisection_table bisections;
};

class Jacobian_table_builder
{
public:
  static Jacobian_table build(Element_type type, int degree)
  {
    Jacobian_table table;
    table.type = type;
    table.degree = degree;
    table.node_count = node_count(type, degree);
    const auto fields = derivative_fields(type, degree);
    const Bernstein_space cross = product_space(fields[1].space, fields[2].space);
    const Bernstein_space all = product_space(fields[0].space, cross);
    const std::array<int, 3> degrees = all.axis_degrees();
    table.position_count = (degrees[0] + 1) * (degrees[1] + 1) * (degrees[2] + 1);
    for (std::size_t f = 0; f < 3; ++f)
    {
      table.fields[f] = field_table(fields[f], degrees);
      table.buffer_size = std::max({table.buffer_size, table.fields[f].difference_count(), buffer_size(fields[f])});
    }
    table.cross_positions = positions(cross, degrees);
    table.positions = positions(all, degrees);
    for (const double m : all.multinomials)
      table.inverse_multinomials.push_back(1 / m);
    table.product_error = product_error(fields, cross);
    table.bisections = Bisection_table_builder(all).table();
    return table;
  }

private:
  static std::vector<int> positions(const Bernstein_space& space, const std::array<int, 3>& degrees)
  {
    std::vector<int> result;
    for (const Lattice_point& i : space.indices)
      result.push_back(i[0] + (degrees[0] + 1) * (i[1] + (degrees[1] + 1) * i[2]));
    return result;
  }

  static Sparse_matrix sparse(const Rational_matrix& matrix)
  {
    Sparse_matrix result{matrix.rows, matrix.columns, {0}, {}, {}};
    for (int r = 0; r < matrix.rows; ++r)
    {
      for (int c = 0; c < matrix.columns; ++c)
        if (!matrix(r, c).is_zero())
        {
          result.numbers.push_back(c);
          result.values.push_back(to_double(matrix(r, c)));
        }
      result.row_starts.push_back(static_cast<int>(result.numbers.size()));
    }
    return result;
  }

  /// largest sum of the magnitudes in a row.
  static double row_norm(const Sparse_matrix& matrix)
  {
    double largest = 0;
    for (std::size_t r = 0; r + 1 < matrix.row_starts.size(); ++r)
    {
      double sum = 0;
      for (int m = matrix.row_starts[r]; m < matrix.row_starts[r + 1]; ++m)
        sum += std::abs(matrix.values[static_cast<std::size_t>(m)]);
      largest = std::max(largest, sum);
    }
    return largest;
  }

  /// The difference is rounded once. A factor of n columns rounds n products and n - 1 sums, each term n times, and its
  /// entries have an error of `conversion_error`, 4 u; errors are carried on by the later factors, at most by their
  /// norms.
  static Field_table field_table(const Derivative_field& field, const std::array<int, 3>& degrees)
  {
    Field_table table;
    for (const auto& [to, from] : field.differences)
    {
      table.to.push_back(to);
      table.from.push_back(from);
    }
    int stride = 1, operations = 1;
    double norm = 1;
    for (const Rational_matrix& factor : field.factors)
    {
      if (!factor.is_identity())
      {
        table.factors.push_back(sparse(factor));
        table.strides.push_back(stride);
        norm *= row_norm(table.factors.back());
        operations += factor.columns + 4;
      }
      stride *= factor.rows;
    }
    constexpr double norm_rounding = 1 + 1e-10; // of the norms computed here
    table.error = rounding_error(operations) * norm * norm_rounding;
    table.multinomials = field.space.multinomials;
    table.positions = positions(field.space, degrees);
    return table;
  }

  /// What stands between the factors: rows of those applied, columns of the others.
  static int buffer_size(const Derivative_field& field)
  {
    int largest = 0;
    for (std::size_t applied = 0; applied <= field.factors.size(); ++applied)
    {
      int size = 1;
      for (std::size_t f = 0; f < field.factors.size(); ++f)
        size *= f < applied ? field.factors[f].rows : field.factors[f].columns;
      largest = std::max(largest, size);
    }
    return largest;
  }

  /// Each term u_I v_J w_K of a coefficient is rounded when its three factors are scaled (3), multiplied (2),
  /// subtracted (1) and summed with the others of its sum, at most as many as the smaller factor has coefficients (+2
  /// for the three components), and when the sum is divided by its multinomial (2). One more for the comparison with
  /// the bound.
  static double product_error(const std::array<Derivative_field, 3>& fields, const Bernstein_space& cross)
  {
    const int cross_terms = std::min(fields[1].space.size(), fields[2].space.size());
    const int terms = std::min(fields[0].space.size(), cross.size());
    return rounding_error(3 + 2 + 1 + cross_terms + terms + 2 + 2 + 1);
  }
};

/// Tables by type and degree, each made when first asked for, by whichever thread.
template <class Table>
class Table_store
{
public:
  template <class Build>
  const Table& get(Element_type type, int degree, Build build)
  {
    Entry& entry = entries_[static_cast<std::size_t>(type)][static_cast<std::size_t>(degree)];
    std::call_once(entry.is_made, [&] { entry.table = std::make_unique<Table>(build(type, degree)); });
    return *entry.table;
  }

private:
  struct Entry
  {
    std::once_flag is_made;
    std::unique_ptr<Table> table;
  };
  std::array<std::array<Entry, max_degree + 1>, all_element_types.size()> entries_;
};

/// \pre `type` is a cell, 1 <= degree <= max_degree
inline const Jacobian_table& jacobian_table(Element_type type, int degree)
{
  static Table_store<Jacobian_table> store;
  return store.get(type, degree, Jacobian_table_builder::build);
}

} // namespace recurve::internal

#endif
