#include <recurve/volume/bound_jacobian.h>

#include <support/shared_data.h>
#include <volume/jacobian_oracles.h>
#include <volume/read_msh.h>

#include <catch2/catch.hpp>

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <limits>
#include <random>
#include <string>
#include <utility>
#include <vector>

using namespace recurve;
using namespace recurve::tests;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// how many cells the search looks at, all in all; RECURVE_SEARCH_CELLS asks for another number. The whole search has
/// 1000000 and takes a quarter of an hour.
int searched_cells()
{
  const char* const variable = std::getenv("RECURVE_SEARCH_CELLS");
  return variable ? std::atoi(variable) : 50000;
}

/// Tries to catch bound_jacobian() with a wrong verdict on cells of one type and degree.
class Search
{
public:
  Search(Element_type type, int degree, unsigned seed)
    : type_(type), degree_(degree), random_(seed), oracle_(type, degree)
  {
    points_ = sample_cube(type, degree < 4 ? degree + 1 : 4, 40, random_);
    for (const Reference_point& p : points_)
      samples_.emplace_back(type, degree, into_element(type, p));
  }

  /// a way from the reference cell towards a random one: cells at random on the way, and those between which bisection
  /// finds the verdict to turn, down to a hair of 1e-12.
  void search_one_way()
  {
    std::uniform_real_distribution<double> uniform(0, 1);
    const std::vector<Point> start = reference_nodes(type_, degree_);
    const std::vector<Point> end = random_cell(type_, degree_, degree_ == 1 ? 1.5 : 0.8, random_);
    double good = 0, bad = 1;
    for (int step = 0; step < 40; ++step)
    {
      const double t = step < 8 ? uniform(random_) : (good + bad) / 2;
      const std::vector<Point> nodes = between(start, end, t);
      const Jacobian_bounds b = bound_jacobian(type_, degree_, nodes, {.max_parts = 4000, .max_exact_parts = 100});
      examine(nodes, b, step == 39);
      if (b.verdict == Validity::valid)
        good = std::max(good, t);
      else
        bad = std::min(bad, t);
      if (good > bad)
        good = bad = t; // the cell may become valid again: then this way has more than one turn
    }
  }

  int cells = 0, valid = 0, invalid = 0, undecided = 0, exact = 0, descents = 0, unexplained = 0, wrong = 0;
  double least_margin = infinity; ///< of a valid cell: smallest sample, relative to the largest

private:
  static std::vector<Point> between(const std::vector<Point>& a, const std::vector<Point>& b, double t)
  {
    std::vector<Point> result = a;
    for (std::size_t m = 0; m < a.size(); ++m)
      for (std::size_t d = 0; d < 3; ++d)
        result[m][d] += t * (b[m][d] - a[m][d]);
    return result;
  }

  void examine(const std::vector<Point>& nodes, const Jacobian_bounds& b, bool is_thorough)
  {
    ++cells;
    valid += b.verdict == Validity::valid;
    invalid += b.verdict == Validity::invalid;
    undecided += b.verdict == Validity::undecided;
    exact += b.is_exact;
    std::vector<std::pair<double, std::size_t>> values;
    for (std::size_t s = 0; s < samples_.size(); ++s)
      values.emplace_back(samples_[s].jacobian(nodes), s);
    std::sort(values.begin(), values.end());
    const double least = values.front().first, largest = values.back().first;
    // Samples are rounded: they accuse, exact evaluation at their points convicts.
    bool is_wrong = false;
    if (least < b.lower || (least <= 0 && b.verdict == Validity::valid))
      is_wrong = is_refuted(nodes, b, points_[values.front().second]);
    if (largest > b.upper)
      is_wrong = is_wrong || is_refuted(nodes, b, points_[values.back().second]);
    if (b.verdict == Validity::valid)
      least_margin = std::min(least_margin, least / largest);
    if (is_thorough)
      is_wrong = is_wrong || is_refuted_below(nodes, b, values);
    wrong += is_wrong;
    if (is_wrong)
      std::cout << "wrong: " << element_name(type_) << " of degree " << degree_ << ", cell " << cells << '\n';
  }

  /// whether det J contradicts the bounds where `cube` is in the element; exactly there, since bounds may be so sharp
  /// that a point outside by a rounding is out of them.
  bool is_refuted(const std::vector<Point>& nodes, const Jacobian_bounds& b, const Reference_point& cube) const
  {
    const Fraction value = oracle_.jacobian(nodes, into_element(type_, fractions(cube)));
    return value < Fraction(b.lower) || (b.upper < infinity && value > Fraction(b.upper)) ||
           (b.verdict == Validity::valid && value <= 0);
  }

  /// descends from the lowest samples and evaluates exactly there. This cannot refute that a cell is inverted, but its
  /// smallest value is near zero if its verdict turns nearby: there should be a way down to it.
  bool is_refuted_below(const std::vector<Point>& nodes, const Jacobian_bounds& b,
                        const std::vector<std::pair<double, std::size_t>>& values)
  {
    ++descents;
    bool result = false;
    double least = infinity;
    for (std::size_t start = 0; start < std::min<std::size_t>(values.size(), 4); ++start)
    {
      const Reference_point p = descend(type_, degree_, nodes, points_[values[start].second], 25);
      result = result || is_refuted(nodes, b, p);
      least = std::min(least, sampled_jacobian(type_, degree_, nodes, into_element(type_, p)));
    }
    unexplained += b.verdict == Validity::invalid && least > 1e-3 * values.back().first;
    return result;
  }

