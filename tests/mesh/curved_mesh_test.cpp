#include <recurve/core/exceptions.h>
#include <recurve/elements/node_layout.h>
#include <recurve/mesh/boundary_faces.h>
#include <recurve/mesh/curved_mesh.h>

#include <support/small_meshes.h>

#include <catch2/catch.hpp>
#include <tbb/global_control.h>

#include <cstring>
#include <set>

using namespace recurve;

namespace {

Curved_mesh elevate_joined(Volume_mesh mesh, int degree)
{
  const Joined_zones joined = join_zones(mesh);
  return elevate(std::move(mesh), joined, degree);
}

/// the straight element's map at a lattice point, from the corners: written per shape, in the plainest way.
Point straight_position(Element_type type, int degree, const Lattice_point& lattice, const std::vector<Point>& corners)
{
  const double x = double(lattice[0]) / degree, y = double(lattice[1]) / degree, z = double(lattice[2]) / degree;
  std::vector<double> w;
  switch (type)
  {
  case Element_type::line: w = {1 - x, x}; break;
  case Element_type::triangle: w = {1 - x - y, x, y}; break;
  case Element_type::quadrangle: w = {(1 - x) * (1 - y), x * (1 - y), x * y, (1 - x) * y}; break;
  case Element_type::tetrahedron: w = {1 - x - y - z, x, y, z}; break;
  case Element_type::prism: w = {(1 - x - y) * (1 - z), x * (1 - z), y * (1 - z), (1 - x - y) * z, x * z, y * z}; break;
  case Element_type::hexahedron:
    for (const auto& c : reference_element(type).corners)
      w.push_back((c[0] ? x : 1 - x) * (c[1] ? y : 1 - y) * (c[2] ? z : 1 - z));
    break;
  case Element_type::pyramid:
    if (lattice[2] == degree)
      w = {0, 0, 0, 0, 1};
    else
      w = {(1 - z - x) * (1 - z - y) / (1 - z), x * (1 - z - y) / (1 - z), x * y / (1 - z), (1 - z - x) * y / (1 - z),
           z};
    break;
  }
  Point position = {};
  for (std::size_t c = 0; c < corners.size(); ++c)
    for (int axis = 0; axis < 3; ++axis)
      position[axis] += w[c] * corners[c][axis];
  return position;
}

/// largest distance of any node of any element from where the plain map has it.
double largest_error(const Curved_mesh& mesh)
{
  double error = 0;
  for (const Curved_zone& zone : mesh.zones)
    for (const auto* sections : {&zone.cells, &zone.faces, &zone.bars})
      for (const Curved_section& section : *sections)
      {
        const std::span<const Lattice_point> lattice = canonical_nodes(section.type, mesh.degree);
        REQUIRE(section.nodes.size() % lattice.size() == 0);
        for (std::size_t first = 0; first < section.nodes.size(); first += lattice.size())
        {
          std::vector<Point> corners(static_cast<std::size_t>(corner_count(section.type)));
          for (std::size_t c = 0; c < corners.size(); ++c)
            corners[c] = mesh.nodes[section.nodes[first + c]];
          for (std::size_t m = 0; m < lattice.size(); ++m)
          {
            const Point expected = straight_position(section.type, mesh.degree, lattice[m], corners);
            const Point& found = mesh.nodes[section.nodes[first + m]];
            for (int axis = 0; axis < 3; ++axis)
              error = std::max(error, std::abs(found[axis] - expected[axis]));
          }
        }
      }
  return error;
}

/// number of nodes by counting entities: vertices, edges, faces and cells, each with those inside it.
Index expected_node_count(const Zone& zone, Index p)
{
  std::set<std::pair<Index, Index>> edges;
  Index count = static_cast<Index>(zone.points.size());
  for (const Section& section : zone.cells)
  {
    const Reference_element& reference = reference_element(section.type);
    for (Index e = 0; e < section.size(); ++e)
      for (int i = 0; i < reference.edge_count; ++i)
      {
        const Index* const nodes = section.nodes.data() + e * reference.corner_count;
        edges.insert(std::minmax(nodes[reference.edges[i][0]], nodes[reference.edges[i][1]]));
      }
    const Index inside[] = {(p - 1) * (p - 2) * (p - 3) / 6, (p - 1) * (p - 2) * (2 * p - 3) / 6,
                            (p - 1) * (p - 1) * (p - 2) / 2, (p - 1) * (p - 1) * (p - 1)};
    count += section.size() * inside[static_cast<int>(section.type) - static_cast<int>(Element_type::tetrahedron)];
  }
  count += static_cast<Index>(edges.size()) * (p - 1);
  for (const auto& [key, face] : test::faces_of_cells(zone))
    count += key.size() == 3 ? (p - 1) * (p - 2) / 2 : (p - 1) * (p - 1);
  return count;
}

/// number of positions that differ by more than round-off, for a mesh of size 1.
std::size_t distinct_positions(const std::vector<Point>& nodes)
{
  std::set<std::array<std::int64_t, 3>> positions;
  for (const Point& x : nodes)
    positions.insert({std::llround(x[0] * 1e9), std::llround(x[1] * 1e9), std::llround(x[2] * 1e9)});
  return positions.size();
}

bool same_bits(const std::vector<Point>& a, const std::vector<Point>& b)
{
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Point)) == 0;
}

