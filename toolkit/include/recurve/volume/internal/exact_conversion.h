#ifndef RECURVE_VOLUME_INTERNAL_EXACT_CONVERSION_H
#define RECURVE_VOLUME_INTERNAL_EXACT_CONVERSION_H

#include <recurve/volume/internal/bernstein_space.h>
#include <recurve/volume/internal/exact_matrix.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace recurve::internal {

/// number of `point` in `points`.
template <class Points>
int number_of(const Lattice_point& point, const Points& points)
{
  return static_cast<int>(std::find(points.begin(), points.end(), point) - points.begin());
}

/// n over k; zero for k outside 0 .. n
inline std::int64_t binomial(int n, int k)
{
  return k < 0 || k > n ? 0 : static_cast<std::int64_t>(multinomial(n, {k, 0, 0}));
}

/// The Lagrange function of one node of a simplex in monomials of its barycentric coordinates t, t_0 belonging to the
/// corner at the origin: Silvester's product of (p t_a - m (t_0 + ... + t_n)) over m < i_a and all coordinates a,
/// where the bracket is 1, divided by i_0! ... i_n!. Homogeneous, hence the exponent of t_0 is not stored.
inline std::vector<std::int64_t> silvester_product(int dimension, int degree, const Lattice_point& node)
{
  const auto box = static_cast<std::size_t>(degree) + 1;
  const std::array<std::size_t, 3> strides = {1, box, box * box};
  std::vector<std::int64_t> product(box * box * box), next;
  product[0] = 1;
  int done = 0;
  const auto multiply = [&](int corner, int m) {
    next.assign(product.size(), 0);
    for (const Lattice_point& e : simplex_lattice(dimension, done))
    {
      const std::size_t at = static_cast<std::size_t>(e[0]) + strides[1] * static_cast<std::size_t>(e[1]) +
                             strides[2] * static_cast<std::size_t>(e[2]);
      next[at] += product[at] * (corner == 0 ? degree - m : -m);
      for (int d = 0; d < dimension; ++d)
        next[at + strides[static_cast<std::size_t>(d)]] += product[at] * (corner == d + 1 ? degree - m : -m);
    }
    product.swap(next);
    ++done;
  };
  const std::array<int, 4> powers = {degree - node[0] - node[1] - node[2], node[0], node[1], node[2]};
  for (int corner = 0; corner <= dimension; ++corner)
    for (int m = 0; m < powers[static_cast<std::size_t>(corner)]; ++m)
      multiply(corner, m);
  return product;
}

/// Bernstein coefficients (rows) from nodal values (columns) on a simplex, both in the order of `simplex_lattice()`. A
/// coefficient is that of the monomial divided by its multinomial.
inline Rational_matrix simplex_conversion(int dimension, int degree)
{
  const auto lattice = simplex_lattice(dimension, degree);
  const auto n = static_cast<int>(lattice.size());
  const auto box = static_cast<std::size_t>(degree) + 1;
  Rational_matrix result(n, n);
  for (int node = 0; node < n; ++node)
  {
    const Lattice_point& i = lattice[static_cast<std::size_t>(node)];
    const auto monomials = silvester_product(dimension, degree, i);
    std::int64_t factorials = 1;
    for (const int power : {degree - i[0] - i[1] - i[2], i[0], i[1], i[2]})
      for (int m = 2; m <= power; ++m)
        factorials *= m;
    for (int row = 0; row < n; ++row)
    {
      const Lattice_point& e = lattice[static_cast<std::size_t>(row)];
      const std::size_t at =
        static_cast<std::size_t>(e[0]) + box * (static_cast<std::size_t>(e[1]) + box * static_cast<std::size_t>(e[2]));
      result(row, node) = Rational(monomials[at]) / (factorials * Rational(multinomial(degree, e)));
    }
  }
  return result;
}

/// Bernstein coefficients of a pyramid (basis.h) from its nodal values, both in canonical order. Reflections of the
/// base take nodes to nodes and functions to functions, so that even and odd functions are inverted for themselves,
/// which makes the exact inversion twenty times faster.
class Pyramid_conversion
{
public:
  explicit Pyramid_conversion(int degree)
    : degree_(degree), nodes_(canonical_nodes(Element_type::pyramid, degree)),
      result_(static_cast<int>(nodes_.size()), static_cast<int>(nodes_.size()))
  {
    for (const int a_sign : {1, -1})
      for (const int b_sign : {1, -1})
        add_symmetry(a_sign, b_sign);
  }

