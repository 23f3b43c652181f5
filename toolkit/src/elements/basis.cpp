#include <recurve/elements/basis.h>

#include <recurve/elements/node_layout.h>

#include <Eigen/LU>

#include <algorithm>
#include <mutex>
#include <tuple>
#include <vector>

namespace recurve {

namespace {

using Gradient = std::array<double, 3>;

/// The functions of one barycentric coordinate that make up a basis, and their derivatives, of degree 0 to p.
struct Factors
{
  std::array<double, max_degree + 1> value = {};
  std::array<double, max_degree + 1> slope = {};
};

/// Silvester's polynomials R_i(t) = prod_{m<i} (p t - m) / (m + 1): zero at t = 0, 1/p, ..., (i-1)/p and one at i/p.
/// Products of them over the barycentric coordinates of a simplex are its Lagrange functions.
Factors silvester_factors(int degree, double t)
{
  Factors r;
  r.value[0] = 1;
  for (int i = 1; i <= degree; ++i)
  {
    const double factor = (degree * t - (i - 1)) / i;
    r.value[i] = r.value[i - 1] * factor;
    r.slope[i] = r.slope[i - 1] * factor + r.value[i - 1] * degree / i;
  }
  return r;
}

/// t^i / i!: products of them over the barycentric coordinates, times p!, are Bernstein's functions.
Factors power_factors(int degree, double t)
{
  Factors r;
  r.value[0] = 1;
  for (int i = 1; i <= degree; ++i)
  {
    r.value[i] = r.value[i - 1] * t / i;
    r.slope[i] = r.value[i - 1];
  }
  return r;
}

/// A simplex in one to three of the reference coordinates: factors of its own coordinates and of the one that remains.
class Simplex_basis
{
public:
  template <class MakeFactors>
  Simplex_basis(int degree, std::initializer_list<double> coordinates, MakeFactors make_factors) : degree_(degree)
  {
    double rest = 1;
    for (double t : coordinates)
    {
      own_[dimension_++] = make_factors(degree, t);
      rest -= t;
    }
    rest_ = make_factors(degree, rest);
  }

  /// the function of lattice indices i[0], ..., in the coordinates of this simplex.
  double value(const int* i) const
  {
    double product = rest_.value[remaining(i)];
    for (int axis = 0; axis < dimension_; ++axis)
      product *= own_[axis].value[i[axis]];
    return product;
  }

  double derivative(const int* i, int axis) const
  {
    double by_own = own_[axis].slope[i[axis]] * rest_.value[remaining(i)];
    double by_rest = own_[axis].value[i[axis]] * rest_.slope[remaining(i)];
    for (int other = 0; other < dimension_; ++other)
      if (other != axis)
      {
        by_own *= own_[other].value[i[other]];
        by_rest *= own_[other].value[i[other]];
      }
    return by_own - by_rest; // the remaining coordinate falls as this one grows
  }

private:
  int remaining(const int* i) const
  {
    int n = degree_;
    for (int axis = 0; axis < dimension_; ++axis)
      n -= i[axis];
    return n;
  }

  int degree_;
  int dimension_ = 0;
  std::array<Factors, 3> own_;
  Factors rest_;
};

/// The reference elements but the pyramid are products of simplices: this many, of these dimensions.
struct Simplex_product
{
  int count;
  std::array<int, 3> dimensions;
};

Simplex_product simplices_of(Element_type type)
{
  switch (type)
  {
  case Element_type::line: return {1, {1, 0, 0}};
  case Element_type::triangle: return {1, {2, 0, 0}};
  case Element_type::quadrangle: return {2, {1, 1, 0}};
  case Element_type::tetrahedron: return {1, {3, 0, 0}};
  case Element_type::prism: return {2, {2, 1, 0}};
  default: return {3, {1, 1, 1}};
  }
}

/// The factors of all simplices of a product, at one point.
class Product_basis
{
public:
  template <class MakeFactors>
  Product_basis(Element_type type, int degree, const Reference_point& xi, MakeFactors make_factors)
    : product_(simplices_of(type))
  {
    int axis = 0;
    for (int s = 0; s < product_.count; ++s)
    {
      first_axis_[s] = axis;
      switch (product_.dimensions[s])
      {
      case 1: simplices_[s] = Simplex_basis(degree, {xi[axis]}, make_factors); break;
      case 2: simplices_[s] = Simplex_basis(degree, {xi[axis], xi[axis + 1]}, make_factors); break;
      default: simplices_[s] = Simplex_basis(degree, {xi[axis], xi[axis + 1], xi[axis + 2]}, make_factors); break;
      }
      axis += product_.dimensions[s];
    }
  }

