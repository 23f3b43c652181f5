#include "support/sphere_shell.h"

#include <recurve/core/exceptions.h>
#include <recurve/mesh/join_zones.h>
#include <recurve/run/curve_mesh.h>

#include <catch2/catch.hpp>

#include <map>
#include <numeric>
#include <random>
#include <set>

using namespace recurve;

namespace {

Curved_mesh elevated(Volume_mesh mesh, int degree)
{
  const Joined_zones joined = join_zones(mesh);
  return elevate(std::move(mesh), joined, degree);
}

double radius(const Point& point)
{
  return std::hypot(point[0], point[1], point[2]);
}

/// the nodes of all faces of a patch, in all zones.
std::set<Index> patch_nodes(const Curved_mesh& mesh, const std::string& name)
{
  std::set<Index> result;
  for (std::size_t z = 0; z < mesh.zones.size(); ++z)
    for (const Patch& patch : mesh.linear.zones[z].patches)
      for (Index face : patch.faces)
        if (patch.name == name)
        {
          const Section_entry entry = find_element(mesh.linear.zones[z].faces, face);
          const Curved_section& section = mesh.zones[z].faces[static_cast<std::size_t>(entry.section)];
          const int count = node_count(section.type, mesh.degree);
          for (Index n = entry.element * count; n < (entry.element + 1) * count; ++n)
            result.insert(section.nodes[static_cast<std::size_t>(n)]);
        }
  return result;
}

double largest_distance_to_sphere(const Curved_mesh& mesh, const std::set<Index>& nodes)
{
  double largest = 0;
  for (Index node : nodes)
    largest = std::max(largest, std::abs(radius(mesh.nodes[static_cast<std::size_t>(node)]) - 1));
  return largest;
}

Index straight_cells(const Curved_mesh& mesh)
{
  Index count = 0;
  for (const Curved_zone& zone : mesh.zones)
    count += std::count_if(zone.is_straight.begin(), zone.is_straight.end(), [](auto mark) { return mark != 0; });
  return count;
}

/// A box of n x n x n cells between random grid planes, six patches, as hexahedra or each cut into six tetrahedra.
Volume_mesh random_box(int n, Element_type type, unsigned seed)
{
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> step(0.3, 1.0);
  const Index planes_per_axis = n + 1;
  std::array<std::vector<double>, 3> planes;
  for (auto& axis : planes)
  {
    axis.resize(static_cast<std::size_t>(planes_per_axis));
    std::generate(axis.begin(), axis.end(), [&, x = 0.1]() mutable { return x += step(random); });
  }
  const auto number = [planes_per_axis](const std::array<int, 3>& lattice) {
    return (lattice[2] * planes_per_axis + lattice[1]) * planes_per_axis + lattice[0];
  };
  Zone zone;
  zone.name = "box";
  for (double z : planes[2])
    for (double y : planes[1])
      for (double x : planes[0])
        zone.points.push_back({x, y, z});
  zone.cells = {{"cells", type, {}}};
  const auto& corners = reference_element(Element_type::hexahedron).corners;
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i)
        if (type == Element_type::hexahedron)
          for (const auto& corner : corners)
            zone.cells[0].nodes.push_back(number({i + corner[0], j + corner[1], k + corner[2]}));
        else
        {
          std::array<int, 3> order = {0, 1, 2};
          do // Kuhn: one tetrahedron per order of the axes, along the diagonal
          {
            std::array<int, 3> lattice = {i, j, k};
            std::array<Index, 4> nodes = {number(lattice)};
            for (std::size_t step_number = 0; step_number < 3; ++step_number)
            {
              ++lattice[static_cast<std::size_t>(order[step_number])];
              nodes[step_number + 1] = number(lattice);
            }
            // An odd order of the axes gives the mirror image.
            const bool is_even = order[1] == (order[0] + 1) % 3;
            if (!is_even)
              std::swap(nodes[1], nodes[2]);
            zone.cells[0].nodes.insert(zone.cells[0].nodes.end(), nodes.begin(), nodes.end());
          } while (std::next_permutation(order.begin(), order.end()));
        }
  Volume_mesh mesh;
  mesh.zones = {zone};
  return mesh;
}

