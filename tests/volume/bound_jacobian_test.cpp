#include <recurve/volume/bound_jacobian.h>

#include <recurve/core/exceptions.h>
#include <volume/jacobian_oracles.h>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <catch2/catch.hpp>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

using namespace recurve;
using namespace recurve::tests;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// (u, v, w) -> (u, v, w (hair + (u-a)^2 + (v-b)^2)), whose det J = hair + (u-a)^2 + (v-b)^2 is least along a line
/// inside. Degree 2 of hexahedra and prisms has it, degree 3 of tetrahedra and pyramids.
struct Line_of_minima
{
  double a, b, hair;

  Point operator()(const Point& p) const
  {
    return {p[0], p[1], p[2] * (hair + (p[0] - a) * (p[0] - a) + (p[1] - b) * (p[1] - b))};
  }
};

/// The same with a third square, (w-c)^2: det J is least at one point. Degree 3 of all types has it.
struct Point_of_minimum
{
  double a, b, c, hair;

  Point operator()(const Point& p) const
  {
    const double w = p[2] - c;
    return {p[0], p[1], Line_of_minima{a, b, hair}(p)[2] + w * w * w / 3};
  }
};

/// a linear map of determinant 1 with nothing aligned.
Point sheared(const Point& p)
{
  const Point q = {p[0] + 0.3 * p[1] - 0.2 * p[2], p[1] + 0.7 * p[2], p[2]};
  return {q[0], q[1] - 0.4 * q[0], q[2] + 0.6 * q[0] + 0.1 * (q[1] - 0.4 * q[0])};
}

int least_degree_of_line(Element_type type)
{
  return type == Element_type::hexahedron || type == Element_type::prism ? 2 : 3;
}

/// 2, 3 and 4 Gauss points along each direction of the hexahedron, its corners and its nodes.
std::vector<Reference_point> usual_test_points(int degree)
{
  std::vector<Reference_point> points = reference_nodes(Element_type::hexahedron, degree);
  const std::vector<std::vector<double>> gauss = {
    {-0.5773502691896257, 0.5773502691896257},
    {-0.7745966692414834, 0, 0.7745966692414834},
    {-0.8611363115940526, -0.3399810435848563, 0.3399810435848563, 0.8611363115940526}};
  for (const auto& rule : gauss)
    for (const double z : rule)
      for (const double y : rule)
        for (const double x : rule)
          points.push_back({(1 + x) / 2, (1 + y) / 2, (1 + z) / 2});
  return points;
}

bool are_equal(const Jacobian_bounds& a, const Jacobian_bounds& b)
{
  return a.lower == b.lower && a.upper == b.upper && a.reached == b.reached && a.scaled == b.scaled &&
         a.verdict == b.verdict && a.is_subdivided == b.is_subdivided && a.is_exact == b.is_exact;
}

/// Cells of all types, of which some are straight, some inverted and some hard; they share no nodes.
struct Cell_soup
{
  int degree = 2;
  std::vector<Point> nodes;
  std::vector<std::vector<Index>> numbers;
  std::vector<Element_block> blocks;

  explicit Cell_soup(int count, int p = 2) : degree(p), numbers(all_cells.size())
  {
    std::mt19937 random(11);
    for (std::size_t t = 0; t < all_cells.size(); ++t)
    {
      for (int c = 0; c < count; ++c)
        for (const Point& x : random_cell(all_cells[t], degree, c % 3 == 0 ? 0 : 0.1 * (c % 5), random))
        {
          numbers[t].push_back(static_cast<Index>(nodes.size()));
          nodes.push_back({x[0] + c, x[1], x[2]});
        }
      blocks.push_back({all_cells[t], numbers[t]});
    }
  }

  std::vector<Point> cell(Index block, Index element) const
  {
    std::vector<Point> result;
    const auto stride = node_count(blocks[std::size_t(block)].type, degree);
    for (int m = 0; m < stride; ++m)
      result.push_back(nodes[std::size_t(numbers[std::size_t(block)][std::size_t(element * stride + m)])]);
    return result;
  }
};

bool are_equal(const Extreme_element& a, const Extreme_element& b)
{
  return a.scaled == b.scaled && a.block == b.block && a.element == b.element && a.position == b.position;
}

bool are_equal(const Jacobian_report& a, const Jacobian_report& b)
{
  bool result = a.histogram == b.histogram && a.straight_elements == b.straight_elements &&
                a.subdivided_elements == b.subdivided_elements && a.exact_elements == b.exact_elements &&
                are_equal(a.least, b.least) && are_equal(a.least_valid, b.least_valid);
  for (const Element_type type : all_cells)
    result = result && a.of(type).valid == b.of(type).valid && a.of(type).invalid == b.of(type).invalid &&
             a.of(type).undecided == b.of(type).undecided;
  return result;
}

} // namespace

