// The fast sum against the plain one on the boundaries of real meshes. It stands with the tests of the whole conversion
// since it reads meshes.
#include <support/shared_data.h>

#include <recurve/io/mesh_io.h>
#include <recurve/mesh/join_zones.h>
#include <recurve/run/curve_mesh.h>
#include <recurve/volume/boundary_sources.h>
#include <recurve/volume/deform_interior.h>

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

using namespace recurve;

namespace {

/// What a conversion would hand to the deformation: all nodes of the boundary, how curving displaces them, and some
/// nodes of the interior, more of them near the boundary as most layers are there.
struct Boundary
{
  std::string name;
  std::vector<Point> sources, curving, targets;
  std::vector<double> areas;
  double length = 0;
};

Boundary boundary_of(const std::string& file, std::size_t target_count)
{
  Boundary result{file, {}, {}, {}, {}, 0};
  const auto path = test::shared_data(file);
  if (!path)
    return result;
  const Curved_mesh curved = curve_mesh(read_mesh(*path), {.degree = 2, .deform = false});
  const Curved_mesh straight = elevate(curved.linear, join_zones(curved.linear), 2);
  std::vector<char> is_source(straight.nodes.size(), 0);
  std::vector<Curved_section> faces;
  for (const Curved_zone& zone : straight.zones)
    faces.insert(faces.end(), zone.faces.begin(), zone.faces.end());
  for (const Curved_section& section : faces)
    for (const Index node : section.nodes)
      is_source[static_cast<std::size_t>(node)] = 1;
  result.length = mean_edge_length(straight.nodes, faces, 2);
  const std::vector<double> areas = node_areas(straight.nodes, faces, 2);
  std::vector<Point> inside;
  for (std::size_t n = 0; n < straight.nodes.size(); ++n)
    if (is_source[n])
    {
      const Point &a = straight.nodes[n], &b = curved.nodes[n];
      result.sources.push_back(a);
      result.curving.push_back({b[0] - a[0], b[1] - a[1], b[2] - a[2]});
      result.areas.push_back(areas[n]);
    }
    else
      inside.push_back(straight.nodes[n]);
  std::mt19937 random(41);
  std::sample(inside.begin(), inside.end(), std::back_inserter(result.targets), target_count, random);
  return result;
}

const std::vector<Boundary>& boundaries()
{
  // a wing with prisms of 1600 to 1, scattered triangles; a blade between dense planes, anisotropic quadrangles
  static const std::vector<Boundary> all = {boundary_of("wing/gmsh_om6_hybrid_coarse.cgns", 600),
                                            boundary_of("blade/ls89_vki_blade_hex.cgns", 400)};
  return all;
}

std::vector<Point> smooth_field(const Boundary& boundary)
{
  double size = 0;
  for (const Point& p : boundary.sources)
    size = std::max(size, std::hypot(p[0], p[1], p[2]));
  std::vector<Point> field;
  for (const Point& p : boundary.sources)
    field.push_back({std::sin(3 * p[0] / size), std::cos(2 * p[1] / size), p[2] / size});
  return field;
}

} // namespace

TEST_CASE("the fast sum keeps its bound on the boundaries of real meshes")
{
  const auto& boundary = GENERATE_REF(from_range(boundaries()));
  if (boundary.sources.empty())
    return;
  const bool is_curving = GENERATE(true, false), has_areas = GENERATE(false, true);
  CAPTURE(boundary.name, boundary.sources.size(), is_curving, has_areas);
  const std::vector<Point> given = is_curving ? boundary.curving : smooth_field(boundary);
  const std::vector<double> weights = has_areas ? boundary.areas : std::vector<double>{};
  const auto evaluate = [&](const Summation_options& options, Deformation_report& report) {
    std::vector<Point> result(boundary.targets.size());
    Deformation_options formula = {.length = boundary.length};
    formula.summation = options;
    report = interior_displacements(boundary.sources, given, boundary.targets, result, formula, weights);
    return result;
  };
  Deformation_report report;
  const auto plain = evaluate({.method = Summation::plain}, report);
  for (const double bound : {1e-2, 1e-4, 1e-6})
  {
    const auto fast = evaluate({.method = Summation::fast, .error_bound = bound}, report);
    double error = 0;
    for (std::size_t m = 0; m < fast.size(); ++m)
      error = std::max(error, std::hypot(fast[m][0] - plain[m][0], fast[m][1] - plain[m][1], fast[m][2] - plain[m][2]));
    CAPTURE(bound, report.error_bound, error / report.largest_given);
    CHECK(report.is_fast);
    CHECK(report.error_bound <= bound);
    CHECK(error <= report.error_bound * report.largest_given);
    CHECK(report.pairs < report.sources * report.targets);
  }
}
