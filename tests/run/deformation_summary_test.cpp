#include <recurve/run/deformation_summary.h>

#include <generate/cylinder_layer.h>
#include <recurve/core/exceptions.h>
#include <recurve/mesh/join_zones.h>
#include <recurve/run/curve_mesh.h>

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <numeric>
#include <set>

using namespace recurve;
using generate::cylinder_layer;

namespace {

Curved_mesh straight_of(const Volume_mesh& mesh, int degree)
{
  return elevate(mesh, join_zones(mesh), degree);
}

/// the nodes of a patch of a mesh of one zone.
std::set<Index> nodes_of_patch(const Curved_mesh& mesh, const std::string& name)
{
  std::set<Index> result;
  for (const Patch& patch : mesh.linear.zones[0].patches)
    for (const Index face : patch.faces)
      if (patch.name == name)
      {
        const Section_entry at = find_element(mesh.linear.zones[0].faces, face);
        const Curved_section& section = mesh.zones[0].faces[static_cast<std::size_t>(at.section)];
        const auto n = static_cast<std::ptrdiff_t>(node_count(section.type, mesh.degree));
        result.insert(section.nodes.begin() + at.element * n, section.nodes.begin() + (at.element + 1) * n);
      }
  return result;
}

double distance(const Point& a, const Point& b)
{
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

const Point& at(const Curved_mesh& mesh, Index node)
{
  return mesh.nodes[static_cast<std::size_t>(node)];
}

constexpr generate::Cylinder_mesh_options thin_layers = {.around = 16, .along = 2, .layers = 16, .first_layer = 1e-4};

/// A twisted sector of the space between two cylinders, whose flanks are a rotation of `angle` about the z axis apart.
struct Sector
{
  static constexpr int around = 3, along = 2, layers = 6;
  static constexpr double angle = 0.5;

  static Index number(int a, int layer, int k) { return (Index(k) * (layers + 1) + layer) * (around + 1) + a; }

  static Volume_mesh mesh()
  {
    Zone zone;
    zone.name = "sector";
    for (int k = 0; k <= along; ++k)
      for (int layer = 0; layer <= layers; ++layer)
        for (int a = 0; a <= around; ++a)
        {
          const double r = 1 + 0.002 * (std::pow(2.5, layer) - 1);
          const double t = angle * a / around + 0.3 * k * std::sin(2 * r);
          zone.points.push_back({r * std::cos(t), r * std::sin(t), 0.3 * k});
        }
    zone.cells = {{"cells", Element_type::hexahedron, {}}};
    for (int k = 0; k < along; ++k)
      for (int layer = 0; layer < layers; ++layer)
        for (int a = 0; a < around; ++a)
          for (const auto& d : {std::array{0, 0, 0}, std::array{0, 1, 0}, std::array{1, 1, 0}, std::array{1, 0, 0},
                                std::array{0, 0, 1}, std::array{0, 1, 1}, std::array{1, 1, 1}, std::array{1, 0, 1}})
            zone.cells[0].nodes.push_back(number(a + d[0], layer + d[1], k + d[2]));
    add_patch(zone, "wall", around, along, [](int i, int j) { return number(i, 0, j); });
    add_patch(zone, "outer", around, along, [](int i, int j) { return number(i, layers, j); });
    add_patch(zone, "low", layers, along, [](int i, int j) { return number(0, i, j); });
    add_patch(zone, "high", layers, along, [](int i, int j) { return number(around, i, j); });
    add_patch(zone, "bottom", around, layers, [](int i, int j) { return number(i, j, 0); });
    add_patch(zone, "top", around, layers, [](int i, int j) { return number(i, j, along); });
    for (const bool is_back : {false, true})
    {
      Zone_interface interface {
        is_back ? "back" : "forth", "sector", Zone_interface::Location::vertex, true, {}, {}, {}
      };
      interface.periodicity = Periodicity{{}, {0, 0, is_back ? -angle : angle}, {}};
      for (int k = 0; k <= along; ++k)
        for (int layer = 0; layer <= layers; ++layer)
        {
          interface.points.push_back(number(is_back ? around : 0, layer, k));
          interface.donor_points.push_back(number(is_back ? 0 : around, layer, k));
        }
      zone.interfaces.push_back(interface);
    }
    Volume_mesh result;
    result.zones = {zone};
    return result;
  }

private:
  static void add_patch(Zone& zone, const std::string& name, int m, int n, const std::function<Index(int, int)>& corner)
  {
    Section section{name, Element_type::quadrangle, {}};
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < m; ++i)
        for (const Index node : {corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)})
          section.nodes.push_back(node);
    Patch patch{name, "BCWall", "", std::vector<Index>(static_cast<std::size_t>(section.size()))};
    std::iota(patch.faces.begin(), patch.faces.end(), zone.face_count());
    zone.faces.push_back(section);
    zone.patches.push_back(patch);
  }
};

} // namespace