TEST_CASE("bound_jacobian: an affine cell has one value", "[volume]")
{
  const Element_type type = GENERATE(from_range(all_cells));
  const int degree = GENERATE(1, 2, 3, 4, 5, 6);
  CAPTURE(element_name(type), degree);
  const auto nodes = mapped_nodes(type, degree, [](const Point& p) {
    const Point q = sheared({2 * p[0], 3 * p[1], 5 * p[2]});
    return Point{q[0] + 7, q[1] - 11, q[2] + 13};
  });
  const Jacobian_bounds b = bound_jacobian(type, degree, nodes);
  CHECK(b.verdict == Validity::valid);
  CHECK(b.lower <= 30);
  CHECK(b.upper >= 30);
  CHECK(b.reached >= b.lower);
  CHECK_FALSE(b.is_subdivided);
  const double round_off = degree < 3 ? 1e-10 : degree < 5 ? 1e-8 : 1e-5; // the conversion's condition grows with p
  CHECK(b.upper - b.lower < round_off);
  CHECK(b.scaled > 1 - round_off);
  CHECK(b.scaled <= 1);
}

TEST_CASE("bound_jacobian: a tetrahedron of degree 1 is its volume", "[volume]")
{
  const unsigned seed = 2;
  CAPTURE(seed);
  std::mt19937 random(seed);
  for (int run = 0; run < 1000; ++run)
  {
    // small integers: the determinant is exact in 64 bits
    std::array<std::array<std::int64_t, 3>, 3> edges;
    std::vector<Point> nodes = {{5, -3, 2}};
    for (auto& edge : edges)
    {
      for (auto& x : edge)
        x = static_cast<std::int64_t>(random() % 9) - 4;
      nodes.push_back({5 + double(edge[0]), -3 + double(edge[1]), 2 + double(edge[2])});
    }
    const auto volume = static_cast<double>(determinant(edges));
    const Jacobian_bounds b = bound_jacobian(Element_type::tetrahedron, 1, nodes);
    CAPTURE(run, volume, b.lower, b.upper);
    REQUIRE(b.verdict == (volume > 0 ? Validity::valid : Validity::invalid));
    REQUIRE(b.lower <= volume);
    REQUIRE(b.upper >= volume);
    REQUIRE(b.upper - b.lower < 1e-11);
  }
}

TEST_CASE("bound_jacobian: the bounds enclose samples and are as sharp as asked", "[volume]")
{
  const Element_type type = GENERATE(from_range(all_cells));
  const int degree = GENERATE(1, 2, 3, 4, 5, 6);
  const unsigned seed = 3;
  CAPTURE(element_name(type), degree, seed);
  std::mt19937 random(seed);
  std::vector<Sample> samples;
  for (const Reference_point& p : sample_points(type, degree + 1, 500, random))
    samples.emplace_back(type, degree, p);
  const int cells = degree < 4 ? 20 : 4; // the label regression has more
  const double sharpness = 0.01;
  for (int c = 0; c < cells; ++c)
  {
    const std::vector<Point> nodes = random_cell(type, degree, c % 2 == 0 ? 0.4 / degree : 0.1 / degree, random);
    const Jacobian_bounds fast = bound_jacobian(type, degree, nodes);
    const Jacobian_bounds sharp = bound_jacobian(type, degree, nodes, {.max_parts = 3000, .sharpness = sharpness});
    double least = infinity, largest = -infinity;
    for (const Sample& sample : samples)
    {
      const double value = sample.jacobian(nodes);
      least = std::min(least, value);
      largest = std::max(largest, value);
    }
    const double round_off = 1e-9; // of the samples; det J is of order 1
    CAPTURE(c, least, largest, fast.lower, fast.upper, sharp.lower, sharp.upper, sharp.reached);
    for (const Jacobian_bounds& b : {fast, sharp})
    {
      CHECK(b.lower <= least + round_off);
      CHECK(b.upper >= largest - round_off);
      CHECK(b.lower <= b.reached);
      CHECK(b.scaled * std::max(b.upper, -b.lower) == Approx(b.lower));
    }
    CHECK(sharp.verdict == fast.verdict);
    if (degree < 5) // beyond, random displacements make coefficients a thousand times det J: the limits come first
      CHECK(sharp.lower >= sharp.reached - sharpness * std::max(sharp.upper, -sharp.lower) * (1 + 1e-9));
    CHECK(sharp.lower >= fast.lower - round_off);
  }
}

