#ifndef RECURVE_TESTS_VOLUME_JACOBIAN_ORACLES_H
#define RECURVE_TESTS_VOLUME_JACOBIAN_ORACLES_H

#include <recurve/core/types.h>
#include <recurve/elements/basis.h>
#include <recurve/elements/node_layout.h>

#include <boost/multiprecision/cpp_int.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <span>
#include <vector>

namespace recurve::tests {

using Fraction = boost::multiprecision::cpp_rational;
using Fraction_point = std::array<Fraction, 3>;

/// the determinant of three rows.
template <class Real>
Real determinant(const std::array<std::array<Real, 3>, 3>& m)
{
  return Real(m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
              m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]));
}

/// A point of the reference element at which det J is evaluated again and again, for any nodes.
class Sample
{
public:
  Sample(Element_type type, int degree, const Reference_point& xi)
    : derivatives_(static_cast<std::size_t>(node_count(type, degree)))
  {
    lagrange_derivatives(type, degree, xi, derivatives_);
  }

  double jacobian(std::span<const Point> nodes) const
  {
    std::array<std::array<double, 3>, 3> j = {};
    for (std::size_t m = 0; m < derivatives_.size(); ++m)
      for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t d = 0; d < 3; ++d)
          j[a][d] += derivatives_[m][a] * nodes[m][d];
    return determinant(j);
  }

private:
  std::vector<std::array<double, 3>> derivatives_;
};

inline double sampled_jacobian(Element_type type, int degree, std::span<const Point> nodes, const Reference_point& xi)
{
  return Sample(type, degree, xi).jacobian(nodes);
}

/// moves a point of the unit cube into the reference element; uniform in, uniform out is not asked for. In doubles the
/// image may be outside by a rounding, where det J may be less than anywhere inside: who compares with bounds that are
/// as sharp as that has to move the point in fractions.
template <class Real>
std::array<Real, 3> into_element(Element_type type, std::array<Real, 3> p)
{
  switch (type)
  {
  case Element_type::tetrahedron:
    p[1] *= 1 - p[2];
    p[0] *= 1 - p[1] - p[2];
    break;
  case Element_type::prism: p[0] *= 1 - p[1]; break;
  case Element_type::pyramid:
    p[0] *= 1 - p[2];
    p[1] *= 1 - p[2];
    break;
  default: break;
  }
  return p;
}

inline Fraction_point fractions(const Reference_point& p)
{
  return {Fraction(p[0]), Fraction(p[1]), Fraction(p[2])};
}

/// the nearest point of the unit cube. Close to the apex of a pyramid the derivatives of rational functions lose
/// digits: the points that go there stay `apex_distance` away from it.
inline Reference_point into_cube(Element_type type, Reference_point p, double apex_distance = 1e-3)
{
  for (double& x : p)
    x = std::clamp(x, 0.0, 1.0);
  if (type == Element_type::pyramid)
    p[2] = std::min(p[2], 1 - apex_distance);
  return p;
}

/// points of the unit cube that into_element() moves to corners, to points on edges and faces, and inside; no two of
/// them to the same point.
inline std::vector<Reference_point> sample_cube(Element_type type, int per_direction, int random_count,
                                                std::mt19937& random)
{
  std::vector<Reference_point> points;
  for (int k = 0; k <= per_direction; ++k)
    for (int j = 0; j <= per_direction; ++j)
      for (int i = 0; i <= per_direction; ++i)
      {
        const double n = per_direction;
        points.push_back(into_cube(type, {i / n, j / n, k / n}));
      }
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int m = 0; m < random_count; ++m)
    points.push_back(into_cube(type, {uniform(random), uniform(random), uniform(random)}));
  const auto image = [type](const Reference_point& p) { return into_element(type, p); };
  std::ranges::sort(points, {}, image);
  const auto is_same = [&](const Reference_point& a, const Reference_point& b) { return image(a) == image(b); };
  points.erase(std::unique(points.begin(), points.end(), is_same), points.end()); // many are at collapsed corners
  return points;
}

/// corners, points on edges and faces, and points inside.
inline std::vector<Reference_point> sample_points(Element_type type, int per_direction, int random_count,
                                                  std::mt19937& random)
{
  std::vector<Reference_point> points = sample_cube(type, per_direction, random_count, random);
  for (Reference_point& p : points)
    p = into_element(type, p);
  return points;
}