  double value(const Lattice_point& i) const
  {
    double result = 1;
    for (int s = 0; s < product_.count; ++s)
      result *= simplices_[s].value(&i[first_axis_[s]]);
    return result;
  }

  Gradient gradient(const Lattice_point& i) const
  {
    Gradient result = {};
    for (int s = 0; s < product_.count; ++s)
    {
      double others = 1;
      for (int other = 0; other < product_.count; ++other)
        if (other != s)
          others *= simplices_[other].value(&i[first_axis_[other]]);
      for (int axis = 0; axis < product_.dimensions[s]; ++axis)
        result[first_axis_[s] + axis] = others * simplices_[s].derivative(&i[first_axis_[s]], axis);
    }
    return result;
  }

private:
  static Simplex_basis none() { return Simplex_basis(0, {}, power_factors); }

  Simplex_product product_;
  std::array<int, 3> first_axis_ = {};
  std::array<Simplex_basis, 3> simplices_ = {none(), none(), none()};
};

double factorial(int n)
{
  double result = 1;
  for (int m = 2; m <= n; ++m)
    result *= m;
  return result;
}

double binomial(int n, int k)
{
  return factorial(n) / (factorial(k) * factorial(n - k));
}

double power(double base, int exponent)
{
  double result = 1;
  for (int m = 0; m < exponent; ++m)
    result *= base;
  return result;
}

/// B_i^n and its derivative at t; zero for i outside 0 .. n.
std::pair<double, double> bernstein_function(int n, int i, double t)
{
  const auto value = [t](int degree, int m) {
    return m < 0 || m > degree ? 0 : binomial(degree, m) * power(t, m) * power(1 - t, degree - m);
  };
  return {value(n, i), n == 0 ? 0 : n * (value(n - 1, i - 1) - value(n - 1, i))};
}

/// One Bernstein function of the pyramid in x, y, z, from the collapsed coordinates a = x / (1 - z), b = y / (1 - z):
/// C(p,k) z^k w^n B_i^n(a) B_j^n(b) with w = 1 - z and n = p - k. Nothing is divided by w, so that the apex is no
/// special case.
class Pyramid_function
{
public:
  Pyramid_function(int degree, const Lattice_point& ijk, const Reference_point& xi)
    : k_(ijk[2]), n_(degree - k_), z_(xi[2]), w_(1 - xi[2]), binomial_(binomial(degree, k_))
  {
    // At the apex a and b are those of the axis from the middle of the base.
    a_ = w_ != 0 ? xi[0] / w_ : 0.5;
    b_ = w_ != 0 ? xi[1] / w_ : 0.5;
    std::tie(f_, f_slope_) = bernstein_function(n_, ijk[0], a_);
    std::tie(g_, g_slope_) = bernstein_function(n_, ijk[1], b_);
  }

  double value() const { return binomial_ * power(z_, k_) * power(w_, n_) * f_ * g_; }