std::vector<Index> all_nodes(const Curved_mesh& mesh)
{
  std::vector<Index> nodes;
  for (const Curved_zone& zone : mesh.zones)
    for (const auto* sections : {&zone.cells, &zone.faces, &zone.bars})
      for (const Curved_section& section : *sections)
        nodes.insert(nodes.end(), section.nodes.begin(), section.nodes.end());
  return nodes;
}

/// a mesh with no two edges alike, and no face in a plane of two axes.
Volume_mesh skewed(Volume_mesh mesh)
{
  test::move_points(mesh, [](const Point& x) {
    return Point{x[0] + 0.1 * x[1] * x[1], x[1] + 0.13 * x[2] * x[0], x[2] + 0.07 * x[0] * x[0] + 0.05 * x[1]};
  });
  return mesh;
}

} // namespace

TEST_CASE("elevation puts each node once, where the straight cell has it", "[curved_mesh]")
{
  const int degree = GENERATE(1, 2, 3, 4, 5, 6);
  const unsigned seed = GENERATE(1u, 2u);
  CAPTURE(degree, seed);
  for (const Element_type type : test::cell_types)
  {
    CAPTURE(element_name(type));
    const Volume_mesh linear = test::relabelled(skewed(test::box(type)), seed);
    const Curved_mesh mesh = elevate_joined(linear, degree);
    CHECK(mesh.degree == degree);
    CHECK(static_cast<Index>(mesh.nodes.size()) == expected_node_count(linear.zones[0], degree));
    CHECK(distinct_positions(mesh.nodes) == mesh.nodes.size());
    CHECK(largest_error(mesh) < 1e-14);
    CHECK(mesh.cell_count() == linear.cell_count());
    std::vector<Index> used = all_nodes(mesh);
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    CHECK(used.size() == mesh.nodes.size());
    CHECK(used.back() == static_cast<Index>(mesh.nodes.size()) - 1);
  }
}

TEST_CASE("cells of all types fit together", "[curved_mesh]")
{
  const int degree = GENERATE(1, 2, 3, 4, 5, 6);
  CAPTURE(degree);
  const Volume_mesh linear = skewed(test::mixed_box());
  const Curved_mesh mesh = elevate_joined(linear, degree);
  CHECK(static_cast<Index>(mesh.nodes.size()) == expected_node_count(linear.zones[0], degree));
  CHECK(distinct_positions(mesh.nodes) == mesh.nodes.size());
  CHECK(largest_error(mesh) < 1e-14);
}

TEST_CASE("zones share the nodes of their interface", "[curved_mesh]")
{
  const int degree = GENERATE(1, 2, 3, 6);
  for (const Element_type type : test::cell_types)
  {
    CAPTURE(element_name(type), degree);
    const Volume_mesh linear = test::relabelled(test::two_zone_box(type, type, 2), 8);
    const Curved_mesh mesh = elevate_joined(linear, degree);
    CHECK(distinct_positions(mesh.nodes) == mesh.nodes.size());
    CHECK(largest_error(mesh) < 1e-14);
    const Index on_side = 2 * degree + 1, on_seam = on_side * on_side; // 2 x 2 squares
    const Index apart = expected_node_count(linear.zones[0], degree) + expected_node_count(linear.zones[1], degree);
    CHECK(static_cast<Index>(mesh.nodes.size()) == apart - on_seam);
    for (std::size_t z = 0; z < 2; ++z)
    {
      const std::vector<Index>& nodes = mesh.zones[z].nodes;
      const std::vector<Point>& points = linear.zones[z].points;
      CHECK(static_cast<Index>(nodes.size()) == expected_node_count(linear.zones[z], degree));
      for (std::size_t n = 0; n < points.size(); ++n)
        CHECK(mesh.nodes[nodes[n]] == points[n]);
      CHECK(std::is_sorted(nodes.begin() + static_cast<Index>(points.size()), nodes.end()));
      CHECK(std::set<Index>(nodes.begin(), nodes.end()).size() == nodes.size());
    }
  }
}

