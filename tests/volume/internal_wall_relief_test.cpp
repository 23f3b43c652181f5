#include <recurve/volume/bound_jacobian.h>
#include <recurve/volume/internal/lone_cell.h>
#include <recurve/volume/internal/wall_parts.h>

#include <volume/jacobian_oracles.h>
#include <volume/small_meshes.h>

#include <catch2/catch.hpp>

#include <map>

using namespace recurve;
using namespace recurve::internal;
using namespace recurve::tests;

namespace {

/// what the nodes inside a face keep if edge e keeps `shares[e]` and is displaced by `lengths[e]`.
std::map<int, double> followers(Element_type type, int degree, const std::vector<double>& shares,
                                const std::vector<double>& lengths)
{
  std::map<int, double> result;
  follow_edges(
    type, degree,
    [&](int m) {
      for (int e = 0; e < reference_element(type).edge_count; ++e)
        for (const int inside : inside_edge(type, degree, e))
          if (inside == m)
            return Kept_displacement{shares[std::size_t(e)], lengths[std::size_t(e)]};
      FAIL("asked about a node that is inside no edge");
      return Kept_displacement();
    },
    [&](int m, double share) { result[m] = share; });
  return result;
}

std::vector<Point> straight_nodes(Element_type type, int degree)
{
  std::vector<Point> result;
  result.reserve(static_cast<std::size_t>(node_count(type, degree)));
  for (int m = 0; m < node_count(type, degree); ++m)
    result.push_back(reference_point(type, degree, m));
  return result;
}

} // namespace

TEST_CASE("faces follow their edges", "[volume]")
{
  const Element_type type = GENERATE(Element_type::triangle, Element_type::quadrangle);
  const int degree = GENERATE(3, 4, 6);
  const auto n = static_cast<std::size_t>(reference_element(type).edge_count);
  CAPTURE(element_name(type), degree);
  const std::vector<double> ones(n, 1);
  const auto first = first_interior_node(type, degree);

  for (const auto& [m, share] : followers(type, degree, std::vector<double>(n, 0.5), ones))
  {
    CHECK(m >= first);
    CHECK(share == Approx(0.5)); // as all edges
  }
  for (const auto& [m, share] : followers(type, degree, ones, ones))
    CHECK(share == 1);
  for (const auto& [m, share] : followers(type, degree, std::vector<double>(n, 0.0), std::vector<double>(n, 0.0)))
    CHECK(share == 1); // flat edges have nothing to lose
  for (std::size_t e = 0; e < n; ++e)
  {
    std::vector<double> one_lowered = ones, only_it = std::vector<double>(n, 0.0);
    one_lowered[e] = 0.5;
    only_it[e] = 1;
    for (const auto& [m, share] : followers(type, degree, one_lowered, only_it))
      CHECK(share == Approx(0.5)); // all of the bulge comes from that edge
    double sum = 0;
    for (const auto& [m, share] : followers(type, degree, one_lowered, ones))
    {
      CHECK(share > 0.5);
      CHECK(share < 1);
      sum += 1 - share;
    }
    CHECK(sum > 0);
  }
  // Near the lowered edge more is lost than far from it: the first inner node lies beside edge 0, the last one away.
  std::vector<double> lowered = ones;
  lowered[0] = 0;
  const auto kept = followers(type, degree, lowered, ones);
  if (degree > 3 || type == Element_type::quadrangle)
    CHECK(kept.at(first) < kept.rbegin()->second);
}

TEST_CASE("what of a cell lies on the wall", "[volume]")
{
  const Wall_parts parts(Element_type::tetrahedron, 3, [](int m) {
    return reference_point(Element_type::tetrahedron, 3, m)[2] == 0; // its first face
  });
  CHECK(parts.faces == std::vector<int>{0});
  CHECK(parts.edges == std::vector<int>{0, 1, 2});
  const Wall_parts none(Element_type::hexahedron, 1, [](int) { return true; });
  CHECK((none.edges.empty() && none.faces.empty())); // nothing that could be lowered
}

TEST_CASE("a lone cell: the room that fixed nodes leave", "[volume]")
{
  const Element_type type = GENERATE(from_range(cell_types));
  const int degree = GENERATE(2, 3);
  CAPTURE(element_name(type), degree);
  const std::vector<Point> straight = straight_nodes(type, degree);
  const auto is_valid = [&](std::span<const Point> positions) {
    return bound_jacobian(type, degree, positions).verdict == Validity::valid;
  };
  // Two faces, which share edge 0: there they alone decide.
  const auto is_fixed = [&](std::size_t m) {
    return straight[m][1] == 0 || straight[m][2] == 0 || int(m) < corner_count(type);
  };
  Lone_cell cell(type, degree, straight, [&](std::size_t m) { return !is_fixed(m); });
  CHECK(cell.room(straight, 0, 2, is_valid) == Approx(1));

  std::vector<Point> torn = straight; // inner nodes thrown together: they find back
  for (std::size_t m = 0; m < torn.size(); ++m)
    if (!is_fixed(m))
      for (std::size_t d = 0; d < 3; ++d)
        torn[m][d] += 0.2 * (0.4 - torn[m][d]);
  CHECK(cell.room(torn, 0, 2, is_valid) == Approx(1).epsilon(0.05));

  std::vector<Point> folded = straight; // the edge from corner 0 to corner 1 runs back at its end
  for (const int m : inside_edge(type, degree, 0))
    folded[std::size_t(m)][0] += 2;
  CHECK(cell.room(folded, 0, 2, is_valid) == 0);
  CHECK(cell.room(straight, 2, 2, is_valid) == 0); // no determinant at fixed points is twice that of the straight cell
}