/// splits a one-zone mesh in two where the cells' centres pass x = 0, without saying that they touch.
Volume_mesh split_in_two(const Volume_mesh& mesh)
{
  const Zone& whole = mesh.zones[0];
  Volume_mesh result = mesh;
  result.zones.clear();
  for (int side : {0, 1})
  {
    Zone zone;
    zone.name = side == 0 ? "left" : "right";
    std::map<Index, Index> numbers;
    const auto is_here = [&](const std::vector<Index>& nodes, std::size_t first, std::size_t count) {
      double sum = 0;
      for (std::size_t n = first; n < first + count; ++n)
        sum += whole.points[static_cast<std::size_t>(nodes[n])][0];
      return (sum > 0) == (side == 1);
    };
    const auto take = [&](const Section& section, Section& taken) {
      const auto count = static_cast<std::size_t>(corner_count(section.type));
      for (std::size_t first = 0; first < section.nodes.size(); first += count)
        if (is_here(section.nodes, first, count))
          for (std::size_t n = first; n < first + count; ++n)
          {
            const auto [entry, is_new] = numbers.emplace(section.nodes[n], static_cast<Index>(zone.points.size()));
            if (is_new)
              zone.points.push_back(whole.points[static_cast<std::size_t>(section.nodes[n])]);
            taken.nodes.push_back(entry->second);
          }
    };
    for (const Section& section : whole.cells)
      take(section, zone.cells.emplace_back(Section{section.name, section.type, {}}));
    for (std::size_t s = 0; s < whole.faces.size(); ++s)
    {
      const Index first = zone.face_count();
      take(whole.faces[s], zone.faces.emplace_back(Section{whole.faces[s].name, whole.faces[s].type, {}}));
      Patch patch = whole.patches[s];
      patch.faces.resize(static_cast<std::size_t>(zone.face_count() - first));
      std::iota(patch.faces.begin(), patch.faces.end(), first);
      zone.patches.push_back(patch);
    }
    result.zones.push_back(zone);
  }
  return result;
}

/// two zones with the sphere of radius 1.5 between them, which the one calls "above" and the other "below".
Volume_mesh split_at_middle_layer(int n)
{
  const Volume_mesh whole = test::sphere_shell({n, 4, Element_type::hexahedron, test::Outer_shape::sphere});
  const Zone& zone = whole.zones[0];
  const auto layer_points = static_cast<Index>(zone.points.size()) / 5;
  Volume_mesh result;
  for (Index first_layer : {0, 2})
  {
    Zone part;
    part.name = first_layer == 0 ? "inner" : "outer";
    const Index first = first_layer * layer_points, last = first + 3 * layer_points;
    part.points.assign(zone.points.begin() + first, zone.points.begin() + last);
    part.cells = {{"cells", Element_type::hexahedron, {}}};
    for (std::size_t n8 = 0; n8 < zone.cells[0].nodes.size(); n8 += 8)
    {
      const auto [least, most] = std::minmax_element(zone.cells[0].nodes.begin() + static_cast<std::ptrdiff_t>(n8),
                                                     zone.cells[0].nodes.begin() + static_cast<std::ptrdiff_t>(n8 + 8));
      if (*least >= first && *most < last)
        for (std::size_t k = 0; k < 8; ++k)
          part.cells[0].nodes.push_back(zone.cells[0].nodes[n8 + k] - first);
    }
    // The faces of the inner sphere, moved to the layer where the zones meet.
    const Index meeting_layer = first_layer == 0 ? 2 : 0;
    part.faces = {{"middle", Element_type::quadrangle, zone.faces[0].nodes}};
    for (Index& node : part.faces[0].nodes)
      node += meeting_layer * layer_points;
    part.patches = {{first_layer == 0 ? "above" : "below", "BCWall", "", {}}};
    part.patches[0].faces.resize(static_cast<std::size_t>(part.face_count()));
    std::iota(part.patches[0].faces.begin(), part.patches[0].faces.end(), Index{0});
    result.zones.push_back(part);
  }
  return result;
}