/// the reference element's own nodes.
inline std::vector<Point> reference_nodes(Element_type type, int degree)
{
  std::vector<Point> nodes;
  for (const Lattice_point& l : canonical_nodes(type, degree))
    nodes.push_back({double(l[0]) / degree, double(l[1]) / degree, double(l[2]) / degree});
  return nodes;
}

/// the image of the reference element's nodes.
template <class Map>
std::vector<Point> mapped_nodes(Element_type type, int degree, Map map)
{
  std::vector<Point> nodes = reference_nodes(type, degree);
  for (Point& p : nodes)
    p = map(p);
  return nodes;
}

/// nodes of the reference element, each displaced by up to `displacement` of the distance of nodes.
inline std::vector<Point> random_cell(Element_type type, int degree, double displacement, std::mt19937& random)
{
  std::uniform_real_distribution<double> uniform(-displacement / degree, displacement / degree);
  return mapped_nodes(type, degree, [&](Point p) {
    for (double& x : p)
      x += uniform(random);
    return p;
  });
}

/// Exact derivatives of the Lagrange functions by ways of their own: on products of simplices Silvester's formula; on
/// the pyramid the functions x^i y^j z^k / (1-z)^min(i,j) of Bergot et al., of which 0 <= i, j <= p and
/// k <= p - max(i, j), and Gauss' elimination.
class Exact_oracle
{
public:
  Exact_oracle(Element_type type, int degree) : type_(type), degree_(degree), nodes_(canonical_nodes(type, degree))
  {
    if (type == Element_type::pyramid)
      invert_pyramid();
  }

  Fraction jacobian(std::span<const Point> nodes, const Fraction_point& xi) const
  {
    std::array<std::array<Fraction, 3>, 3> j = {};
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      const std::vector<Fraction> derivatives = lagrange(xi, static_cast<int>(axis));
      for (std::size_t m = 0; m < nodes.size(); ++m)
        for (std::size_t d = 0; d < 3; ++d)
          j[axis][d] += derivatives[m] * Fraction(nodes[m][d]);
    }
    return determinant(j);
  }