  Gradient gradient() const
  {
    const double scale = n_ > 0 ? binomial_ * power(z_, k_) * power(w_, n_ - 1) : 0;
    Gradient result = {scale * f_slope_ * g_, scale * f_ * g_slope_,
                       scale * (a_ * f_slope_ * g_ + b_ * f_ * g_slope_ - n_ * f_ * g_)};
    if (k_ > 0)
      result[2] += binomial_ * k_ * power(z_, k_ - 1) * power(w_, n_) * f_ * g_;
    return result;
  }

private:
  int k_, n_;
  double z_, w_, binomial_;
  double a_, b_;
  double f_, f_slope_, g_, g_slope_;
};

/// what makes a product of `power_factors` a Bernstein function: p! for each simplex.
double bernstein_scale(Element_type type, int degree)
{
  return power(factorial(degree), simplices_of(type).count);
}

using Matrix = Eigen::MatrixXd;
using Long_matrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;

Matrix bernstein_at_nodes(Element_type type, int degree)
{
  const auto nodes = canonical_nodes(type, degree);
  const auto n = static_cast<Eigen::Index>(nodes.size());
  Matrix result(n, n);
  std::vector<double> row(nodes.size());
  for (Eigen::Index m = 0; m < n; ++m)
  {
    Reference_point xi;
    for (int axis = 0; axis < 3; ++axis)
      xi[axis] = static_cast<double>(nodes[m][axis]) / degree;
    bernstein_basis(type, degree, xi, row);
    result.row(m) = Eigen::Map<const Eigen::RowVectorXd>(row.data(), n);
  }
  return result;
}

Matrix inverted(const Matrix& matrix)
{
  const Long_matrix inverse = matrix.cast<long double>().fullPivLu().inverse();
  return inverse.cast<double>();
}

/// number of the node at `point` in `type`.
int node_at(Element_type type, int degree, const Lattice_point& point)
{
  const auto nodes = canonical_nodes(type, degree);
  return static_cast<int>(std::find(nodes.begin(), nodes.end(), point) - nodes.begin());
}

/// the inverse for a product of simplices, entry by entry from the inverses of its factors: far better conditioned
/// than inverting the whole.
Matrix product_of_inverses(Element_type type, int degree)
{
  const bool has_triangle = type == Element_type::prism;
  const Matrix& line = lagrange_to_bernstein(Element_type::line, degree);
  const auto on_line = [&](int i) { return node_at(Element_type::line, degree, {i, 0, 0}); };
  const auto nodes = canonical_nodes(type, degree);
  const auto n = static_cast<Eigen::Index>(nodes.size());
  Matrix result(n, n);
  for (Eigen::Index row = 0; row < n; ++row)
    for (Eigen::Index column = 0; column < n; ++column)
    {
      const Lattice_point &r = nodes[row], &c = nodes[column];
      double entry = line(on_line(r[2]), on_line(c[2]));
      if (type == Element_type::quadrangle)
        entry = 1;
      if (has_triangle)
        entry *= lagrange_to_bernstein(Element_type::triangle,
                                       degree)(node_at(Element_type::triangle, degree, {r[0], r[1], 0}),
                                               node_at(Element_type::triangle, degree, {c[0], c[1], 0}));
      else
        entry *= line(on_line(r[0]), on_line(c[0])) * line(on_line(r[1]), on_line(c[1]));
      result(row, column) = entry;
    }
  return result;
}

Matrix make_lagrange_to_bernstein(Element_type type, int degree)
{
  const bool is_simplex_or_pyramid = simplices_of(type).count == 1 || type == Element_type::pyramid;
  return is_simplex_or_pyramid ? inverted(bernstein_at_nodes(type, degree)) : product_of_inverses(type, degree);
}

/// the collapsed cube maps onto the pyramid by (a, b, c) -> (a (1-c), b (1-c), c).
Matrix make_pyramid_to_hexahedron(int degree)
{
  const auto nodes = canonical_nodes(Element_type::hexahedron, degree);
  const int columns = node_count(Element_type::pyramid, degree);
  Matrix result(static_cast<Eigen::Index>(nodes.size()), columns);
  std::vector<double> row(columns);
  for (std::size_t m = 0; m < nodes.size(); ++m)
  {
    const double a = static_cast<double>(nodes[m][0]) / degree, b = static_cast<double>(nodes[m][1]) / degree,
                 c = static_cast<double>(nodes[m][2]) / degree;
    lagrange_basis(Element_type::pyramid, degree, {a * (1 - c), b * (1 - c), c}, row);
    result.row(static_cast<Eigen::Index>(m)) = Eigen::Map<const Eigen::RowVectorXd>(row.data(), columns);
  }
  return result;
}

/// Matrices by element and degree, each made when first asked for, by whichever thread.
class Matrix_table
{
public:
  template <class Make>
  const Matrix& get(Element_type type, int degree, Make make)
  {
    Entry& entry = entries_[static_cast<std::size_t>(type)][static_cast<std::size_t>(degree)];
    std::call_once(entry.is_made, [&] { entry.matrix = make(type, degree); });
    return entry.matrix;
  }

private:
  struct Entry
  {
    std::once_flag is_made;
    Matrix matrix;
  };
  std::array<std::array<Entry, max_degree + 1>, all_element_types.size()> entries_;
};

template <class ScalarOrGradient>
void pyramid_lagrange(int degree, std::span<const ScalarOrGradient> bernstein, std::span<ScalarOrGradient> lagrange)
{
  const Matrix& inverse = lagrange_to_bernstein(Element_type::pyramid, degree);
  for (std::size_t m = 0; m < lagrange.size(); ++m)
  {
    ScalarOrGradient sum = {};
    for (std::size_t n = 0; n < bernstein.size(); ++n)
    {
      const double c = inverse(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(m));
      if constexpr (std::is_same_v<ScalarOrGradient, double>)
        sum += c * bernstein[n];
      else
        for (int axis = 0; axis < 3; ++axis)
          sum[axis] += c * bernstein[n][axis];
    }
    lagrange[m] = sum;
  }
}

constexpr int largest_pyramid = node_count(Element_type::pyramid, max_degree);

} // namespace

void lagrange_basis(Element_type type, int degree, const Reference_point& xi, std::span<double> values)
{
  if (type == Element_type::pyramid)
  {
    std::array<double, largest_pyramid> bernstein;
    const std::span<double> used(bernstein.data(), values.size());
    bernstein_basis(type, degree, xi, used);
    pyramid_lagrange<double>(degree, used, values);
    return;
  }
  const Product_basis basis(type, degree, xi, silvester_factors);
  const auto nodes = canonical_nodes(type, degree);
  for (std::size_t m = 0; m < nodes.size(); ++m)
    values[m] = basis.value(nodes[m]);
}

void lagrange_derivatives(Element_type type, int degree, const Reference_point& xi, std::span<Gradient> derivatives)
{
  const auto nodes = canonical_nodes(type, degree);
  if (type == Element_type::pyramid)
  {
    std::array<Gradient, largest_pyramid> bernstein;
    for (std::size_t m = 0; m < nodes.size(); ++m)
      bernstein[m] = Pyramid_function(degree, nodes[m], xi).gradient();
    pyramid_lagrange<Gradient>(degree, {bernstein.data(), nodes.size()}, derivatives);
    return;
  }
  const Product_basis basis(type, degree, xi, silvester_factors);
  for (std::size_t m = 0; m < nodes.size(); ++m)
    derivatives[m] = basis.gradient(nodes[m]);
}

void bernstein_basis(Element_type type, int degree, const Reference_point& xi, std::span<double> values)
{
  const auto nodes = canonical_nodes(type, degree);
  if (type == Element_type::pyramid)
  {
    for (std::size_t m = 0; m < nodes.size(); ++m)
      values[m] = Pyramid_function(degree, nodes[m], xi).value();
    return;
  }
  const Product_basis basis(type, degree, xi, power_factors);
  const double scale = bernstein_scale(type, degree);
  for (std::size_t m = 0; m < nodes.size(); ++m)
    values[m] = scale * basis.value(nodes[m]);
}

const Eigen::MatrixXd& bernstein_to_lagrange(Element_type type, int degree)
{
  static Matrix_table table;
  return table.get(type, degree, bernstein_at_nodes);
}

const Eigen::MatrixXd& lagrange_to_bernstein(Element_type type, int degree)
{
  static Matrix_table table;
  return table.get(type, degree, make_lagrange_to_bernstein);
}

const Eigen::MatrixXd& pyramid_to_hexahedron(int degree)
{
  static Matrix_table table;
  return table.get(Element_type::pyramid, degree, [](Element_type, int p) { return make_pyramid_to_hexahedron(p); });
}

} // namespace recurve
