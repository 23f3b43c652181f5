#include <recurve/surface/compact_policies.h>

#include <catch2/catch.hpp>

#include <array>
#include <cmath>
#include <random>
#include <vector>

using namespace recurve;

namespace {

/// Points with heights of a polynomial of known coefficients.
struct Problem
{
  std::vector<double> u, v, height, weight;
  std::vector<double> expected;

  Problem(int degree, int count, bool is_through_origin, bool is_strip = false)
  {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> uniform(-2, 2);
    for (int c = 0; c < coefficient_count(degree); ++c)
      expected.push_back(c == 0 && is_through_origin ? 0 : uniform(random));
    for (int i = 0; i < count; ++i)
    {
      u.push_back(uniform(random));
      v.push_back(is_strip ? i % 2 : uniform(random));
      weight.push_back(0.1 + std::abs(uniform(random)));
      double sum = 0;
      for (int p = 0; p <= degree; ++p)
        for (int k = 0; k <= p; ++k)
          sum += expected[static_cast<std::size_t>(coefficient_number(p - k, k))] * std::pow(u.back(), p - k) *
                 std::pow(v.back(), k);
      height.push_back(sum);
    }
  }

  Weighted_points points(bool is_through_origin) const { return {u, v, height, weight, is_through_origin}; }
};

template <class Solver>
void check_solver(const Solver& solver, double bound, int highest_degree)
{
  for (int degree = 1; degree <= highest_degree; ++degree)
    for (const bool is_through_origin : {false, true})
    {
      CAPTURE(degree, is_through_origin);
      const Problem problem(degree, 2 * coefficient_count(degree), is_through_origin);
      std::vector<double> found(problem.expected.size(), 99);
      solver(problem.points(is_through_origin), degree, found);
      for (std::size_t c = 0; c < found.size(); ++c)
        CHECK(found[c] == Approx(problem.expected[c]).margin(bound));
      // fewer points than coefficients: finite
      const Problem poor(degree, coefficient_count(degree) - 1, is_through_origin);
      solver(poor.points(is_through_origin), degree, found);
      for (const double c : found)
        CHECK(std::isfinite(c));
    }
}

} // namespace

TEST_CASE("all solvers find the same polynomial", "[policies]")
{
  static_assert(Least_squares_solver<Graded_qr> && Least_squares_solver<Pivoted_qr> &&
                Least_squares_solver<Truncated_svd>);
  check_solver(Graded_qr{}, 1e-9, max_vertex_fit_degree);
  check_solver(Pivoted_qr{}, 1e-9, max_vertex_fit_degree);
  check_solver(Truncated_svd{}, 1e-9, max_vertex_fit_degree);
  check_solver(Conjugate_residual{1e-13}, 1e-3, 4); // squares the condition of the equations
}

TEST_CASE("every solver takes every degree", "[policies]")
{
  for (int degree = 1; degree <= max_vertex_fit_degree; ++degree)
  {
    CAPTURE(degree);
    const Problem problem(degree, coefficient_count(degree) + 5, true);
    std::vector<double> found(problem.expected.size(), 99);
    Conjugate_residual{}(problem.points(true), degree, found);
    for (const double c : found)
      CHECK((std::isfinite(c) && c != 99));
  }
}

