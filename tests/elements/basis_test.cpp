#include <recurve/elements/basis.h>
#include <recurve/elements/node_layout.h>

#include <catch2/catch.hpp>

#include <random>
#include <vector>

using namespace recurve;

namespace {

constexpr unsigned seed = 20261;

/// a random point of the reference element, off its boundary.
Reference_point random_point(Element_type type, std::mt19937& random)
{
  std::uniform_real_distribution<double> uniform(0.02, 0.98);
  for (;;)
  {
    Reference_point x = {uniform(random), uniform(random), uniform(random)};
    const int dimension = reference_element(type).dimension;
    for (int axis = dimension; axis < 3; ++axis)
      x[axis] = 0;
    const bool is_inside = type == Element_type::triangle || type == Element_type::prism ? x[0] + x[1] < 0.98
                           : type == Element_type::tetrahedron                           ? x[0] + x[1] + x[2] < 0.98
                           : type == Element_type::pyramid ? std::max(x[0], x[1]) + x[2] < 0.98
                                                           : true;
    if (is_inside)
      return x;
  }
}

Reference_point node_position(Element_type type, int degree, int node)
{
  const Lattice_point& i = canonical_nodes(type, degree)[node];
  return {double(i[0]) / degree, double(i[1]) / degree, double(i[2]) / degree};
}

std::vector<double> lagrange(Element_type type, int degree, const Reference_point& x)
{
  std::vector<double> values(node_count(type, degree));
  lagrange_basis(type, degree, x, values);
  return values;
}

std::vector<std::array<double, 3>> gradients(Element_type type, int degree, const Reference_point& x)
{
  std::vector<std::array<double, 3>> values(node_count(type, degree));
  lagrange_derivatives(type, degree, x, values);
  return values;
}

/// x^i y^j z^k and its derivative along an axis.
double monomial(const Reference_point& x, const std::array<int, 3>& e)
{
  return std::pow(x[0], e[0]) * std::pow(x[1], e[1]) * std::pow(x[2], e[2]);
}

double monomial_slope(const Reference_point& x, std::array<int, 3> e, int axis)
{
  const int n = e[axis];
  if (n == 0)
    return 0;
  --e[axis];
  return n * monomial(x, e);
}

/// exponents of the polynomials that the element holds; of the pyramid those of total degree <= p.
std::vector<std::array<int, 3>> exponents(Element_type type, int degree)
{
  std::vector<std::array<int, 3>> result;
  const int dimension = reference_element(type).dimension;
  for (int k = 0; k <= (dimension > 2 ? degree : 0); ++k)
    for (int j = 0; j <= (dimension > 1 ? degree : 0); ++j)
      for (int i = 0; i <= degree; ++i)
      {
        const bool is_held = type == Element_type::triangle || type == Element_type::prism        ? i + j <= degree
                             : type == Element_type::tetrahedron || type == Element_type::pyramid ? i + j + k <= degree
                                                                                                  : true;
        if (is_held)
          result.push_back({i, j, k});
      }
  return result;
}

} // namespace

TEST_CASE("a Lagrange function is one at its node and zero at the others")
{
  const int degree = GENERATE(1, 2, 3, 4, 5, 6);
  for (Element_type type : all_element_types)
    for (int n = 0; n < node_count(type, degree); ++n)
    {
      const std::vector<double> values = lagrange(type, degree, node_position(type, degree, n));
      double error = 0;
      for (int m = 0; m < node_count(type, degree); ++m)
        error = std::max(error, std::abs(values[m] - (m == n)));
      CAPTURE(element_name(type), degree, n);
      REQUIRE(error < 1e-13);
    }
}

TEST_CASE("Lagrange interpolation and its derivatives are exact for the polynomials that the element holds")
{
  const int degree = GENERATE(1, 2, 3, 4, 5, 6);
  std::mt19937 random(seed);
  for (Element_type type : all_element_types)
  {
    const Reference_point x = random_point(type, random);
    const std::vector<double> values = lagrange(type, degree, x);
    const auto slopes = gradients(type, degree, x);
    for (const auto& e : exponents(type, degree))
    {
      double value = 0;
      std::array<double, 3> slope = {};
      for (int n = 0; n < node_count(type, degree); ++n)
      {
        const double f = monomial(node_position(type, degree, n), e);
        value += f * values[n];
        for (int axis = 0; axis < 3; ++axis)
          slope[axis] += f * slopes[n][axis];
      }
      CAPTURE(element_name(type), degree, seed, e[0], e[1], e[2]);
      REQUIRE(value == Approx(monomial(x, e)).margin(1e-12));
      for (int axis = 0; axis < reference_element(type).dimension; ++axis)
        REQUIRE(slope[axis] == Approx(monomial_slope(x, e, axis)).margin(1e-11));
    }
  }
}

TEST_CASE("derivatives of the pyramid's rational functions are those of central differences")
{
  const int degree = GENERATE(1, 2, 3, 4, 5, 6);
  const Reference_point x = {0.21, 0.17, 0.33};
  constexpr double h = 1e-5;
  const auto slopes = gradients(Element_type::pyramid, degree, x);
  for (int axis = 0; axis < 3; ++axis)
  {
    Reference_point up = x, down = x;
    up[axis] += h;
    down[axis] -= h;
    const auto a = lagrange(Element_type::pyramid, degree, up), b = lagrange(Element_type::pyramid, degree, down);
    for (std::size_t n = 0; n < a.size(); ++n)
      REQUIRE(slopes[n][axis] == Approx((a[n] - b[n]) / (2 * h)).margin(1e-6));
  }
}

