#include <recurve/volume/influence.h>

#include <catch2/catch.hpp>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

using namespace recurve;

namespace {

/// the series of |1 - t|^-power in powers of t, up to `degree`.
double series(double power, double t, int degree)
{
  double sum = 0, term = 1;
  for (int k = 0; k <= degree; ++k)
  {
    sum += term;
    term *= t * (power + k) / (k + 1);
  }
  return sum;
}

} // namespace

TEST_CASE("Inverse_distance: the paper's formula, in units of its length", "[volume]")
{
  const Inverse_distance<> w(2.5, 0.9);
  CHECK(w.length() == 2.5);
  CHECK(w(1) == Approx(1 + std::pow(0.9, 5)).epsilon(1e-15));
  CHECK(w(4) == Approx(1 / 8.0 + std::pow(0.45, 5)).epsilon(1e-15));
  const Inverse_distance<2, 7> other(1, 0.5);
  CHECK(other(9) == Approx(1 / 9.0 + std::pow(0.5 / 3, 7)).epsilon(1e-14));
  const Inverse_distance_powers general(2.5, 0.9, 3, 5);
  for (const double q : {1e-12, 0.3, 1.0, 7.0, 1e12})
    CHECK(general(q) == Approx(w(q)).epsilon(1e-13));
}

TEMPLATE_TEST_CASE("Influence: derivatives are those of the weight", "[volume]", (Inverse_distance<3, 5>),
                   (Inverse_distance<1, 4>), Inverse_distance_powers)
{
  const auto w = [] {
    if constexpr (std::is_same_v<TestType, Inverse_distance_powers>)
      return Inverse_distance_powers(1, 0.7, 2.5, 6);
    else
      return TestType(1, 0.7);
  }();
  for (const double q : {0.2, 1.0, 30.0})
  {
    std::array<double, 8> here, before, after;
    const double step = 1e-4 * q;
    w.derivatives(q, here);
    w.derivatives(q - step, before);
    w.derivatives(q + step, after);
    CHECK(here[0] == Approx(w(q)).epsilon(1e-14));
    for (std::size_t m = 1; m < here.size(); ++m)
      CHECK(here[m] == Approx(2 * (after[m - 1] - before[m - 1]) / (2 * step)).epsilon(1e-5));
  }
}

TEST_CASE("Influence: the remainder encloses what the series omits, and not by much", "[volume]")
{
  const double power = GENERATE(1.0, 2.0, 3.0, 5.0, 7.5);
  const int degree = GENERATE(0, 1, 3, 6, 9);
  const double distance = GENERATE(0.01, 1.0, 300.0);
  CAPTURE(power, degree, distance);
  const Inverse_distance_powers w(1, 0, power, 1); // alpha 0: one power alone
  for (const double ratio : {1e-3, 0.05, 0.2, 0.5})
  {
    const double radius = ratio * distance;
    // towards the source, where the omitted part is largest
    double omitted = 0, term = 1;
    for (int k = 0; k < 400; ++k)
    {
      if (k > degree)
        omitted += term;
      term *= ratio * (power + k) / (k + 1);
    }
    omitted *= std::pow(distance, -power);
    const double bound = w.remainder(distance, radius, radius, degree);
    CAPTURE(ratio);
    CHECK(bound >= omitted * (1 - 1e-13));
    if (ratio <= 0.2 && degree >= 3)
      CHECK(bound <= 2 * omitted);
    // in other directions: the weight at distance and angle, less its Taylor polynomial by finite sums of Gegenbauer
    for (int a = 0; a <= 12; ++a)
    {
      const double cosine = std::cos(std::numbers::pi * a / 12);
      std::vector<double> c = {1, power * cosine};
      for (int k = 2; k <= degree; ++k)
        c.push_back(
          (2 * cosine * (k + power / 2 - 1) * c[std::size_t(k - 1)] - (k + power - 2) * c[std::size_t(k - 2)]) / k);
      double polynomial = 0;
      for (int k = 0; k <= degree; ++k)
        polynomial += c[std::size_t(k)] * std::pow(ratio, k);
      const double q = 1 - 2 * ratio * cosine + ratio * ratio;
      const double error = std::abs(std::pow(q, -power / 2) - polynomial) * std::pow(distance, -power);
      CHECK(error <= bound + 1e-14 * std::pow(distance, -power));
    }
  }
  CHECK(series(power, 0.2, 200) == Approx(std::pow(0.8, -power)).epsilon(1e-12)); // the test's own series
}

TEST_CASE("Influence: compiled and general exponents have the same remainder", "[volume]")
{
  const Inverse_distance<3, 5> compiled(1, 0.9);
  const Inverse_distance_powers general(1, 0.9, 3, 5);
  for (const int degree : {0, 4, 9, 20})
    for (const double distance : {0.1, 1.0, 40.0})
      CHECK(compiled.remainder(distance, 0.2 * distance, 0.3 * distance, degree) ==
            Approx(general.remainder(distance, 0.2 * distance, 0.3 * distance, degree)).epsilon(1e-12));
}