TEST_CASE("layers thinner than the bulge of the wall fold where only the wall is curved, and not where they follow")
{
  const int degree = GENERATE(2, 3, 4);
  const bool has_prisms = GENERATE(false, true);
  CAPTURE(degree, has_prisms);
  generate::Cylinder_mesh_options shape = thin_layers;
  shape.has_prisms = has_prisms;
  const Volume_mesh linear = cylinder_layer(shape);
  // The wall bulges by 96 heights of the first cell.
  REQUIRE(shape.radius * (1 - std::cos(std::numbers::pi / shape.around)) > 95 * shape.first_layer);

  Curving_report report;
  const Curved_mesh curved = curve_mesh(linear, {.degree = degree, .record_jacobians = true}, &report);
  const Curved_mesh straight = straight_of(linear, degree);
  REQUIRE(report.jacobians.stages.size() == 4);
  CHECK(report.jacobians.stages[0].inverted == 0);
  CHECK(report.jacobians.stages[1].inverted >= shape.around * shape.along); // at least the cells at the wall
  CHECK(report.jacobians.stages[2].inverted == 0);
  CHECK(report.jacobians.stages[3].inverted == 0);
  CHECK(report.certification.bounds.scaled.size() == static_cast<std::size_t>(report.cells));
  CHECK(std::ranges::all_of(report.certification.bounds.scaled, [](double scaled) { return scaled > 0; }));
  // Corners stay.
  for (std::size_t n = 0; n < linear.zones[0].points.size(); ++n)
    CHECK(curved.nodes[n] == linear.zones[0].points[n]);
  // The ends of the cylinder follow their rim in their plane, to the bit.
  CHECK(report.deformation.planar_patches == 2);
  CHECK(report.deformation.planar_nodes > 0);
  for (const char* patch : {"z_low", "z_high"})
    for (const Index node : nodes_of_patch(curved, patch))
      CHECK(at(curved, node)[2] == (patch[2] == 'l' ? 0.0 : shape.length));
  // A cell is straight as marked.
  Index moved = 0;
  for (std::size_t n = 0; n < curved.nodes.size(); ++n)
    moved += curved.nodes[n] != straight.nodes[n];
  CHECK(moved > report.moved_edge_nodes + report.moved_face_nodes);
  CHECK(report.deformation.field.sources > 0);
  CHECK(report.deformation.field.moving_sources < report.deformation.field.sources);
}

TEST_CASE("planes in any direction stay planes")
{
  const int degree = GENERATE(2, 3);
  Volume_mesh linear = cylinder_layer(thin_layers);
  // z becomes the direction (2, -1, 2) / 3.
  const std::array<Point, 3> axes = {{{2. / 3, 2. / 3, -1. / 3}, {-1. / 3, 2. / 3, 2. / 3}, {2. / 3, -1. / 3, 2. / 3}}};
  for (Point& p : linear.zones[0].points)
  {
    const Point q = p;
    for (std::size_t d = 0; d < 3; ++d)
      p[d] = q[0] * axes[0][d] + q[1] * axes[1][d] + q[2] * axes[2][d];
  }
  Curving_report report;
  const Curved_mesh curved = curve_mesh(linear, {.degree = degree, .record_jacobians = true}, &report);
  CHECK(report.deformation.planar_patches == 2);
  CHECK(report.jacobians.stages[2].inverted == 0);
  const auto height = [&](const Point& p) { return p[0] * axes[2][0] + p[1] * axes[2][1] + p[2] * axes[2][2]; };
  // Coordinates up to 5 are rounded to half a unit in their last place, the corners' too.
  const double tolerance = 5 * 8 * std::numeric_limits<double>::epsilon();
  for (const char* patch : {"z_low", "z_high"})
    for (const Index node : nodes_of_patch(curved, patch))
      CHECK(std::abs(height(at(curved, node)) - (patch[2] == 'l' ? 0.0 : thin_layers.length)) < tolerance);
}