TEST_CASE("bound_jacobian: tangled cells with positive Jacobians at corners and Gauss points", "[volume]")
{
  SECTION("linear hexahedron and prism; the worst of a random search")
  {
    const std::vector<Point> hexahedron = {{-6, -6, 5}, {3, 6, -5},  {12, 7, -5},  {0, 6, -6},
                                           {3, 4, 10},  {12, -6, 6}, {11, 14, 13}, {1, 8, 11}};
    const std::vector<Point> prism = {{-3, 3, -5}, {2, -6, 5}, {1, 4, -6}, {2, -6, 7}, {14, 6, 6}, {-2, 10, 14}};
    for (const auto& [type, nodes] :
         {std::pair{Element_type::hexahedron, hexahedron}, std::pair{Element_type::prism, prism}})
    {
      CAPTURE(element_name(type));
      const double g = 0.5 / std::sqrt(3.0);
      for (const double z : {0.0, 0.5 - g, 0.5 + g, 1.0})
        for (const double y : {0.0, 0.5 - g, 0.5 + g, 1.0})
          for (const double x : {0.0, 0.5 - g, 0.5 + g, 1.0})
          {
            const bool is_corner = std::round(x) == x && std::round(y) == y && std::round(z) == z;
            const bool is_inner = std::round(x) != x && std::round(y) != y && std::round(z) != z;
            if (is_corner || is_inner)
              CHECK(sampled_jacobian(type, 1, nodes, into_element(type, Reference_point{x, y, z})) > 50);
          }
      const Jacobian_bounds b = bound_jacobian(type, 1, nodes);
      CHECK(b.verdict == Validity::invalid);
      CHECK(b.reached < 0);
    }
  }
  SECTION("quadratic hexahedron, inverted along a thin thread between 4 x 4 x 4 Gauss points")
  {
    const auto nodes = mapped_nodes(Element_type::hexahedron, 2, Line_of_minima{0.3, 0.3, -0.001});
    for (const Reference_point& p : usual_test_points(2))
      CHECK(sampled_jacobian(Element_type::hexahedron, 2, nodes, p) > 0);
    const Jacobian_bounds b = bound_jacobian(Element_type::hexahedron, 2, nodes);
    CHECK(b.verdict == Validity::invalid);
    CHECK(b.lower <= -0.001);
  }
}

TEST_CASE("bound_jacobian: valid and invalid by a hair at a point", "[volume]")
{
  const Element_type type = GENERATE(from_range(all_cells));
  const int degree = GENERATE(3, 4, 5, 6);
  const double hair = GENERATE(1e-10, -1e-10, 1e-7, -1e-7);
  const bool is_sheared = GENERATE(false, true);
  if (degree > 4 && std::abs(hair) < 1e-9)
    return; // exact arithmetic, seconds
  CAPTURE(element_name(type), degree, hair, is_sheared);
  const Point_of_minimum map{0.3, 0.2, 0.1, hair};
  const auto nodes = mapped_nodes(type, degree, [&](const Point& p) { return is_sheared ? sheared(map(p)) : map(p); });
  const Jacobian_bounds b = bound_jacobian(type, degree, nodes);
  CAPTURE(b.lower, b.reached, b.is_subdivided, b.is_exact);
  CHECK(b.verdict == (hair > 0 ? Validity::valid : Validity::invalid));
}

TEST_CASE("bound_jacobian: valid and invalid by a hair along a line", "[volume]")
{
  const Element_type type = GENERATE(from_range(all_cells));
  const int degree = GENERATE(2, 3, 4);
  const double hair = GENERATE(1e-10, -1e-10, 1e-7, -1e-7);
  const bool is_sheared = GENERATE(false, true);
  if (degree < least_degree_of_line(type))
    return;
  CAPTURE(element_name(type), degree, hair, is_sheared);
  const Line_of_minima map{0.3, 0.3, hair};
  const auto nodes = mapped_nodes(type, degree, [&](const Point& p) { return is_sheared ? sheared(map(p)) : map(p); });
  const Jacobian_bounds b = bound_jacobian(type, degree, nodes);
  CAPTURE(b.lower, b.reached, b.is_subdivided, b.is_exact);
  CHECK(b.verdict != (hair > 0 ? Validity::invalid : Validity::valid)); // never wrong
  // Parts are a square root of the hair wide: too many to tell where the line crosses the parts' directions.
  if (type == Element_type::hexahedron || type == Element_type::prism || hair < 0)
    CHECK(b.verdict == (hair > 0 ? Validity::valid : Validity::invalid));
}