private:
  static Fraction power(const Fraction& x, int n)
  {
    Fraction result = 1;
    for (int m = 0; m < n; ++m)
      result *= x;
    return n < 0 ? Fraction(0) : result;
  }

  /// Silvester's polynomial of index i at t, or its derivative.
  Fraction silvester(int i, const Fraction& t, bool is_derived) const
  {
    Fraction value = 1, slope = 0;
    for (int m = 0; m < i; ++m)
    {
      const Fraction factor = (degree_ * t - m) / (m + 1);
      slope = slope * factor + value * degree_ / (m + 1);
      value *= factor;
    }
    return is_derived ? slope : value;
  }

  /// derivative of a Lagrange function of a simplex over axes first .. first + count - 1; along none if `axis` is not
  /// one of them.
  Fraction simplex(const Lattice_point& node, const Fraction_point& xi, int first, int count, int axis) const
  {
    Fraction rest = 1;
    int rest_index = degree_;
    for (int a = first; a < first + count; ++a)
    {
      rest -= xi[std::size_t(a)];
      rest_index -= node[std::size_t(a)];
    }
    const auto product = [&](int derived) {
      Fraction result = silvester(rest_index, rest, derived == -1);
      for (int a = first; a < first + count; ++a)
        result *= silvester(node[std::size_t(a)], xi[std::size_t(a)], derived == a);
      return result;
    };
    if (axis < first || axis >= first + count)
      return product(-2);
    return product(axis) - product(-1);
  }

  std::vector<Fraction> lagrange(const Fraction_point& xi, int axis) const
  {
    std::vector<Fraction> result(nodes_.size());
    if (type_ == Element_type::pyramid)
    {
      const std::vector<Fraction> functions = pyramid_functions(xi, axis);
      for (std::size_t m = 0; m < result.size(); ++m)
        for (std::size_t f = 0; f < functions.size(); ++f)
          result[m] += functions[f] * inverse_[f][m];
      return result;
    }
    for (std::size_t m = 0; m < result.size(); ++m)
      switch (type_)
      {
      case Element_type::tetrahedron: result[m] = simplex(nodes_[m], xi, 0, 3, axis); break;
      case Element_type::prism:
        result[m] = simplex(nodes_[m], xi, 0, 2, axis) * simplex(nodes_[m], xi, 2, 1, axis);
        break;
      default:
        result[m] =
          simplex(nodes_[m], xi, 0, 1, axis) * simplex(nodes_[m], xi, 1, 1, axis) * simplex(nodes_[m], xi, 2, 1, axis);
      }
    return result;
  }

  /// values (axis = -1) or derivatives of the functions that span the pyramid's space.
  std::vector<Fraction> pyramid_functions(const Fraction_point& xi, int axis) const
  {
    std::vector<Fraction> result;
    const Fraction &x = xi[0], &y = xi[1], &z = xi[2];
    for (int i = 0; i <= degree_; ++i)
      for (int j = 0; j <= degree_; ++j)
        for (int k = 0; k <= degree_ - std::max(i, j); ++k)
        {
          const int n = std::min(i, j);
          if (z == 1) // the apex; only values are asked for there
          {
            result.push_back(i == 0 && j == 0 ? 1 : 0);
            continue;
          }
          const Fraction r = 1 / power(1 - z, n), s = i == 0 ? Fraction(0) : Fraction(i * power(x, i - 1)),
                         t = j == 0 ? Fraction(0) : Fraction(j * power(y, j - 1));
          if (axis == 0)
            result.push_back(s * power(y, j) * power(z, k) * r);
          else if (axis == 1)
            result.push_back(power(x, i) * t * power(z, k) * r);
          else if (axis == 2)
            result.push_back(power(x, i) * power(y, j) * r *
                             ((k == 0 ? Fraction(0) : Fraction(k * power(z, k - 1))) + power(z, k) * n / (1 - z)));
          else
            result.push_back(power(x, i) * power(y, j) * power(z, k) * r);
        }
    return result;
  }

  /// inverse_[f][m]: coefficient of function f in the Lagrange function of node m.
  void invert_pyramid()
  {
    const std::size_t n = nodes_.size();
    std::vector<std::vector<Fraction>> rows; // of [functions at nodes | identity]
    for (std::size_t m = 0; m < n; ++m)
    {
      rows.push_back(pyramid_functions(
        {Fraction(nodes_[m][0], degree_), Fraction(nodes_[m][1], degree_), Fraction(nodes_[m][2], degree_)}, -1));
      rows.back().resize(2 * n);
      rows.back()[n + m] = 1;
    }
    for (std::size_t c = 0; c < n; ++c)
    {
      std::size_t pivot = c;
      while (rows[pivot][c] == 0)
        ++pivot;
      std::swap(rows[c], rows[pivot]);
      const Fraction factor = 1 / rows[c][c];
      for (Fraction& entry : rows[c])
        entry *= factor;
      for (std::size_t r = 0; r < n; ++r)
        if (r != c && rows[r][c] != 0)
        {
          const Fraction by = rows[r][c];
          for (std::size_t m = c; m < 2 * n; ++m)
            if (rows[c][m] != 0)
              rows[r][m] -= by * rows[c][m];
        }
    }
    for (auto& row : rows)
      inverse_.emplace_back(row.begin() + static_cast<std::ptrdiff_t>(n), row.end());
  }

  Element_type type_;
  int degree_;
  std::span<const Lattice_point> nodes_;
  std::vector<std::vector<Fraction>> inverse_;
};

/// looks for a smaller det J by steps along the axes of the unit cube that shrink, from a point of it. Returns the
/// point of the cube that into_element() moves where it is.
inline Reference_point descend(Element_type type, int degree, std::span<const Point> nodes, Reference_point cube,
                               int halvings)
{
  constexpr double apex_distance = 1e-6; // enough digits to compare, and the limit at the apex is in sight
  const auto value_at = [&](const Reference_point& p) {
    return sampled_jacobian(type, degree, nodes, into_element(type, p));
  };
  double best = value_at(cube);
  double step = 0.1;
  for (int halving = 0; halving < halvings;)
  {
    bool is_better = false;
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (const double sign : {-1.0, 1.0})
      {
        Reference_point trial = cube;
        trial[axis] += sign * step;
        trial = into_cube(type, trial, apex_distance);
        const double value = value_at(trial);
        if (value < best)
        {
          best = value;
          cube = trial;
          is_better = true;
        }
      }
    if (!is_better)
    {
      step /= 2;
      ++halving;
    }
  }
  return cube;
}

inline constexpr std::array<Element_type, 4> all_cells = {Element_type::tetrahedron, Element_type::pyramid,
                                                          Element_type::prism, Element_type::hexahedron};

} // namespace recurve::tests

#endif