TEST_CASE("at the pyramid's apex the derivatives are the limit along the axis")
{
  const int degree = GENERATE(1, 2, 3);
  const auto at_apex = gradients(Element_type::pyramid, degree, {0, 0, 1});
  constexpr double w = 1e-7;
  const auto beside = gradients(Element_type::pyramid, degree, {0.5 * w, 0.5 * w, 1 - w});
  for (std::size_t n = 0; n < at_apex.size(); ++n)
    for (int axis = 0; axis < 3; ++axis)
      CHECK(at_apex[n][axis] == Approx(beside[n][axis]).margin(1e-5));
}

TEST_CASE("on a face, the functions of a cell are those of the face: neighbours of any type conform")
{
  const int degree = GENERATE(1, 2, 3, 4, 5, 6);
  std::mt19937 random(seed);
  for (Element_type type : all_element_types)
  {
    const Reference_element& element = reference_element(type);
    for (int f = 0; f < element.face_count; ++f)
    {
      const Reference_face& face = element.faces[f];
      const Reference_point uv = random_point(face.type, random);
      const auto &a = element.corners[face.corners[0]], &b = element.corners[face.corners[1]],
                 &c = element.corners[face.corners[face.corner_count - 1]];
      Reference_point x;
      for (int axis = 0; axis < 3; ++axis)
        x[axis] = a[axis] + uv[0] * (b[axis] - a[axis]) + uv[1] * (c[axis] - a[axis]);
      std::vector<double> expected(node_count(type, degree), 0.0);
      const std::vector<double> on_face = lagrange(face.type, degree, uv);
      for (std::size_t m = 0; m < on_face.size(); ++m)
        expected[face_nodes(type, degree, f)[m]] = on_face[m];
      const std::vector<double> values = lagrange(type, degree, x);
      CAPTURE(element_name(type), degree, f, seed);
      for (std::size_t n = 0; n < values.size(); ++n)
        REQUIRE(values[n] == Approx(expected[n]).margin(1e-12));
    }
  }
}

TEST_CASE("Bernstein functions are not negative and add up to one")
{
  const int degree = GENERATE(1, 2, 3, 4, 5, 6);
  std::mt19937 random(seed);
  for (Element_type type : all_element_types)
  {
    std::vector<double> values(node_count(type, degree));
    bernstein_basis(type, degree, random_point(type, random), values);
    double sum = 0;
    for (double value : values)
    {
      REQUIRE(value >= 0);
      sum += value;
    }
    CAPTURE(element_name(type), degree, seed);
    REQUIRE(sum == Approx(1).epsilon(1e-14));
  }
}

TEST_CASE("converted to Bernstein coefficients, a function keeps its values, and the conversion back is its inverse")
{
  const int degree = GENERATE(1, 2, 3, 4, 5, 6);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (Element_type type : all_element_types)
  {
    const int n = node_count(type, degree);
    Eigen::VectorXd nodal(n);
    for (int m = 0; m < n; ++m)
      nodal[m] = uniform(random);
    const Eigen::VectorXd coefficients = lagrange_to_bernstein(type, degree) * nodal;
    CAPTURE(element_name(type), degree, seed);
    REQUIRE((bernstein_to_lagrange(type, degree) * coefficients - nodal).cwiseAbs().maxCoeff() < 1e-11);
    const Reference_point x = random_point(type, random);
    std::vector<double> bernstein(n);
    bernstein_basis(type, degree, x, bernstein);
    const std::vector<double> values = lagrange(type, degree, x);
    double by_lagrange = 0, by_bernstein = 0;
    for (int m = 0; m < n; ++m)
    {
      by_lagrange += nodal[m] * values[m];
      by_bernstein += coefficients[m] * bernstein[m];
    }
    REQUIRE(by_bernstein == Approx(by_lagrange).margin(1e-10));
  }
}

TEST_CASE("a pyramid as a collapsed hexahedron is the same curved cell at every point")
{
  const int degree = GENERATE(1, 2, 3, 4, 5, 6);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Eigen::VectorXd nodal(node_count(Element_type::pyramid, degree));
  for (Eigen::Index m = 0; m < nodal.size(); ++m)
    nodal[m] = uniform(random);
  const Eigen::VectorXd collapsed = pyramid_to_hexahedron(degree) * nodal;
  for (int sample = 0; sample < 20; ++sample)
  {
    const Reference_point abc = random_point(Element_type::hexahedron, random);
    const std::vector<double> hexahedron = lagrange(Element_type::hexahedron, degree, abc);
    const std::vector<double> pyramid =
      lagrange(Element_type::pyramid, degree, {abc[0] * (1 - abc[2]), abc[1] * (1 - abc[2]), abc[2]});
    const double expected = Eigen::Map<const Eigen::VectorXd>(pyramid.data(), nodal.size()).dot(nodal);
    CAPTURE(degree, seed);
    CHECK(Eigen::Map<const Eigen::VectorXd>(hexahedron.data(), collapsed.size()).dot(collapsed) ==
          Approx(expected).margin(1e-11));
  }
}