/// makes the faces between cells in the plane x = 0 a patch.
void add_baffle(Zone& zone)
{
  Section section{"baffle", Element_type::quadrangle, {}};
  const Reference_element& element = reference_element(Element_type::hexahedron);
  for (std::size_t first = 0; first < zone.cells[0].nodes.size(); first += 8)
  {
    const auto x = [&](int corner) {
      return zone.points[static_cast<std::size_t>(zone.cells[0].nodes[first + static_cast<std::size_t>(corner)])][0];
    };
    for (const Reference_face& face : element.faces)
    {
      const bool is_in_plane =
        std::all_of(face.corners.begin(), face.corners.end(), [&](int corner) { return std::abs(x(corner)) < 1e-12; });
      if (is_in_plane && x(0) + x(6) > 0)
        for (int corner : face.corners)
          section.nodes.push_back(zone.cells[0].nodes[first + static_cast<std::size_t>(corner)]);
    }
  }
  Patch patch{"baffle", "BCWall", "", std::vector<Index>(static_cast<std::size_t>(section.size()))};
  std::iota(patch.faces.begin(), patch.faces.end(), zone.face_count());
  zone.faces.push_back(section);
  zone.patches.push_back(patch);
}

} // namespace

TEST_CASE("the nodes of a sphere come ten times closer to it than the straight ones")
{
  const auto type = GENERATE(Element_type::hexahedron, Element_type::prism, Element_type::tetrahedron);
  const int degree = GENERATE(2, 3, 4);
  CAPTURE(element_name(type), degree);
  const Volume_mesh linear = test::sphere_shell({12, 3, type, test::Outer_shape::box});
  const Curved_mesh straight = elevated(linear, degree);
  Curving_report report;
  const Curved_mesh curved = curve_mesh(linear, {.degree = degree}, &report);

  const auto sphere = patch_nodes(curved, "sphere");
  REQUIRE(sphere == patch_nodes(straight, "sphere"));
  CHECK(largest_distance_to_sphere(curved, sphere) < 0.1 * largest_distance_to_sphere(straight, sphere));
  // The box is planar: its nodes and the corners of all cells stay, to the bit.
  for (Index node : patch_nodes(curved, "outer"))
    CHECK(curved.nodes[static_cast<std::size_t>(node)] == straight.nodes[static_cast<std::size_t>(node)]);
  for (std::size_t vertex = 0; vertex < linear.zones[0].points.size(); ++vertex)
    CHECK(curved.nodes[vertex] == straight.nodes[vertex]);

  CHECK(straight_cells(curved) == report.straight_cells);
  CHECK(report.straight_cells < report.cells);
  // Only the layer at the sphere is curved.
  CHECK(report.straight_cells >= report.cells / 3);
  CHECK(report.largest_displacement.patch == "sphere");
  CHECK(report.largest_displacement.length == Approx(largest_distance_to_sphere(straight, sphere)).epsilon(0.15));
}

TEST_CASE("a box stays straight in every cell and node, to the bit")
{
  const auto type = GENERATE(Element_type::hexahedron, Element_type::tetrahedron);
  const int degree = GENERATE(1, 2, 3, 5);
  const unsigned seed = GENERATE(1u, 2u);
  CAPTURE(element_name(type), degree, seed);
  const Volume_mesh linear = random_box(4, type, seed);
  Curving_report report;
  const Curved_mesh curved = curve_mesh(linear, {.degree = degree}, &report);
  const Curved_mesh straight = elevated(linear, degree);
  CHECK(curved.nodes == straight.nodes);
  CHECK(report.straight_cells == curved.cell_count());
  CHECK(straight_cells(curved) == curved.cell_count());
  CHECK(report.largest_displacement.length == 0);
}