TEST_CASE("faces and bars take the nodes of the cells", "[curved_mesh]")
{
  const int degree = GENERATE(2, 3, 5);
  for (const Element_type type : test::cell_types)
  {
    CAPTURE(element_name(type), degree);
    Volume_mesh linear = skewed(test::box(type));
    linear.zones[0].bars.push_back({"wire", Element_type::line, {1, 0, 1, 2}});
    const Index without = expected_node_count(linear.zones[0], degree);
    const Curved_mesh mesh = elevate_joined(linear, degree);
    CHECK(static_cast<Index>(mesh.nodes.size()) == without); // all of them are on cells
    CHECK(mesh.zones[0].faces.size() == linear.zones[0].faces.size());
    CHECK(mesh.zones[0].bars[0].nodes.size() == static_cast<std::size_t>(2 * (degree + 1)));
    CHECK(mesh.zones[0].bars[0].name == "wire");
    CHECK(largest_error(mesh) < 1e-14);
  }
}

TEST_CASE("an unused point is kept", "[curved_mesh]")
{
  Volume_mesh linear = test::box(Element_type::tetrahedron);
  linear.zones[0].points.push_back({5, 5, 5});
  const Curved_mesh mesh = elevate_joined(linear, 2);
  CHECK(mesh.nodes[27] == Point{5, 5, 5});
  CHECK(mesh.zones[0].nodes[27] == 27);
}

TEST_CASE("planes along the axes stay planes to the bit", "[curved_mesh]")
{
  const int degree = GENERATE(2, 3, 4, 5, 6);
  const double shift = GENERATE(0.1, 1.0 / 3, 1e6 + 0.7);
  for (const Element_type type : test::cell_types)
  {
    CAPTURE(element_name(type), degree, shift);
    Volume_mesh linear = test::box(type, {.origin = {shift, -shift, 2 * shift}});
    test::move_points(linear, [&](Point x) { // unequal edges inside each plane
      for (int axis = 0; axis < 3; ++axis)
        x[axis] += 0.01 * std::sin(7 * x[axis]);
      return x;
    });
    const Curved_mesh mesh = elevate_joined(linear, degree);
    for (const Curved_section& section : mesh.zones[0].faces)
    {
      const int axis = section.name[0] - 'x';
      for (const Index node : section.nodes)
        CHECK(mesh.nodes[node][axis] == mesh.nodes[section.nodes[0]][axis]);
    }
  }
}

TEST_CASE("all cells are straight until a node moves", "[curved_mesh]")
{
  const int degree = GENERATE(2, 3, 4);
  for (const Element_type type : test::cell_types)
  {
    CAPTURE(element_name(type), degree);
    Curved_mesh mesh = elevate_joined(skewed(test::two_zone_box(type, type)), degree);
    CHECK(update_straight_cells(mesh) == mesh.cell_count());
    const Curved_section& section = mesh.zones[0].cells[0];
    const Index moved = section.nodes[static_cast<std::size_t>(first_edge_node(type, degree, 1))];
    mesh.nodes[moved][2] = std::nextafter(mesh.nodes[moved][2], 1e9);
    const Index straight = update_straight_cells(mesh);
    Index bent = 0;
    for (const Curved_zone& zone : mesh.zones)
    {
      std::size_t cell = 0;
      for (const Curved_section& s : zone.cells)
      {
        const std::size_t count = static_cast<std::size_t>(node_count(s.type, degree));
        for (std::size_t first = 0; first < s.nodes.size(); first += count, ++cell)
        {
          const auto begin = s.nodes.begin() + static_cast<Index>(first);
          const bool has_it =
            std::find(begin, begin + static_cast<Index>(count), moved) != begin + static_cast<Index>(count);
          CHECK(bool(zone.is_straight[cell]) != has_it);
          bent += has_it;
        }
      }
    }
    CHECK(bent > 0);
    CHECK(straight == mesh.cell_count() - bent);
  }
}