TEST_CASE("bound_jacobian: a hair below the error of doubles takes exact arithmetic", "[volume]")
{
  const int degree = GENERATE(2, 4); // lattice points and their images are exact in doubles
  const double hair = GENERATE(0x1p-45, -0x1p-45);
  CAPTURE(degree, hair);
  const auto nodes = mapped_nodes(Element_type::hexahedron, degree, Line_of_minima{0.375, 0.625, hair});
  const Jacobian_bounds b = bound_jacobian(Element_type::hexahedron, degree, nodes);
  CHECK(b.verdict == (hair > 0 ? Validity::valid : Validity::invalid));
  CHECK(b.is_exact);
  if (hair > 0)
    CHECK(b.lower <= hair);
  CHECK(b.reached >= hair);
  CHECK(b.reached <= std::abs(hair) * (1 + 1e-12));
}

TEST_CASE("bound_jacobian: a bound so sharp that a point outside by a rounding is below it", "[volume]")
{
  // det J = 1.03e-11 is least at the corner (1, 1, 0), and exact arithmetic puts the lower bound 1e-15 of it below.
  const std::vector<Point> nodes = {
    {-0x1.a1b9179f54881p-6, -0x1.2f781115a83a1p-6, -0x1.db8ce0c9b7d95p-7},
    {0x1.0627ee096d7dap+0, 0x1.0b1df33fe3b6dp-6, -0x1.42d5ee8d1fe56p-6},
    {0x1.01a8cdee90b26p+0, 0x1.f8a9a0e8b4a7ap-1, 0x1.1a7105f6de8aep-8},
    {-0x1.fe183f99ee1f8p-7, 0x1.01554f372b77ap+0, -0x1.094c056a92174p-6},
    {-0x1.64f2d1b5ed3a1p-7, 0x1.7f94b4a057a37p-6, 0x1.f338a3125b49fp-1},
    {0x1.5feb7e4bed4d3p-2, -0x1.3cc418c426bccp-6, -0x1.fd2e7788fb717p-9},
    {0x1.5a68d44f228ep-1, -0x1.7c34dac41c883p-7, -0x1.0742d511e2385p-7},
    {0x1.f7b3b31e8806fp-1, 0x1.40b9127d08cdbp-2, -0x1.ad2de80e5bcep-6},
    {0x1.fe0f7a2bd2ce3p-1, 0x1.5ff089f50dde3p-1, 0x1.994c39d74f1c2p-6},
    {0x1.6283d1415354bp-1, 0x1.f7c25d471fe38p-1, 0x1.65f4e02e7f70cp-6},
    {0x1.4c9f0501b5fa3p-2, 0x1.fdabc509d97bdp-1, -0x1.95757b8f869bcp-6},
    {0x1.ec269fbede5ccp-7, 0x1.4cf7c632067fep-1, -0x1.88df334f40b29p-6},
    {0x1.2ca4098282cd9p-8, 0x1.48d16a64d1cdcp-2, 0x1.1601515fe23e3p-8},
    {-0x1.620da6244edebp-6, 0x1.eaaad022764aep-7, 0x1.5f40d81d64873p-2},
    {0x1.b103a9cd46cc2p-6, 0x1.99d8c3d6f71ep-6, 0x1.5fb59f3132ccbp-1},
    {0x1.5909867d6f56p-1, 0x1.84f5d89e87f1ep-8, 0x1.4916c76f0674bp-2},
    {0x1.567e729a68156p-2, 0x1.01dd33e28d8bfp-6, 0x1.60a8863ccc14dp-1},
    {0x1.5a1f81a264ef3p-1, 0x1.51f89622edeb2p-1, 0x1.3b48bc86a5d49p-2},
    {0x1.6991a2da1a1bcp-2, 0x1.5500c4155bb76p-2, 0x1.4c3084c4a14a2p-1},
    {-0x1.20b822b544767p-9, 0x1.4e5d2cff3bef5p-1, 0x1.4dc920d64537fp-2},
    {0x1.5b4fbc3f04ff8p-9, 0x1.6b463b4279c27p-2, 0x1.4d879f72cf455p-1},
    {0x1.605d10fc8c092p-2, 0x1.4ec394dc1725p-2, -0x1.a62a35050fb0ap-8},
    {0x1.611f9d4e116cp-2, 0x1.600bb7d6dd9b1p-1, 0x1.d77b5da73d722p-9},
    {0x1.607043e843a69p-1, 0x1.6bde8a07c9137p-2, -0x1.65ffe50dac6ebp-8},
    {0x1.5e9ac3aca9944p-1, 0x1.48168578f8e7bp-1, -0x1.b2ad36582e4eap-9},
    {0x1.3f02e11303da3p-2, 0x1.86fb2532e3bc2p-8, 0x1.5175439ef9c62p-2},
    {0x1.58b16c98d799fp-1, 0x1.547e4ce75a8d1p-2, 0x1.55bbd87a26cf8p-2},
    {0x1.62e679d22217ap-2, 0x1.5ef9d0cfe18c6p-1, 0x1.57989fe137ca1p-2},
    {-0x1.dd1f422cea721p-8, 0x1.457bbdf5cae25p-2, 0x1.3b0e99dd2dd94p-2},
    {0x1.531eeebc2ef5dp-2, 0x1.5d9dfd1741b4fp-2, 0x1.4537c7cebbe11p-2},
  };
  const Element_type type = Element_type::pyramid;
  const int degree = 3;
  const Exact_oracle oracle(type, degree);
  const Jacobian_bounds b = bound_jacobian(type, degree, nodes, {.max_parts = 4000, .max_exact_parts = 100});
  CHECK(b.verdict == Validity::valid);
  CHECK(b.is_exact);
  const auto value_at = [&](const Fraction_point& p) { return oracle.jacobian(nodes, p); };
  const Fraction least = value_at(fractions({1, 1, 0}));
  CHECK(Fraction(b.lower) <= least);
  CHECK(Fraction(b.reached) >= least);
  CHECK(Fraction(b.lower) > least * (1 - Fraction(0x1p-48)));

  // Five steps of a tenth do not add up to 0.5: the descent ends a rounding above the corner, where 1 - z is 1 in
  // doubles. Outside of the element det J goes on falling.
  const Reference_point cube = descend(type, degree, nodes, {1, 1, 0.5}, 25);
  CHECK(cube == Reference_point{1, 1, 0x1p-55});
  CHECK(value_at(into_element(type, fractions(cube))) >= Fraction(b.lower));
  CHECK(value_at(fractions(into_element(type, cube))) < Fraction(b.lower));
}