TEST_CASE("patches that are a translation apart move alike, to the bit")
{
  const int degree = GENERATE(2, 3);
  const Volume_mesh linear = cylinder_layer(thin_layers);
  Curving_report report;
  const Curved_mesh curved = curve_mesh(linear, {.degree = degree, .periodic = {{"z_low", "z_high"}}}, &report);
  const auto low = nodes_of_patch(curved, "z_low"), high = nodes_of_patch(curved, "z_high");
  CHECK(report.deformation.periodic_pairs == static_cast<Index>(low.size()));
  std::set<std::array<double, 2>> of_low, of_high;
  for (const Index node : low)
    of_low.insert({at(curved, node)[0], at(curved, node)[1]});
  for (const Index node : high)
    of_high.insert({at(curved, node)[0], at(curved, node)[1]});
  CHECK(of_low.size() == low.size());
  CHECK(of_low == of_high);
  const auto pair = [&](const char* a, const char* b) {
    Curving_options options = {.degree = 2};
    options.periodic = {{a, b}};
    return curve_mesh(linear, options);
  };
  CHECK_THROWS_AS(pair("z_low", "z_middle"), Input_error);
  CHECK_THROWS_AS(pair("z_low", "cylinder"), Input_error);
}

TEST_CASE("the flanks of a sector that the mesh calls periodic stay a rotation apart")
{
  const int degree = GENERATE(2, 3, 4);
  CAPTURE(degree);
  const Volume_mesh linear = Sector::mesh();
  const Curved_mesh straight = straight_of(linear, degree);
  Curving_report report;
  const Curved_mesh curved = curve_mesh(linear, {.degree = degree}, &report);
  const auto low = nodes_of_patch(curved, "low"), high = nodes_of_patch(curved, "high");
  CHECK(report.deformation.periodic_pairs == static_cast<Index>(low.size()));
  const double c = std::cos(Sector::angle), s = std::sin(Sector::angle);
  Index moved = 0;
  for (const Index node : low)
  {
    const auto image = [&](const Point& p) { return Point{c * p[0] - s * p[1], s * p[0] + c * p[1], p[2]}; };
    const auto partner = std::ranges::find_if(
      high, [&](Index other) { return distance(at(straight, other), image(at(straight, node))) < 1e-9; });
    REQUIRE(partner != high.end());
    CHECK(distance(at(curved, *partner), image(at(curved, node))) < 1e-15 * 8);
    moved += at(curved, node) != at(straight, node);
  }
  CHECK(moved > 10);
}

TEST_CASE("beyond the influence radius every cell is straight, and nothing has moved")
{
  const Volume_mesh linear = cylinder_layer(thin_layers);
  const double radius = 0.3;
  Curving_options options = {.degree = 3, .keep = {"farfield", "z_low", "z_high"}};
  options.deformation.summation.reach = radius;
  const Curved_mesh curved = curve_mesh(linear, options), straight = straight_of(linear, 3);
  Index beyond = 0;
  for (std::size_t n = 0; n < curved.nodes.size(); ++n)
    // Nodes of the ends are within the radius of the wall, and what moves with them within the radius of those.
    if (std::hypot(straight.nodes[n][0], straight.nodes[n][1]) > thin_layers.radius + 2 * radius)
    {
      ++beyond;
      CHECK(curved.nodes[n] == straight.nodes[n]);
    }
  CHECK(beyond > 100);
  std::size_t cell = 0;
  for (const Curved_section& section : curved.zones[0].cells)
    for (std::size_t first = 0; first < section.nodes.size(); first += 64, ++cell)
    {
      const auto nodes = std::span(section.nodes).subspan(first, 64);
      const bool has_moved = std::ranges::any_of(nodes, [&](Index n) { return at(curved, n) != at(straight, n); });
      CHECK((curved.zones[0].is_straight[cell] == 0) == has_moved);
    }
}

TEST_CASE("weights by area, other exponents and the plain sum are options of the whole conversion")
{
  const Volume_mesh linear = cylinder_layer(thin_layers);
  const Curved_mesh by_default = curve_mesh(linear, {.degree = 2});
  Curving_options options = {.degree = 2, .record_jacobians = true};
  SECTION("area weights")
  {
    options.area_weights = true;
  }
  SECTION("exponents")
  {
    options.deformation.a = 3.5;
    options.deformation.b = 6;
  }
  SECTION("length and alpha")
  {
    options.deformation.length = 0.5;
    options.deformation.alpha = 0.5;
  }
  SECTION("an error bound")
  {
    options.deformation.summation.method = Summation::fast;
    options.deformation.summation.error_bound = 1e-8;
  }
  Curving_report report;
  const Curved_mesh curved = curve_mesh(linear, options, &report);
  CHECK(report.jacobians.stages[2].inverted == 0);
  CHECK(curved.nodes != by_default.nodes);
  CHECK(report.deformation.field.error_bound <= options.deformation.summation.error_bound);

  options.deformation.alpha = -1;
  CHECK_THROWS_AS(curve_mesh(linear, options), Input_error);
}