TEST_CASE("straight_nodes repeats the bits of elevate for faces and bars too", "[curved_mesh]")
{
  const int degree = GENERATE(1, 2, 3, 5);
  for (const Element_type type : test::cell_types)
  {
    Volume_mesh linear = test::relabelled(skewed(test::box(type)), 5);
    linear.zones[0].bars.push_back({"wire", Element_type::line, linear.zones[0].cells[0].nodes});
    linear.zones[0].bars[0].nodes.resize(2);
    const Curved_mesh mesh = elevate_joined(linear, degree);
    for (const auto* sections : {&mesh.zones[0].faces, &mesh.zones[0].bars})
      for (const Curved_section& section : *sections)
      {
        const std::size_t count = static_cast<std::size_t>(node_count(section.type, degree));
        std::vector<Point> positions(count);
        for (std::size_t first = 0; first < section.nodes.size(); first += count)
        {
          const std::span<const Index> nodes(section.nodes.data() + first, count);
          straight_nodes(section.type, degree, nodes, mesh.nodes, positions);
          for (std::size_t m = 0; m < count; ++m)
            CHECK(positions[m] == mesh.nodes[nodes[m]]);
        }
      }
  }
}

TEST_CASE("elevation does not depend on the number of threads", "[curved_mesh]")
{
  const Volume_mesh linear =
    test::relabelled(test::two_zone_box(Element_type::tetrahedron, Element_type::tetrahedron, 12), 3);
  std::vector<Curved_mesh> results;
  for (const std::size_t threads : {1, 2, 7})
  {
    tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    results.push_back(elevate_joined(linear, 3));
  }
  for (std::size_t i = 1; i < results.size(); ++i)
  {
    CHECK(same_bits(results[i].nodes, results[0].nodes));
    CHECK(all_nodes(results[i]) == all_nodes(results[0]));
    CHECK(results[i].zones[1].nodes == results[0].zones[1].nodes);
  }
}

TEST_CASE("the linear mesh is moved, not copied", "[curved_mesh]")
{
  Volume_mesh linear = test::box(Element_type::tetrahedron);
  const Joined_zones joined = join_zones(linear);
  const Point* const points = linear.zones[0].points.data();
  const Curved_mesh mesh = elevate(std::move(linear), joined, 2);
  CHECK(mesh.linear.zones[0].points.data() == points);
  CHECK(mesh.linear.zones[0].patches.size() == 6);
}

TEST_CASE("a collapsed edge has all its nodes at its vertex", "[curved_mesh]")
{
  const int degree = GENERATE(2, 3, 4);
  Volume_mesh linear = test::one_cell(Element_type::hexahedron);
  linear.zones[0].cells[0].nodes = {0, 1, 2, 2, 4, 5, 6, 6};
  Curved_mesh mesh = elevate_joined(linear, degree);
  const std::vector<Index>& nodes = mesh.zones[0].cells[0].nodes;
  for (int k = 0; k < degree - 1; ++k)
  {
    CHECK(nodes[first_edge_node(Element_type::hexahedron, degree, 2) + k] == 2); // corners 2 and 3
    CHECK(nodes[first_edge_node(Element_type::hexahedron, degree, 6) + k] ==
          nodes[first_edge_node(Element_type::hexahedron, degree, 7) + k]); // both rise from vertex 2 to vertex 6
  }
  CHECK(largest_error(mesh) < 1e-14);
  CHECK(update_straight_cells(mesh) == 1);
}

TEST_CASE("degrees and joins that do not fit are refused", "[curved_mesh]")
{
  const Volume_mesh linear = test::box(Element_type::tetrahedron);
  for (const int degree : {0, -1, 7})
    CHECK_THROWS_AS(elevate_joined(linear, degree), Input_error);
  Joined_zones joined = join_zones(linear);
  joined.vertex_of_point[0].pop_back();
  CHECK_THROWS_AS(elevate(linear, joined, 2), Input_error);
  CHECK_THROWS_AS(elevate(linear, {}, 2), Input_error);
}