TEST_CASE("the polynomial of a lower degree to the last points is that of a direct solution", "[policies]")
{
  for (const int degree : {6, 8, 12})
    for (const bool is_through_origin : {false, true})
      for (const int more : {4, 5}) // odd and even numbers of equations
      {
        // Heights of a polynomial of the full degree: the lower ones have something to approximate.
        const Problem problem(degree, coefficient_count(degree) + more, is_through_origin);
        const Graded_qr solver;
        std::vector<double> full(problem.expected.size());
        for (int lower = degree - 2; lower > 0; lower -= 2)
        {
          CAPTURE(degree, is_through_origin, more, lower);
          solver(problem.points(is_through_origin), degree, full);
          std::vector<double> found(static_cast<std::size_t>(coefficient_count(lower)), 99), expected = found;
          solver.solve_lower(lower, found);
          solver(problem.points(is_through_origin), lower, expected);
          double largest = 0;
          for (const double c : expected)
            largest = std::max(largest, std::abs(c));
          for (std::size_t c = 0; c < found.size(); ++c)
            CHECK(found[c] == Approx(expected[c]).margin(1e-8 * largest));
        }
      }
  // Another solver came between, or no such degree was solved: not a number.
  const Problem problem(4, 40, true);
  std::vector<double> found(problem.expected.size());
  Graded_qr{}(problem.points(true), 4, found);
  std::vector<double> higher(static_cast<std::size_t>(coefficient_count(6)));
  Graded_qr{}.solve_lower(6, higher);
  CHECK(std::isnan(higher[1]));
  Pivoted_qr{}(problem.points(true), 4, found);
  Graded_qr{}.solve_lower(2, found);
  CHECK(std::isnan(found[1]));
}

TEST_CASE("slopes are data as good as heights", "[policies]")
{
  // Too few points for the polynomial; their slopes tell the rest.
  for (int degree = 2; degree <= 6; ++degree)
    for (const bool is_through_origin : {false, true})
    {
      CAPTURE(degree, is_through_origin);
      const Problem problem(degree, coefficient_count(degree) / 2 + 2, is_through_origin);
      std::vector<double> by_u(problem.u.size(), 0), by_v(problem.u.size(), 0);
      for (std::size_t i = 0; i < problem.u.size(); ++i)
        for (int p = 1; p <= degree; ++p)
          for (int k = 0; k <= p; ++k)
          {
            const double c = problem.expected[static_cast<std::size_t>(coefficient_number(p - k, k))];
            const double u = problem.u[i], v = problem.v[i];
            by_u[i] += p == k ? 0 : c * (p - k) * std::pow(u, p - k - 1) * std::pow(v, k);
            by_v[i] += k == 0 ? 0 : c * k * std::pow(u, p - k) * std::pow(v, k - 1);
          }
      Weighted_points points = problem.points(is_through_origin);
      points.slopes = {problem.u, problem.v, by_u, by_v, problem.weight};
      std::vector<double> found(problem.expected.size(), 99);
      const auto check = [&](double bound) {
        for (std::size_t c = 0; c < found.size(); ++c)
          CHECK(found[c] == Approx(problem.expected[c]).margin(bound));
      };
      Graded_qr{}(points, degree, found);
      check(1e-9);
      Pivoted_qr{}(points, degree, found);
      check(1e-9);
      Truncated_svd{}(points, degree, found);
      check(1e-9);
      Conjugate_residual{1e-13}(points, degree, found);
      if (degree <= 4) // squares the condition of the equations
        check(1e-3);
    }
}

TEST_CASE("what the points of a strip do not tell is left out, what they tell is kept", "[policies]")
{
  // v is 0 or 1: v^2 = v cannot be told from v.
  Problem strip(3, 40, true, true);
  for (std::size_t i = 0; i < strip.u.size(); ++i)
    strip.height[i] = 2 * strip.u[i] * strip.u[i] - strip.v[i];
  for (int solver = 0; solver < 2; ++solver)
  {
    std::array<double, 10> found = {};
    if (solver == 0)
      Graded_qr{}(strip.points(true), 3, found);
    else
      Pivoted_qr{}(strip.points(true), 3, found);
    CHECK(found[static_cast<std::size_t>(coefficient_number(2, 0))] == Approx(2));
    double sum_across = 0; // of v, v^2 and v^3, which are one
    for (int k = 1; k <= 3; ++k)
      sum_across += found[static_cast<std::size_t>(coefficient_number(0, k))];
    CHECK(sum_across == Approx(-1));
  }
}
