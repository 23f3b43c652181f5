// Shapes whose feature curves are known, detected with the default options: all of the true edges, and no others.
#include "support/feature_check.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>

using namespace recurve;
using namespace recurve::test;

namespace {

const Split all_splits[] = {Split::quads, Split::same, Split::alternating};

struct Expected
{
  int edges, corners;
  int false_edges = 0;
};

void require_features(const std::string& name, const std::function<Surface(Split)>& make, Expected expected)
{
  for (const Split split : all_splits)
  {
    const Score score = detect(make(split)).score;
    CAPTURE(name, static_cast<int>(split));
    CHECK(score.truth == expected.edges);
    CHECK(score.hits == expected.edges);
    CHECK(score.false_edges == expected.false_edges);
    CHECK(score.sharp_vertices == expected.corners);
  }
}

} // namespace

TEST_CASE("sharp-edged solids: every edge and corner")
{
  require_features("cube, one face a side", [](Split s) { return cube(1, s); }, {12, 8});
  require_features("cube", [](Split s) { return cube(4, s); }, {48, 8});
  require_features("bracket with a concave edge", l_bracket, {44, 12});
  require_features("quarter of a disc", [](Split s) { return quarter_disc_prism(6, s); }, {33, 6});
}

TEST_CASE("curves per solid")
{
  const auto curves = [](const Surface& s) { return detect(s).report.curves; };
  CHECK(curves(cube(4, Split::same)).size() == 12);
  CHECK(curves(l_bracket(Split::same)).size() == 18);
  CHECK(curves(quarter_disc_prism(6, Split::same)).size() == 9);
  const auto rims = curves(cylinder(24, 4, true, Split::quads));
  REQUIRE(rims.size() == 2);
  for (const auto& rim : rims)
  {
    CHECK(rim.is_closed);
    CHECK(rim.first_end == Curve_end::none);
    CHECK(rim.edges == 24);
    CHECK(rim.length == Approx(48 * std::sin(pi / 24)));
    CHECK(rim.max_dihedral == Approx(90));
    CHECK_FALSE(rim.is_pinned);
  }
}

TEST_CASE("cylinders: the rims, however coarse the round side")
{
  for (const int n : {48, 24, 12, 9})
    require_features("closed " + std::to_string(n), [n](Split s) { return cylinder(n, 4, true, s); }, {2 * n, 0});
  // the rim itself turns by 45 and 60 degrees: corners
  for (const int n : {8, 6})
    require_features("closed " + std::to_string(n), [n](Split s) { return cylinder(n, 4, true, s); }, {2 * n, 2 * n});
  for (const int n : {24, 12})
    require_features("open " + std::to_string(n), [n](Split s) { return cylinder(n, 4, false, s); }, {0, 0});
}

TEST_CASE("a can that its mesh folds: the rims tell that it is round")
{
  const Surface can = folded_can();
  const Detection found = detect(can);
  CHECK(found.score.truth == 14);
  CHECK(found.score.is_exact());
  CHECK(found.score.sharp_vertices == 14); // the rims turn by 51 degrees at each of their vertices
  // the fold is as steep as an edge: a threshold takes all four rows of it
  CHECK(detect(can, {.method = Feature_method::dihedral, .dihedral_angle = 65}).score.false_edges == 4);
  CHECK(found.report.rejected_edges[static_cast<int>(Rejection::smooth)] == 4);
}

TEST_CASE("bars: every seam between flat sides, however few the cells")
{
  for (const int n : {3, 4, 5, 6, 7})
    for (const int cells : {2, 4})
      for (const int rows : {1, 4})
        require_features(std::to_string(n) + " sides of " + std::to_string(cells),
                         [=](Split s) {
                           return bar(regular_polygon(n), std::vector<int>(static_cast<std::size_t>(n), cells), rows,
                                      s);
                         },
                         {n * (2 * cells + rows), 2 * n});
  for (const int n : {3, 4, 5})
    require_features(
      std::to_string(n) + " sides of one cell",
      [=](Split s) { return bar(regular_polygon(n), std::vector<int>(static_cast<std::size_t>(n), 1), 4, s); },
      {6 * n, 2 * n});
  for (const int rows : {1, 2, 4, 8})
    for (const double size : {0.1, 0.4})
      require_features("chamfer",
                       [=](Split s) {
                         return bar({{0, 0}, {2 - size, 0}, {2, size}, {2, 1}, {0, 1}}, {8, 2, 4, 8, 4}, rows, s);
                       },
                       {2 * 26 + 5 * rows, 10});
  for (const int rows : {2, 8})
    require_features("a bend of 30 degrees",
                     [=](Split s) {
                       return bar({{0, 0}, {1, 0}, {1 + std::cos(pi / 6), std::sin(pi / 6)}, {2, 1.5}, {0, 1.5}},
                                  {4, 4, 4, 8, 4}, rows, s);
                     },
                     {2 * 24 + 5 * rows, 10});
}

TEST_CASE("cones: the rim, and the tip where it is sharp")
{
  require_features("steep", [](Split s) { return cone(24, std::sqrt(3.), s); }, {24, 1});
  require_features("flat", [](Split s) { return cone(24, 0.5, s); }, {24, 0});
  const auto report = detect(cone(24, std::sqrt(3.), Split::same)).report;
  CHECK(report.isolated_corners == 1);
  CHECK(report.rejected_edges[static_cast<int>(Rejection::overshadowed)] == 96);
}

