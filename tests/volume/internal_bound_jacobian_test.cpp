#include <recurve/volume/internal/jacobian_bounder.h>

#include <volume/jacobian_oracles.h>

#include <catch2/catch.hpp>

#include <random>

using namespace recurve;
using namespace recurve::internal;
using namespace recurve::tests;

namespace {

/// the value at `at` (coordinates of the domain: on a pyramid those of the cube) of a polynomial from its exact
/// Bernstein coefficients.
Fraction bernstein_value(const Bernstein_space& space, const std::vector<Fraction>& coefficients,
                         const Fraction_point& at)
{
  Fraction sum = 0;
  for (std::size_t m = 0; m < coefficients.size(); ++m)
  {
    Fraction term = coefficients[m] * Fraction(space.multinomials[m]);
    std::size_t axis = 0;
    for (std::size_t s = 0; s < space.dimensions.size(); ++s)
    {
      Fraction rest = 1;
      int rest_index = space.degrees[s];
      for (int d = 0; d < space.dimensions[s]; ++d, ++axis)
      {
        rest -= at[axis];
        rest_index -= space.indices[m][axis];
        for (int n = 0; n < space.indices[m][axis]; ++n)
          term *= at[axis];
      }
      for (int n = 0; n < rest_index; ++n)
        term *= rest;
    }
    sum += term;
  }
  return sum;
}

Bernstein_space jacobian_space(Element_type type, int degree)
{
  const auto fields = derivative_fields(type, degree);
  return product_space(fields[0].space, product_space(fields[1].space, fields[2].space));
}

std::vector<Fraction> exact_coefficients(const Exact_jacobian& jacobian)
{
  std::vector<Fraction> result;
  for (const Integer& c : jacobian.coefficients())
  {
    Fraction value(c, jacobian.denominator());
    const int exponent = 3 * jacobian.exponent() - jacobian.shift();
    value *= exponent >= 0 ? Fraction(Integer(1) << exponent) : Fraction(Integer(1), Integer(1) << -exponent);
    result.push_back(value);
  }
  return result;
}

/// points inside the domain, none of them special.
std::vector<Fraction_point> inner_points(Element_type type)
{
  std::vector<Fraction_point> points = {{Fraction(1, 7), Fraction(2, 9), Fraction(3, 11)},
                                        {Fraction(1, 3), Fraction(1, 5), Fraction(1, 13)},
                                        {Fraction(1, 10), Fraction(1, 4), Fraction(3, 7)}};
  if (type != Element_type::tetrahedron)
    points.push_back({Fraction(2, 9), Fraction(2, 3), Fraction(9, 10)});
  return points;
}

} // namespace

TEST_CASE("coefficients of det J are exact in integers", "[volume]")
{
  const Element_type type = GENERATE(from_range(all_cells));
  const int degree = GENERATE(1, 2, 3, 4);
  CAPTURE(element_name(type), degree);
  std::mt19937 random(1);
  const std::vector<Point> nodes = random_cell(type, degree, 0.3, random);
  const Exact_jacobian jacobian(jacobian_table(type, degree), nodes);
  const std::vector<Fraction> coefficients = exact_coefficients(jacobian);
  const Bernstein_space space = jacobian_space(type, degree);
  const Exact_oracle oracle(type, degree);
  for (const Fraction_point& p : inner_points(type))
  {
    // On a pyramid the coefficients are those of the quotient Q on the cube, which is det J at the image of the point.
    Fraction_point at = p;
    if (type == Element_type::pyramid)
      at = {p[0] * (1 - p[2]), p[1] * (1 - p[2]), p[2]};
    CHECK(bernstein_value(space, coefficients, p) == oracle.jacobian(nodes, at));
  }
}

TEST_CASE("degrees of det J", "[volume]")
{
  for (int p = 1; p <= max_degree; ++p)
  {
    const auto size = [p](Element_type type) { return static_cast<int>(jacobian_table(type, p).positions.size()); };
    const int n = 3 * (p - 1);
    CHECK(size(Element_type::tetrahedron) == (n + 1) * (n + 2) * (n + 3) / 6);
    CHECK(size(Element_type::prism) == (3 * p - 1) * (3 * p) / 2 * (3 * p));
    CHECK(size(Element_type::pyramid) == 3 * p * 3 * p * (3 * p - 2));
    CHECK(size(Element_type::hexahedron) == 3 * p * 3 * p * 3 * p);
  }
}