TEST_CASE("points of the cube move into the element", "[volume]")
{
  const Element_type type = GENERATE(from_range(all_cells));
  const unsigned seed = 4;
  CAPTURE(element_name(type), seed);
  std::mt19937 random(seed);
  const std::vector<Point> nodes = random_cell(type, 3, 0.3, random);
  for (const Reference_point& start : sample_cube(type, 3, 100, random))
    for (const Reference_point& cube : {start, descend(type, 3, nodes, start, 10)})
    {
      const Fraction_point p = into_element(type, fractions(cube));
      CAPTURE(cube[0], cube[1], cube[2]);
      REQUIRE((p[0] >= 0 && p[1] >= 0 && p[2] >= 0));
      switch (type)
      {
      case Element_type::tetrahedron: REQUIRE(p[0] + p[1] + p[2] <= 1); break;
      case Element_type::prism: REQUIRE((p[0] + p[1] <= 1 && p[2] <= 1)); break;
      case Element_type::pyramid: REQUIRE((p[0] + p[2] <= 1 && p[1] + p[2] <= 1 && p[2] < 1)); break;
      default: REQUIRE((p[0] <= 1 && p[1] <= 1 && p[2] <= 1));
      }
    }
}

TEST_CASE("bound_jacobian: quadratic cells by a hair", "[volume]")
{
  // x + iy = z^2 with z = u + iv: det J = 4 |z|^2, here off the edge u = v = 0 by 5e-6, hence at least 1e-10; or with
  // a term that lowers it by c^2 around a line inside.
  const Element_type type = GENERATE(from_range(all_cells));
  CAPTURE(element_name(type));
  const double eta = 5e-6, c = 1e-5;
  const auto valid = mapped_nodes(type, 2, [&](const Point& p) {
    const double u = p[0] + eta, v = p[1];
    return sheared({u * u - v * v, 2 * u * v, p[2]});
  });
  CHECK(bound_jacobian(type, 2, valid).verdict == Validity::valid);
  const auto invalid = mapped_nodes(type, 2, [&](const Point& p) {
    const double u = p[0] - 0.23, v = p[1] - 0.27;
    return sheared({u * u - v * v + c * v, 2 * u * v + c * u, p[2]});
  });
  CHECK(bound_jacobian(type, 2, invalid).verdict == Validity::invalid);
}