TEST_CASE("smooth closed surfaces have no features, however coarse")
{
  for (const int level : {0, 1, 2, 3})
    CHECK(detect(icosphere(level)).report.critical_edges == 0);
  for (const auto& [n, rows] : {std::pair{16, 8}, std::pair{24, 12}, std::pair{36, 18}})
    require_features("sphere", [n = n, rows = rows](Split s) { return uv_sphere(n, rows, s); }, {0, 0});
  for (const auto& [n, m] : {std::pair{24, 12}, std::pair{48, 24}})
    require_features("torus", [n = n, m = m](Split s) { return torus(n, m, s); }, {0, 0});
}

TEST_CASE("a shallow joint of two round surfaces is one loop")
{
  for (const int degrees : {15, 20, 30})
    require_features("joint", [=](Split s) { return frustum_joint(degrees, 24, s); }, {24, 0});
  require_features("shallow joint", [](Split s) { return frustum_joint(12, 48, s); }, {48, 0});
}

TEST_CASE("wings: trailing edge and tip, nothing at the leading edge")
{
  for (const int nc : {32, 64})
    require_features("sharp", [nc](Split s) { return wing(nc, false, s); }, {2 * nc + 8, 1});
  require_features("blunt", [](Split s) { return wing(32, true, s); }, {2 * 32 + 1 + 16, 2});
  // 60 degrees at the leading edge, and its rim turns there by as much: a corner
  require_features("16 steps", [](Split s) { return wing(16, false, s); }, {2 * 16 + 8, 2});
  require_features("16 steps, blunt", [](Split s) { return wing(16, true, s); }, {2 * 16 + 1 + 16, 3});
  // with so few points the leading edge is as sharp as an edge can be: 100 degrees at eight steps a side
  require_features("eight steps", [](Split s) { return wing(8, false, s); }, {24, 4, 24});
}

TEST_CASE("creases from border to border are kept down to the weak angle")
{
  for (const int degrees : {12, 20, 30, 45, 80})
    require_features("crease", [=](Split s) { return crease([=](double) { return degrees; }, s); }, {16, 0});
}

TEST_CASE("a crease that fades out is kept as far as it is one")
{
  for (const Split split : all_splits)
    for (const double from : {30., 60., 90.})
    {
      const auto degrees = [=](double x) { return from * (1 - x); };
      const Score score = detect(crease(degrees, split)).score;
      // edge i goes from i / 16 to (i + 1) / 16; it bends by about the angle in between
      int above_weak_angle = 0;
      for (int i = 0; i < 16; ++i)
        above_weak_angle += degrees((i + 0.5) / 16) > Feature_options{}.weak_angle;
      CAPTURE(from, static_cast<int>(split));
      CHECK(std::abs(score.hits - above_weak_angle) <= 1);
      CHECK(score.false_edges == 0);
    }
  const Feature_options strict = {.crease_contrast = std::numeric_limits<double>::infinity()};
  CHECK(detect(crease([](double x) { return 30 * (1 - x); }, Split::quads), strict).report.rejected_edges[0] > 0);
}

TEST_CASE("a crease in the middle of a face, fading out at both ends")
{
  for (const Split split : all_splits)
  {
    const Score score = detect(crease([](double x) { return 40 * std::sin(pi * x); }, split)).score;
    CHECK(score.hits >= 12);
    CHECK(score.false_edges == 0);
  }
}

TEST_CASE("a chamfer has two seams, a rounded edge none")
{
  require_features("chamfer", [](Split s) { return rounded_edge(1, s); }, {16, 0});
  for (const int n : {2, 3, 4, 6, 9})
    require_features("rounded", [n](Split s) { return rounded_edge(n, s); }, {0, 0});
}

TEST_CASE("a rough sheet has no features")
{
  // 20 x 20 points as well as cells; at 0.4 of a cell every fourth edge is steeper than 30 degrees, some reach 90
  const unsigned seeds = 40;
  for (unsigned seed = 1; seed <= seeds; ++seed)
    for (const Split split : all_splits)
      for (const int n : {19, 20})
        for (const double height : {0.1, 0.4})
        {
          CAPTURE(seed, static_cast<int>(split), n, height);
          CHECK(detect(rough_sheet(n, height, split, seed)).score.false_edges == 0);
        }
}

TEST_CASE("noise makes no features")
{
  const unsigned seed = GENERATE(1u, 2u, 3u, 4u, 5u);
  CAPTURE(seed);
  for (const double size : {0.005, 0.01, 0.02, 0.03})
    CHECK(detect(roughen(icosphere(3), size, seed)).report.critical_edges == 0);
  for (const Split split : all_splits)
  {
    const Score rough_cube = detect(roughen(cube(8, split), 0.02, seed)).score;
    CHECK(rough_cube.hits >= 94); // of 96
    CHECK(rough_cube.false_edges <= 3);
    CHECK(detect(roughen(cube(8, split), 0.01, seed)).score.is_exact());
    CHECK(detect(roughen(cylinder(24, 4, true, split), 0.02, seed)).score.is_exact());
  }
}

TEST_CASE("noise hides no creases")
{
  const unsigned seed = GENERATE(1u, 2u, 3u, 4u, 5u);
  CAPTURE(seed);
  for (const Split split : all_splits)
  {
    // off by a twenty-fifth of an edge, and by a twelfth
    CHECK(detect(roughen(crease([](double) { return 20.; }, split), 0.0025, seed)).score.is_exact());
    CHECK(detect(roughen(crease([](double) { return 45.; }, split), 0.005, seed)).score.is_exact());
    CHECK(detect(roughen(rounded_edge(1, split), 0.005, seed)).score.is_exact());
    CHECK(detect(roughen(cube(1, split), 0.1, seed)).score.is_exact());
    CHECK(detect(roughen(cube(2, split), 0.03, seed)).score.is_exact());
  }
}