  const Rational_matrix& matrix() const { return result_; }

private:
  /// the image of a node or function under reflections of a and b, of which `image` has one bit each.
  Lattice_point reflected(const Lattice_point& i, int image) const
  {
    const int n = degree_ - i[2];
    return {image & 1 ? n - i[0] : i[0], image & 2 ? n - i[1] : i[1], i[2]};
  }

  static Rational power(const Rational& x, int n)
  {
    Rational result = 1;
    for (; n > 0; --n)
      result *= x;
    return result;
  }

  Rational function_at_node(const Lattice_point& f, const Lattice_point& node) const
  {
    const int n = degree_ - f[2], side = degree_ - node[2];
    const Rational z = Rational(node[2]) / degree_;
    const auto on_line = [&](int i, int at) -> Rational {
      const Rational a = side == 0 ? Rational(0) : Rational(at) / side; // at the apex n = 0, or the factor below is 0
      return binomial(n, i) * power(a, i) * power(1 - a, n - i);
    };
    return binomial(degree_, f[2]) * power(z, f[2]) * power(1 - z, n) * on_line(f[0], node[0]) * on_line(f[1], node[1]);
  }

  void add_symmetry(int a_sign, int b_sign)
  {
    const std::array<int, 4> signs = {1, a_sign, b_sign, a_sign * b_sign}; // of the four images
    std::vector<Lattice_point> kept;
    for (const Lattice_point& i : nodes_)
    {
      const int a_rest = degree_ - i[2] - 2 * i[0], b_rest = degree_ - i[2] - 2 * i[1];
      if (a_rest >= (a_sign < 0 ? 1 : 0) && b_rest >= (b_sign < 0 ? 1 : 0))
        kept.push_back(i);
    }
    const auto n = static_cast<int>(kept.size());
    Rational_matrix block(n, n);
    for (int row = 0; row < n; ++row)
      for (int column = 0; column < n; ++column)
        for_each_image(kept[static_cast<std::size_t>(column)], [&](const Lattice_point& f, int image) {
          block(row, column) +=
            signs[static_cast<std::size_t>(image)] * function_at_node(f, kept[static_cast<std::size_t>(row)]);
        });
    add_inverse(inverse(std::move(block)), kept, signs);
  }

  /// calls `visit(image, its number)` for each different image of `i`.
  template <class Visit>
  void for_each_image(const Lattice_point& i, Visit visit) const
  {
    const bool is_a_fixed = 2 * i[0] == degree_ - i[2], is_b_fixed = 2 * i[1] == degree_ - i[2];
    for (int image = 0; image < 4; ++image)
      if (!(is_a_fixed && image & 1) && !(is_b_fixed && image & 2))
        visit(reflected(i, image), image);
  }

  /// What is symmetric in the function that is 1 at one node has the values sign / (number of images) at its images.
  void add_inverse(const Rational_matrix& block, const std::vector<Lattice_point>& kept,
                   const std::array<int, 4>& signs)
  {
    for (int column = 0; column < block.columns; ++column)
    {
      int images = 0;
      for_each_image(kept[static_cast<std::size_t>(column)], [&](const Lattice_point&, int) { ++images; });
      for_each_image(kept[static_cast<std::size_t>(column)], [&](const Lattice_point& node, int node_image) {
        for (int row = 0; row < block.rows; ++row)
        {
          const Rational share = block(row, column) / images;
          for_each_image(kept[static_cast<std::size_t>(row)], [&](const Lattice_point& f, int image) {
            Rational& entry = result_(number_of(f, nodes_), number_of(node, nodes_));
            if (signs[static_cast<std::size_t>(image)] == signs[static_cast<std::size_t>(node_image)])
              entry += share;
            else
              entry -= share;
          });
        }
      });
    }
  }

  int degree_;
  std::span<const Lattice_point> nodes_;
  Rational_matrix result_;
};

} // namespace recurve::internal

#endif