  Element_type type_;
  int degree_;
  std::mt19937 random_;
  Exact_oracle oracle_;
  std::vector<Reference_point> points_; ///< of the cube
  std::vector<Sample> samples_;
};

} // namespace

TEST_CASE("bound_jacobian: a random search finds no wrong verdict", "[volume]")
{
  // Costs grow with the degree: most cells are quadratic, all types and degrees to 4 are there.
  const std::array<int, 5> shares = {10, 60, 24, 6, 0}; // of 100, for degrees 1 to 4
  const unsigned seed = 20;
  std::cout << "seed " << seed << '\n';
  // Each type and degree is a section: `-c "hexahedron p=4"` runs one of them.
  for (const Element_type type : all_cells)
    for (int degree = 1; degree <= 4; ++degree)
      DYNAMIC_SECTION(element_name(type) << " p=" << degree)
      {
        Search search(type, degree, seed + static_cast<unsigned>(degree));
        const int wanted = searched_cells() / 4 / 100 * shares[static_cast<std::size_t>(degree - 1)];
        while (search.cells < wanted)
          search.search_one_way();
        std::cout << element_name(type) << " p=" << degree << ": " << search.cells << " cells, " << search.valid
                  << " valid, " << search.invalid << " invalid, " << search.undecided << " undecided, " << search.exact
                  << " by exact arithmetic, " << search.descents << " descents (" << search.unexplained
                  << " in vain), smallest sample of a valid cell " << search.least_margin << ", wrong " << search.wrong
                  << std::endl;
        CHECK(search.wrong == 0);
        // A descent may end in another minimum: one in twenty, and one more where there are few.
        CHECK(20 * search.unexplained <= search.descents + 20);
        CHECK(search.valid > search.cells / 10);
        CHECK(search.invalid > search.cells / 10);
        CHECK(search.undecided < search.cells / 5); // half of the cells are within 1e-3 of the turn
      }
}

TEST_CASE("bound_jacobian: 10^5 samples per type and degree are enclosed", "[volume]")
{
  const Element_type type = GENERATE(from_range(all_cells));
  const int degree = GENERATE(1, 2, 3, 4, 5, 6);
  const unsigned seed = 30;
  CAPTURE(element_name(type), degree, seed);
  std::mt19937 random(seed);
  std::vector<Sample> samples;
  for (const Reference_point& p : sample_points(type, 6, 2000, random))
    samples.emplace_back(type, degree, p);
  const auto cells = 100000 / samples.size() + 1;
  for (std::size_t c = 0; c < cells; ++c)
  {
    const std::vector<Point> nodes = random_cell(type, degree, 0.05 * static_cast<double>(c % 9), random);
    const Jacobian_bounds b =
      bound_jacobian(type, degree, nodes, {.max_parts = 300, .sharpness = c % 2 == 0 ? infinity : 0.05});
    double least = infinity, largest = -infinity;
    for (const Sample& sample : samples)
    {
      least = std::min(least, sample.jacobian(nodes));
      largest = std::max(largest, sample.jacobian(nodes));
    }
    const double round_off = 1e-9 * std::max(largest, -least);
    REQUIRE(b.lower <= least + round_off);
    REQUIRE(b.upper >= largest - round_off);
    REQUIRE(b.reached >= b.lower);
    if (b.verdict == Validity::valid)
      REQUIRE(b.scaled <= least / largest + 1e-9);
  }
}

TEST_CASE("bound_jacobians: curved meshes of another program", "[volume]")
{
  struct Case
  {
    std::string stem;
    std::array<Index, 4> inverted; ///< at degrees 1 to 4
  };
  // Two edges of a hexahedron or pyramid lie on the circle of the cylinder: their corner opens to 180 degrees, and
  // past it where degree 3 and 4 overshoot. Gmsh's own determinants at these corners are negative as well.
  const Case mesh = GENERATE(Case{"tet_sphere_R0.5_in_box", {0, 1, 1, 1}}, Case{"hex_annulus_R0.5_R2", {0, 0, 0, 0}},
                             Case{"prism_annulus_R0.5_R2", {0, 0, 0, 0}},
                             Case{"mixed_pyr_tet_hex_cylinder_R1", {0, 0, 12 + 4, 12 + 4}});
  const int degree = GENERATE(1, 2, 3, 4);
  CAPTURE(mesh.stem, degree);
  const auto file = test::shared_data("curved/" + mesh.stem + "_p" + std::to_string(degree) + "_v22.msh");
  if (!file)
    return;
  const Msh_cells cells = Msh_file(*file, degree).read();
  std::vector<Element_block> blocks;
  for (const auto& [type, nodes] : cells.cells)
    blocks.push_back({type, nodes});
  REQUIRE(!blocks.empty());
  const Jacobian_report report = bound_jacobians(cells.nodes, blocks, degree);
  const auto total = report.total();
  std::cout << mesh.stem << " p=" << degree << ": " << total.valid << " valid, " << total.invalid << " invalid, "
            << total.undecided << " undecided; " << report.subdivided_elements << " subdivided, "
            << report.exact_elements << " exact; smallest certified scaled Jacobian " << report.least_valid.scaled
            << '\n';
  CHECK(total.invalid == mesh.inverted[static_cast<std::size_t>(degree - 1)]);
  CHECK(total.undecided == 0);
}