TEST_CASE("bound_jacobian: det J that touches zero", "[volume]")
{
  SECTION("at a point that subdivision meets")
  {
    const auto nodes = mapped_nodes(Element_type::hexahedron, 2, Line_of_minima{0.375, 0.5, 0});
    const Jacobian_bounds b = bound_jacobian(Element_type::hexahedron, 2, nodes);
    CHECK(b.verdict == Validity::invalid);
    CHECK(b.reached >= 0);
  }
  SECTION("at a point that it does not meet: never valid")
  {
    const auto nodes = mapped_nodes(Element_type::hexahedron, 2, [](const Point& p) {
      const double f = 3 * p[0] - 1; // det J = 9 (u - 1/3)^2, exactly
      return Point{p[0], p[1], p[2] * f * f};
    });
    const Jacobian_bounds b = bound_jacobian(Element_type::hexahedron, 2, nodes);
    CHECK(b.verdict == Validity::undecided);
    CHECK(b.lower <= 0);
    CHECK(b.reached > 0);
    CHECK(b.reached < 1e-10);
  }
}

TEST_CASE("bound_jacobian: degenerate and hopeless cells", "[volume]")
{
  const Element_type type = GENERATE(from_range(all_cells));
  const int degree = GENERATE(1, 2, 3);
  CAPTURE(element_name(type), degree);
  SECTION("a collapsed edge")
  {
    const auto nodes = mapped_nodes(type, degree, [](const Point& p) { return Point{p[0] * p[2], p[1], p[2]}; });
    CHECK(bound_jacobian(type, degree, nodes).verdict == Validity::invalid);
  }
  SECTION("all nodes at one point")
  {
    const auto nodes = mapped_nodes(type, degree, [](const Point&) { return Point{0.1, -7, 1e5}; });
    const Jacobian_bounds b = bound_jacobian(type, degree, nodes);
    CHECK(b.verdict == Validity::invalid);
    CHECK(b.reached >= 0);
  }
  SECTION("flat, but no edge collapsed: exact arithmetic sees the zero")
  {
    const auto nodes = mapped_nodes(type, degree, [](const Point& p) { return Point{p[0], p[1] + 0.5 * p[2], p[0]}; });
    const Jacobian_bounds b = bound_jacobian(type, degree, nodes);
    CHECK(b.verdict == Validity::invalid);
    CHECK(b.is_exact);
  }
  SECTION("inside out")
  {
    const auto nodes = mapped_nodes(type, degree, [](const Point& p) { return Point{p[1], p[0], p[2]}; });
    const Jacobian_bounds b = bound_jacobian(type, degree, nodes);
    CHECK(b.verdict == Validity::invalid);
    CHECK(b.upper < 0);
    CHECK(b.scaled >= -1);
    CHECK(b.scaled < -0.99);
  }
  SECTION("not finite")
  {
    const double bad = GENERATE(std::numeric_limits<double>::quiet_NaN(), infinity, -infinity);
    auto nodes = reference_nodes(type, degree);
    nodes.back()[1] = bad;
    const Jacobian_bounds b = bound_jacobian(type, degree, nodes);
    CHECK(b.verdict == Validity::undecided);
    CHECK(b.lower == -infinity);
    CHECK(b.upper == infinity);
  }
  SECTION("finite, though differences overflow")
  {
    const auto nodes = mapped_nodes(type, degree, [](const Point& p) {
      constexpr double big = std::numeric_limits<double>::max();
      return Point{(2 * p[0] - 1) * big, (2 * p[1] - 1) * big, (2 * p[2] - 1) * big};
    });
    const Jacobian_bounds b = bound_jacobian(type, degree, nodes);
    CHECK(b.verdict == Validity::valid);
    CHECK(std::isfinite(b.lower));
    CHECK(b.upper == infinity);
  }
  SECTION("so small that det J underflows")
  {
    const auto nodes = mapped_nodes(type, degree, [](const Point& p) {
      return Point{p[0] * 0x1p-500, p[1] * 0x1p-500, p[2] * 0x1p-500};
    });
    const Jacobian_bounds b = bound_jacobian(type, degree, nodes);
    CHECK(b.verdict == Validity::valid);
    CHECK(b.lower == 0);
    CHECK(b.upper > 0);
    CHECK(b.scaled > 0.99);
  }
}

