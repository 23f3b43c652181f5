// What a deformation must leave as it was, on meshes that were not made here: planes, corners, periodic pairs,
// interfaces between zones, and cells beyond reach.
#include <support/shared_data.h>

#include <recurve/io/mesh_io.h>
#include <recurve/mesh/join_zones.h>
#include <recurve/run/curve_mesh.h>

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

using namespace recurve;

namespace {

const Point& at(const Curved_mesh& mesh, Index node)
{
  return mesh.nodes[static_cast<std::size_t>(node)];
}

double distance(const Point& a, const Point& b)
{
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

/// A mesh before and after.
struct Conversion_result
{
  Curved_mesh straight, curved;
  Curving_report report;
};

std::optional<Conversion_result> convert(const std::string& file, const Curving_options& options)
{
  const auto path = test::shared_data(file);
  if (!path)
    return std::nullopt;
  Conversion_result result;
  result.curved = curve_mesh(read_mesh(*path), options, &result.report);
  result.straight = elevate(result.curved.linear, join_zones(result.curved.linear), options.degree);
  return result;
}

/// the nodes of a patch, in whichever zones it is.
std::set<Index> nodes_of_patch(const Curved_mesh& mesh, const std::string& name)
{
  std::set<Index> result;
  for (std::size_t z = 0; z < mesh.zones.size(); ++z)
    for (const Patch& patch : mesh.linear.zones[z].patches)
      for (const Index face : patch.faces)
        if (patch.name == name)
        {
          const Section_entry entry = find_element(mesh.linear.zones[z].faces, face);
          const Curved_section& section = mesh.zones[z].faces[static_cast<std::size_t>(entry.section)];
          const auto n = static_cast<std::ptrdiff_t>(node_count(section.type, mesh.degree));
          result.insert(section.nodes.begin() + entry.element * n, section.nodes.begin() + (entry.element + 1) * n);
        }
  return result;
}

Index moved_among(const Conversion_result& result, const std::set<Index>& nodes)
{
  return std::ranges::count_if(nodes, [&](Index n) { return at(result.curved, n) != at(result.straight, n); });
}

void check_corners_and_marks(const Conversion_result& result)
{
  const Curved_mesh &straight = result.straight, &curved = result.curved;
  const Curving_report& report = result.report;
  REQUIRE(straight.nodes.size() == curved.nodes.size());
  Index wrongly_marked = 0, straight_cells = 0, moved_corners = 0;
  for (const Curved_zone& zone : curved.zones)
  {
    std::size_t cell = 0;
    for (const Curved_section& section : zone.cells)
    {
      const auto n = static_cast<std::size_t>(node_count(section.type, curved.degree));
      const auto corners = static_cast<std::size_t>(corner_count(section.type));
      for (std::size_t first = 0; first < section.nodes.size(); first += n, ++cell)
      {
        const auto has_moved = [&](Index node) { return at(curved, node) != at(straight, node); };
        const auto nodes = std::span(section.nodes).subspan(first, n);
        wrongly_marked += std::ranges::any_of(nodes, has_moved) == (zone.is_straight[cell] != 0);
        moved_corners += std::ranges::any_of(nodes.first(corners), has_moved);
        straight_cells += zone.is_straight[cell] != 0;
      }
    }
  }
  CHECK(wrongly_marked == 0);
  CHECK(moved_corners == 0);
  CHECK(straight_cells == report.straight_cells);
  CHECK(report.certification.is_certified());
}

} // namespace

TEST_CASE(
  "a blade: periodic patches stay congruent, planes planes, and cells beyond reach are straight, all to the bit")
{
  constexpr double reach = 0.01; // an eighth of the chord
  Curving_options options = {.degree = 2, .periodic = {{"periodic_1", "periodic_2"}}};
  options.deformation.summation.reach = reach;
  const auto result = convert("blade/ls89_vki_blade_hex.cgns", options);
  if (!result)
    return;
  const Curved_mesh &straight = result->straight, &curved = result->curved;
  const Curving_report& report = result->report;
  check_corners_and_marks(*result);

  for (const char* patch : {"zmin", "zmax"})
  {
    const std::set<Index> nodes = nodes_of_patch(curved, patch);
    CHECK(moved_among(*result, nodes) > 0);
    CHECK(std::ranges::all_of(nodes, [&](Index n) { return at(curved, n)[2] == at(straight, *nodes.begin())[2]; }));
  }

  const std::set<Index> low = nodes_of_patch(curved, "periodic_1"), high = nodes_of_patch(curved, "periodic_2");
  REQUIRE(low.size() == high.size());
  CHECK(report.deformation.periodic_pairs == static_cast<Index>(low.size()));
  CHECK(moved_among(*result, low) > 0);
  std::array<Point, 2> sums = {};
  for (std::size_t side = 0; side < 2; ++side)
    for (const Index n : side == 0 ? low : high)
      for (std::size_t d = 0; d < 3; ++d)
        sums[side][d] += at(straight, n)[d] / static_cast<double>(low.size());
  const Point period = {sums[1][0] - sums[0][0], sums[1][1] - sums[0][1], sums[1][2] - sums[0][2]};
  Index incongruent = 0;
  for (const Index n : low)
  {
    const Point &p = at(straight, n), image = {p[0] + period[0], p[1] + period[1], p[2] + period[2]};
    const Index partner =
      *std::ranges::min_element(high, {}, [&](Index other) { return distance(at(straight, other), image); });
    // The file has the two sides a period apart up to rounding; the displacements are the same but for that of their
    // own addition to a coordinate.
    for (std::size_t d = 0; d < 3; ++d)
    {
      const double rounding = 4 * std::numeric_limits<double>::epsilon() * (std::abs(p[d]) + std::abs(image[d]));
      incongruent +=
        std::abs((at(curved, partner)[d] - at(straight, partner)[d]) - (at(curved, n)[d] - p[d])) > rounding;
    }
  }
  CHECK(incongruent == 0);

  // What moves within the planes and the periodic patches moves others too; whatever moves on the boundary counts.
  std::vector<Point> moving;
  for (const Patch& patch : curved.linear.zones[0].patches)
    for (const Index n : nodes_of_patch(curved, patch.name))
      if (at(curved, n) != at(straight, n))
        moving.push_back(at(straight, n));
  Index beyond = 0, moved_beyond = 0;
  for (std::size_t n = 0; n < curved.nodes.size(); n += 101)
    if (std::ranges::all_of(moving, [&](const Point& p) { return distance(p, straight.nodes[n]) > reach; }))
    {
      ++beyond;
      moved_beyond += curved.nodes[n] != straight.nodes[n];
    }
  CHECK(beyond > 0);
  CHECK(moved_beyond == 0);
}

TEST_CASE("a bend in two zones: what was one position on both sides of the interface still is")
{
  const int degree = GENERATE(2, 3);
  const auto result = convert("multizone/su2_bend_2zone_mixed.cgns", {.degree = degree});
  if (!result)
    return;
  const Curved_mesh &straight = result->straight, &curved = result->curved;
  const Curving_report& report = result->report;
  check_corners_and_marks(*result);
  // The zones share the nodes of the interface: whatever coincided, coincides.
  std::map<Point, Point> image;
  Index apart = 0;
  for (std::size_t n = 0; n < straight.nodes.size(); ++n)
    apart += image.emplace(straight.nodes[n], curved.nodes[n]).first->second != curved.nodes[n];
  CHECK(apart == 0);
  std::array<std::set<Index>, 2> nodes;
  for (std::size_t z = 0; z < 2; ++z)
    for (const Curved_section& section : curved.zones[z].cells)
      nodes[z].insert(section.nodes.begin(), section.nodes.end());
  std::set<Index> shared;
  std::ranges::set_intersection(nodes[0], nodes[1], std::inserter(shared, shared.begin()));
  CHECK(moved_among(*result, shared) > 0);
  CHECK(report.deformation.moved_nodes > 0);
}

TEST_CASE("a slice of a sphere: the symmetry plane across z stays to the bit, the oblique one to rounding")
{
  const auto result = convert("sphere/slice_2syms.cgns", {.degree = 3});
  if (!result)
    return;
  check_corners_and_marks(*result);
  CHECK(result->report.deformation.planar_patches == 2);
  const double angle = 9 * std::acos(-1) / 180; // between the planes, which meet in the x axis
  const std::set<Index> right = nodes_of_patch(result->curved, "symmetry_right"),
                        left = nodes_of_patch(result->curved, "symmetry_left");
  CHECK(moved_among(*result, right) > 0);
  CHECK(moved_among(*result, left) > 0);
  CHECK(std::ranges::all_of(right, [&](Index n) { return at(result->curved, n)[2] == 0; }));
  const auto off = [&](const Curved_mesh& mesh) {
    double largest = 0;
    for (const Index n : left)
      largest = std::max(largest, std::abs(std::cos(angle) * at(mesh, n)[2] - std::sin(angle) * at(mesh, n)[1]));
    return largest;
  };
  // The corners are as far off by rounding: coordinates are up to 10.
  CHECK(off(result->straight) < 1e-14);
  CHECK(off(result->curved) < 1e-14);
}

TEST_CASE("a coarse sphere: the one folded cell costs the two faces that it has there, whatever the degree")
{
  Curving_options options;
  options.degree = GENERATE(2, 3, 4);
  CAPTURE(options.degree);
  const auto result = convert("curved/tet_sphere_R0.5_in_box_p1_v22.msh", options);
  if (!result)
    return;
  const Certification& found = result->report.certification;
  CHECK(found.is_certified());
  CHECK(found.restoration.failing_cells == 1);
  CHECK(found.curved_faces == 78);
  REQUIRE(found.reduced_faces.size() == 2);
  for (const Reduced_face& face : found.reduced_faces)
  {
    CHECK(face.patch == "sphere");
    CHECK(face.factor >= 0.75);
  }
  CHECK(found.full_share() > 0.97);
}