TEST_CASE("a patch that is kept stays straight to the bit, but for the rim that it shares with a curved one")
{
  const int degree = GENERATE(2, 3, 4);
  CAPTURE(degree);
  // The upper half of the sphere is a patch of its own; the rim is the equator.
  Volume_mesh linear = test::sphere_shell({12, 2, Element_type::hexahedron, test::Outer_shape::box});
  Zone& zone = linear.zones[0];
  Patch upper = zone.patches[0];
  upper.name = "upper";
  std::erase_if(upper.faces, [&](Index face) {
    double height = 0;
    for (std::size_t corner = 0; corner < 4; ++corner)
      height +=
        zone.points[static_cast<std::size_t>(zone.faces[0].nodes[4 * static_cast<std::size_t>(face) + corner])][2];
    return height < 0;
  });
  std::erase_if(zone.patches[0].faces,
                [&](Index face) { return std::binary_search(upper.faces.begin(), upper.faces.end(), face); });
  zone.patches.push_back(upper);

  const Curved_mesh straight = elevated(linear, degree);
  const Curved_mesh curved = curve_mesh(linear, {.degree = degree, .keep = {"sphere"}});
  const double row = 0.1; // the first row of faces below the equator reaches down to sin(7.5 degrees) = 0.13
  std::set<Index> rim, lower;
  for (Index node : patch_nodes(curved, "sphere"))
  {
    const double height = straight.nodes[static_cast<std::size_t>(node)][2];
    if (std::abs(height) < 1e-12)
      rim.insert(node);
    else if (height < -row - 0.05)
      lower.insert(node);
  }
  REQUIRE(rim.size() == std::size_t{48} * static_cast<std::size_t>(degree));
  REQUIRE_FALSE(lower.empty());
  for (Index node : lower)
    CHECK(curved.nodes[static_cast<std::size_t>(node)] == straight.nodes[static_cast<std::size_t>(node)]);
  // The curved half and its rim lie on the sphere; the rim stays in its plane.
  CHECK(largest_distance_to_sphere(curved, rim) < 0.1 * largest_distance_to_sphere(straight, rim));
  for (Index node : rim)
    CHECK(std::abs(curved.nodes[static_cast<std::size_t>(node)][2]) < 1e-14);
  const auto curved_nodes = patch_nodes(curved, "upper");
  CHECK(largest_distance_to_sphere(curved, curved_nodes) < 0.1 * largest_distance_to_sphere(straight, curved_nodes));
}

TEST_CASE("an interface between zones is no wall, and both sides share their nodes")
{
  const int degree = GENERATE(2, 3);
  CAPTURE(degree);
  const Volume_mesh whole = test::sphere_shell({8, 3, Element_type::hexahedron, test::Outer_shape::box});
  Curving_report report;
  // The fast sum depends on the order of the nodes, within its bound.
  Curving_options options = {.degree = degree};
  options.deformation.summation.method = Summation::plain;
  const Curved_mesh one = curve_mesh(whole, options);
  const Curved_mesh two = curve_mesh(split_in_two(whole), options, &report);
  REQUIRE(two.zones.size() == 2);
  CHECK(report.mesh.boundary.unassigned_faces == 0);
  CHECK(report.mesh.boundary.interface_faces > 0);
  REQUIRE(two.nodes.size() == one.nodes.size());

  // The same nodes in another order: each of the one has its like in the other.
  const auto rounded = [](const Curved_mesh& mesh) {
    std::set<std::array<long long, 3>> result;
    for (const Point& point : mesh.nodes)
      result.insert({std::llround(1e9 * point[0]), std::llround(1e9 * point[1]), std::llround(1e9 * point[2])});
    return result;
  };
  const auto of_one = rounded(one), of_two = rounded(two);
  std::vector<std::array<long long, 3>> differences;
  std::set_symmetric_difference(of_one.begin(), of_one.end(), of_two.begin(), of_two.end(),
                                std::back_inserter(differences));
  // A coordinate at half a unit of the rounding may fall to either side.
  CHECK(differences.size() < one.nodes.size() / 1000);
}

TEST_CASE("an interface that is named is curved, once for both sides")
{
  const int degree = GENERATE(2, 3);
  CAPTURE(degree);
  const Volume_mesh linear = split_at_middle_layer(12);
  const Curved_mesh straight = elevated(linear, degree);
  Curving_report report;
  const Curved_mesh curved = curve_mesh(linear, {.degree = degree, .curve = {"above"}}, &report);
  const auto distance = [&](const Curved_mesh& mesh) {
    double largest = 0;
    for (Index node : patch_nodes(straight, "above"))
      largest = std::max(largest, std::abs(radius(mesh.nodes[static_cast<std::size_t>(node)]) - 1.5));
    return largest;
  };
  CHECK(distance(curved) < 0.1 * distance(straight));
  CHECK(report.mesh.boundary.interface_faces == report.surface.faces);
  CHECK(patch_nodes(curved, "above") == patch_nodes(curved, "below"));
  for (std::size_t p = 0; p < report.mesh.patches.size(); ++p)
  {
    const bool is_interface = report.mesh.patches[p].place == Patch_place::interface;
    CHECK((report.curved_faces[p] > 0) == is_interface);
  }

  // By default it stays straight.
  const Curved_mesh by_default = curve_mesh(linear, {.degree = degree});
  CHECK(distance(by_default) == distance(straight));
}