TEST_CASE("bound_jacobian: neither unit nor place nor direction matter", "[volume]")
{
  const Element_type type = GENERATE(from_range(all_cells));
  const int degree = GENERATE(1, 2, 3, 4);
  const unsigned seed = 4;
  CAPTURE(element_name(type), degree, seed);
  std::mt19937 random(seed);
  for (int run = 0; run < 20; ++run)
  {
    const auto nodes = random_cell(type, degree, 0.1 * (run % 5), random);
    const Jacobian_bounds b = bound_jacobian(type, degree, nodes, {.sharpness = 1e-3});
    if (std::abs(b.scaled) < 1e-2)
      continue; // the offset below rounds nodes to 1e-10 of the size
    for (const double scale : {1e-6, 1.0, 1e6})
      for (const double offset : {0.0, 1e6})
      {
        std::vector<Point> moved = nodes;
        for (Point& p : moved)
        {
          p = sheared(p);
          p = {scale * (p[0] + offset), scale * (p[1] - 0.7 * offset), scale * (p[2] + 0.3 * offset)};
        }
        const Jacobian_bounds m = bound_jacobian(type, degree, moved, {.sharpness = 1e-3});
        CAPTURE(run, scale, offset, b.scaled, m.scaled);
        CHECK(m.verdict == b.verdict);
        CHECK(m.scaled == Approx(b.scaled).margin(4e-3));
        CHECK(m.upper == Approx(b.upper * scale * scale * scale).epsilon(0.2));
      }
    std::vector<Point> doubled = nodes;
    for (Point& p : doubled)
      p = {1024 * p[0], 1024 * p[1], 1024 * p[2]};
    const Jacobian_bounds d = bound_jacobian(type, degree, doubled, {.sharpness = 1e-3});
    CHECK(d.lower == 0x1p30 * b.lower); // powers of two change no bits
    CHECK(d.scaled == b.scaled);
  }
}

TEST_CASE("bound_jacobian: wrong arguments", "[volume]")
{
  const auto nodes = reference_nodes(Element_type::tetrahedron, 2);
  CHECK_THROWS_AS(bound_jacobian(Element_type::tetrahedron, 3, nodes), Input_error);
  CHECK_THROWS_AS(bound_jacobian(Element_type::tetrahedron, 0, nodes), Input_error);
  CHECK_THROWS_AS(bound_jacobian(Element_type::tetrahedron, 7, nodes), Input_error);
  CHECK_THROWS_AS(bound_jacobian(Element_type::triangle, 2, reference_nodes(Element_type::triangle, 2)), Input_error);
  CHECK_THROWS_AS(bound_jacobian(Element_type::tetrahedron, 2, nodes, {.max_depth = -1}), Input_error);
  CHECK_THROWS_AS(bound_jacobian(Element_type::tetrahedron, 2, nodes, {.max_parts = 0}), Input_error);
  CHECK_THROWS_AS(bound_jacobian(Element_type::tetrahedron, 2, nodes, {.sharpness = 0}), Input_error);

  std::vector<Index> numbers(10);
  std::iota(numbers.begin(), numbers.end(), 0);
  const auto blocks = [&](std::size_t size) {
    return std::vector<Element_block>{{Element_type::tetrahedron, std::span(numbers).first(size)}};
  };
  CHECK(bound_jacobians(nodes, blocks(10), 2).total().valid == 1);
  CHECK_THROWS_AS(bound_jacobians(nodes, blocks(9), 2), Input_error);
  numbers[4] = 10;
  CHECK_THROWS_AS(bound_jacobians(nodes, blocks(10), 2), Input_error);
  numbers[4] = -1;
  CHECK_THROWS_AS(bound_jacobians(nodes, blocks(10), 2), Input_error);
}

TEST_CASE("bound_jacobian: little effort leaves cells undecided, never wrong", "[volume]")
{
  const auto nodes = mapped_nodes(Element_type::hexahedron, 2, Line_of_minima{0.3, 0.3, 1e-10});
  for (const Jacobian_options& options :
       {Jacobian_options{.max_depth = 3}, Jacobian_options{.max_parts = 5}, Jacobian_options{.max_depth = 0}})
  {
    const Jacobian_bounds b = bound_jacobian(Element_type::hexahedron, 2, nodes, options);
    CHECK(b.verdict == Validity::undecided);
    CHECK(b.lower <= 1e-10);
  }
}