TEST_CASE("coefficients in floating point are as close as their error bound says", "[volume]")
{
  const Element_type type = GENERATE(from_range(all_cells));
  const int degree = GENERATE(1, 2, 3, 4, 6);
  const double shear = GENERATE(0.0, 1e4);
  CAPTURE(element_name(type), degree, shear);
  std::mt19937 random(5);
  std::vector<Point> nodes = random_cell(type, degree, 0.1, random);
  for (Point& p : nodes)
    p = {p[0] / 3 + shear * p[1] + 17, p[1] / 7, p[2] / 11 - 1e3};
  const Jacobian_table& table = jacobian_table(type, degree);
  const std::vector<Fraction> exact = exact_coefficients(Exact_jacobian(table, nodes));

  const Jacobian_kernel& kernel = wide_kernel();
  std::vector<double> given, work(workspace_size(table, kernel.batch));
  for (const Point& p : nodes)
    for (const double x : p)
      given.insert(given.end(), static_cast<std::size_t>(kernel.batch), x);
  Batch_bounds bounds;
  kernel.bound(table, given.data(), work.data(), bounds);

  const double unit = std::ldexp(1.0, 3 * bounds.exponent[0]);
  double worst = 0;
  for (std::size_t m = 0; m < exact.size(); ++m)
  {
    const double c = bounds.coefficients[table.positions[m] * kernel.batch];
    worst = std::max(worst, std::abs(static_cast<double>(Fraction(Fraction(c * unit) - exact[m]))) / unit);
  }
  CHECK(worst <= bounds.error[0] / error_margin);
  CHECK(bounds.error[0] < 1e-6 * std::max(1.0, bounds.upper[0])); // and it is of use
}

TEST_CASE("every instruction set gives the same bits", "[volume]")
{
  const Element_type type = GENERATE(from_range(all_cells));
  const int degree = GENERATE(1, 3);
  CAPTURE(element_name(type), degree, wide_kernel().instruction_set);
  std::mt19937 random(6);
  const std::vector<Point> nodes = random_cell(type, degree, 0.3, random);
  const Jacobian_table& table = jacobian_table(type, degree);
  std::array<Batch_bounds, 2> bounds;
  std::size_t number = 0;
  for (const Jacobian_kernel& kernel : {narrow_kernel, wide_kernel()})
  {
    std::vector<double> given, work(workspace_size(table, kernel.batch));
    for (const Point& p : nodes)
      for (const double x : p)
        given.insert(given.end(), static_cast<std::size_t>(kernel.batch), x);
    kernel.bound(table, given.data(), work.data(), bounds[number++]);
  }
  CHECK(bounds[0].lower[1] == bounds[1].lower[0]);
  CHECK(bounds[0].upper[1] == bounds[1].upper[0]);
  CHECK(bounds[0].error[0] == bounds[1].error[0]);
}

TEST_CASE("bisection keeps the polynomial", "[volume]")
{
  const Element_type type = GENERATE(from_range(all_cells));
  CAPTURE(element_name(type));
  const Bernstein_space space = jacobian_space(type, 2);
  const Bisection_table table = Bisection_table_builder(space).table();
  std::mt19937 random(8);
  std::vector<double> whole(static_cast<std::size_t>(space.size()));
  for (double& c : whole)
    c = static_cast<double>(random() % 1000) - 500;
  std::vector<Integer> numbers(whole.begin(), whole.end());
  const auto add = [](const Integer& a, const Integer& b) { return Integer(a + b); };
  const auto raise = [](const Integer& x, int n) { return Integer(x << n); };
  const std::vector<Fraction> coefficients(whole.begin(), whole.end());
  // An edge of the domain from corner a to b: the first half is the image under b -> (a + b) / 2.
  std::size_t number = 0;
  int first_axis = 0;
  for (const int dimension : space.dimensions)
  {
    for (int a = 0; a <= dimension; ++a)
      for (int b = a + 1; b <= dimension; ++b, ++number)
      {
        const Bisection& bisection = table.bisections[number];
        std::vector<Integer> first(numbers.size()), second(numbers.size());
        bisect(bisection, numbers.data(), first.data(), second.data(), add, raise);
        for (const bool is_first : {true, false})
        {
          std::vector<Fraction> half;
          for (const Integer& c : is_first ? first : second)
            half.emplace_back(c, Integer(1) << bisection.degree);
          Fraction_point p = {Fraction(1, 7), Fraction(2, 9), Fraction(3, 11)}, image = p;
          // barycentric coordinates in the half: the one of the corner that moved is split between both
          std::array<Fraction, 4> t = {1, 0, 0, 0};
          for (int d = 0; d < dimension; ++d)
          {
            t[static_cast<std::size_t>(d + 1)] = p[static_cast<std::size_t>(first_axis + d)];
            t[0] -= p[static_cast<std::size_t>(first_axis + d)];
          }
          const auto moved = static_cast<std::size_t>(is_first ? b : a),
                     kept = static_cast<std::size_t>(is_first ? a : b);
          t[kept] += t[moved] / 2;
          t[moved] /= 2;
          for (int d = 0; d < dimension; ++d)
            image[static_cast<std::size_t>(first_axis + d)] = t[static_cast<std::size_t>(d + 1)];
          CHECK(bernstein_value(space, half, p) == bernstein_value(space, coefficients, image));
        }
      }
    first_axis += dimension;
  }
  CHECK(number == table.bisections.size());
}