TEST_CASE("where a surface inside the mesh ends at a wall, all sheets share their nodes")
{
  const int degree = GENERATE(2, 3);
  CAPTURE(degree);
  Volume_mesh linear = test::sphere_shell({12, 3, Element_type::hexahedron, test::Outer_shape::box});
  add_baffle(linear.zones[0]);
  const Curved_mesh straight = elevated(linear, degree);
  Curving_report report;
  const Curved_mesh curved = curve_mesh(linear, {.degree = degree, .curve = {"*"}}, &report);
  CHECK(report.mesh.boundary.internal_patches == std::vector<std::string>{"shell/baffle"});
  // A great circle of the sphere and one around the box, of 48 edges each.
  CHECK(report.surface.shared_edges == 96);
  const auto sphere = patch_nodes(curved, "sphere");
  CHECK(largest_distance_to_sphere(curved, sphere) < 0.1 * largest_distance_to_sphere(straight, sphere));
  for (Index node : patch_nodes(curved, "baffle"))
    CHECK(std::abs(curved.nodes[static_cast<std::size_t>(node)][0]) < 1e-14);
}

TEST_CASE("the number of threads does not change a bit")
{
  const Volume_mesh linear = test::sphere_shell({6, 2, Element_type::tetrahedron, test::Outer_shape::sphere});
  const Curved_mesh first = curve_mesh(linear, {.degree = 3, .threads = 1});
  for (int threads : {2, 7})
    CHECK(curve_mesh(linear, {.degree = 3, .threads = threads}).nodes == first.nodes);
}

TEST_CASE("nothing depends on the unit")
{
  const Volume_mesh linear = test::sphere_shell({6, 2, Element_type::hexahedron, test::Outer_shape::box});
  const Curved_mesh first = curve_mesh(linear, {.degree = 3});
  const double scale = GENERATE(0x1p-20, 0x1p20);
  Volume_mesh scaled = linear;
  for (Point& point : scaled.zones[0].points)
    for (double& coordinate : point)
      coordinate *= scale;
  const Curved_mesh second = curve_mesh(scaled, {.degree = 3});
  for (std::size_t n = 0; n < first.nodes.size(); ++n)
    for (std::size_t c = 0; c < 3; ++c)
      REQUIRE(second.nodes[n][c] / scale == Approx(first.nodes[n][c]).margin(1e-12));
}

TEST_CASE("options out of range and patches that do not exist are refused")
{
  const Volume_mesh linear = test::sphere_shell({2, 1, Element_type::hexahedron, test::Outer_shape::box});
  CHECK_THROWS_AS(curve_mesh(linear, {.degree = 0}), Input_error);
  CHECK_THROWS_AS(curve_mesh(linear, {.degree = 7}), Input_error);
  CHECK_THROWS_AS(curve_mesh(linear, {.fit_degree = 7}), Input_error);
  CHECK_THROWS_AS(curve_mesh(linear, {.threads = -1}), Input_error);
  CHECK_THROWS_AS(curve_mesh(linear, {.curve = {"wing"}}), Input_error);
  CHECK_THROWS_AS(curve_mesh(Volume_mesh{}, {}), Input_error);
}

TEST_CASE("a conversion can be stopped at every stage")
{
  const Volume_mesh linear = test::sphere_shell({2, 1, Element_type::hexahedron, test::Outer_shape::box});
  Curving_report report;
  curve_mesh(linear, {}, &report);
  REQUIRE(report.stages.size() > 5);
  for (const Stage_time& last : report.stages)
  {
    CAPTURE(last.stage);
    const auto stop = [&](std::string_view stage, double) { return stage != last.stage; };
    CHECK_THROWS_AS(curve_mesh(linear, {}, nullptr, stop), Cancelled);
  }
}