TEST_CASE("bound_jacobians: as cell by cell, for any number of threads", "[volume]")
{
  const Cell_soup soup(301);
  const auto is_straight = [](Index, Index element) { return element % 3 == 0; };
  std::vector<std::vector<Jacobian_bounds>> first;
  Jacobian_report first_report;
  for (const int threads : {1, 2, 7})
  {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, std::size_t(threads));
    std::vector<std::vector<Jacobian_bounds>> bounds(4, std::vector<Jacobian_bounds>(301));
    std::vector<std::vector<int>> visits(4, std::vector<int>(301));
    const Jacobian_report report =
      bound_jacobians(soup.nodes, soup.blocks, 2, {}, is_straight, [&](Index b, Index e, const Jacobian_bounds& found) {
        bounds[std::size_t(b)][std::size_t(e)] = found;
        ++visits[std::size_t(b)][std::size_t(e)];
      });
    for (const auto& block : visits)
      CHECK(std::all_of(block.begin(), block.end(), [](int n) { return n == 1; }));
    if (first.empty())
    {
      first = bounds;
      first_report = report;
    }
    CHECK(are_equal(report, first_report));
    for (std::size_t b = 0; b < 4; ++b)
      CHECK(std::equal(bounds[b].begin(), bounds[b].end(), first[b].begin(),
                       [](const auto& x, const auto& y) { return are_equal(x, y); }));
  }
  CHECK(first_report.straight_elements == 4 * 101);
  Index valid = 0, invalid = 0;
  for (Index b = 0; b < 4; ++b)
    for (Index e = 0; e < 301; ++e)
    {
      std::vector<Point> nodes = soup.cell(b, e);
      const Element_type type = soup.blocks[std::size_t(b)].type;
      if (is_straight(b, e))
        nodes.resize(std::size_t(corner_count(type)));
      const Jacobian_bounds alone = bound_jacobian(type, is_straight(b, e) ? 1 : 2, nodes);
      REQUIRE(are_equal(alone, first[std::size_t(b)][std::size_t(e)]));
      valid += alone.verdict == Validity::valid;
      invalid += alone.verdict == Validity::invalid;
    }
  CHECK(first_report.total().valid == valid);
  CHECK(first_report.total().invalid == invalid);
  CHECK(invalid > 0);
  CHECK(std::accumulate(first_report.histogram.begin(), first_report.histogram.end(), Index(0)) == valid);
}

TEST_CASE("bound_jacobians: reports of parts add up", "[volume]")
{
  const Cell_soup soup(50, 3);
  Jacobian_report sum;
  double least_valid = infinity;
  for (std::size_t b = 0; b < soup.blocks.size(); ++b)
    sum += bound_jacobians(soup.nodes, std::vector<Element_block>{soup.blocks[b]}, 3);
  Extreme_element least;
  const Jacobian_report whole =
    bound_jacobians(soup.nodes, soup.blocks, 3, {}, None_straight(), [](Index, Index, const Jacobian_bounds&) {});
  for (Index b = 0; b < 4; ++b)
    for (Index e = 0; e < 50; ++e)
    {
      const Jacobian_bounds alone = bound_jacobian(soup.blocks[std::size_t(b)].type, 3, soup.cell(b, e));
      if (alone.scaled < least.scaled)
        least = {alone.scaled, b, e, {}};
      if (alone.verdict == Validity::valid)
        least_valid = std::min(least_valid, alone.scaled);
    }
  CHECK(whole.histogram == sum.histogram);
  CHECK(whole.total().valid == sum.total().valid);
  CHECK(whole.total().invalid == sum.total().invalid);
  CHECK(whole.least.scaled == sum.least.scaled);
  CHECK(whole.least.scaled == least.scaled);
  CHECK(whole.least.block == least.block);
  CHECK(whole.least.element == least.element);
  CHECK(whole.least_valid.scaled == least_valid);
  CHECK(std::abs(whole.least.position[0] - static_cast<double>(least.element)) < 1.5); // the soup stands in a row
  CHECK(std::abs(sum.least.position[0] - static_cast<double>(sum.least.element)) < 1.5);
}

TEST_CASE("bound_jacobians: no cells, and points of CGAL", "[volume]")
{
  const Jacobian_report none = bound_jacobians(std::vector<Point>(), std::vector<Element_block>(), 2);
  CHECK(none.total().valid == 0);
  CHECK(none.least.scaled == infinity);
  CHECK(none.least.block == no_index);

  using Point_3 = CGAL::Exact_predicates_inexact_constructions_kernel::Point_3;
  const Cell_soup soup(20);
  std::vector<Point_3> points;
  for (const Point& p : soup.nodes)
    points.emplace_back(p[0], p[1], p[2]);
  CHECK(are_equal(bound_jacobians(points, soup.blocks, 2), bound_jacobians(soup.nodes, soup.blocks, 2)));
}
