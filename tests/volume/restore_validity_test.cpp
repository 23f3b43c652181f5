#include <recurve/volume/restore_validity.h>

#include <recurve/core/exceptions.h>
#include <recurve/elements/basis.h>
#include <volume/jacobian_oracles.h>
#include <volume/small_meshes.h>

#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

using namespace recurve;
using namespace recurve::tests;

namespace {

/// A straight mesh, what became of its nodes, and what they are.
struct Deformed_mesh
{
  Small_mesh mesh; ///< straight
  std::vector<Point> nodes;
  std::vector<Node_role> roles;
  std::vector<double> factors = std::vector<double>(nodes.size());

  explicit Deformed_mesh(Small_mesh straight)
    : mesh(std::move(straight)), nodes(mesh.nodes), roles(nodes.size(), Node_role::inside)
  {}

  template <class Move>
  void displace(const Move& move)
  {
    for (Point& p : nodes)
    {
      const Point s = move(p);
      p = {p[0] + s[0], p[1] + s[1], p[2] + s[2]};
    }
  }

  /// gives a role to the nodes for whose straight position `where` holds.
  template <class Where>
  void assign(Node_role role, const Where& where)
  {
    for (std::size_t n = 0; n < nodes.size(); ++n)
      if (where(mesh.nodes[n]))
        roles[n] = role;
  }

  Restoration_report restore(const Restoration_options& options = {})
  {
    return restore_validity(nodes, mesh.nodes, mesh.blocks(), mesh.degree, {roles, {}, factors}, options);
  }
};

/// whether every cell is positive at many points, and certified; cells that are straight by their corners.
bool is_valid(const Deformed_mesh& m)
{
  std::mt19937 random(1);
  for (const auto& [type, list] : m.mesh.elements)
  {
    std::vector<Sample> samples;
    for (const Reference_point& p : sample_points(type, 4, 20, random))
      samples.emplace_back(type, m.mesh.degree, p);
    const auto stride = static_cast<std::size_t>(node_count(type, m.mesh.degree));
    for (std::size_t first = 0; first < list.size(); first += stride)
    {
      std::vector<Point> cell;
      for (std::size_t n = first; n < first + stride; ++n)
        cell.push_back(m.nodes[static_cast<std::size_t>(list[n])]);
      if (bound_jacobian(type, m.mesh.degree, cell).verdict != Validity::valid)
        return false;
      for (const Sample& sample : samples)
        if (!(sample.jacobian(cell) > 0))
          return false;
    }
  }
  return true;
}

/// whether each node is on the straight line between where it was before and after, where its factor says.
bool is_on_the_way(const Deformed_mesh& m, const std::vector<Point>& full)
{
  for (std::size_t n = 0; n < full.size(); ++n)
  {
    const double factor = m.factors[n];
    if (factor == 1 && m.nodes[n] != full[n])
      return false;
    if (factor == 0 && m.nodes[n] != m.mesh.nodes[n])
      return false;
    for (std::size_t d = 0; d < 3; ++d)
    {
      const double s = m.mesh.nodes[n][d], expected = s + factor * (full[n][d] - s);
      if (std::abs(m.nodes[n][d] - expected) > 1e-15 * (std::abs(s) + std::abs(full[n][d])))
        return false;
    }
  }
  return true;
}

/// a box of 3 x 3 cells on a floor z = 0, whose first layer is `height` thin and each further one twice as high.
Small_mesh layered_box(Element_type type, int degree, double height, int layers)
{
  std::vector<double> z = {0};
  for (int k = 0; k < layers; ++k)
    z.push_back(z.back() + height * std::pow(2, k));
  return cut_box(type, degree, {3, 3, layers}, [z](int i, int j, int k) -> Point {
    return {i / 3.0, j / 3.0, z[std::size_t(k)]};
  });
}

/// a floor that bulges between its corners by up to `rise`, and a motion above that fades over `reach`.
auto bulge(double rise, double reach)
{
  return [rise, reach](const Point& p) -> Point {
    const double u = 3 * p[0] - std::floor(3 * p[0]), v = 3 * p[1] - std::floor(3 * p[1]);
    const double shape = 4 * (u * (1 - u) + v * (1 - v)) / 2;
    return {0, 0, p[2] >= reach ? 0 : rise * shape * (1 - p[2] / reach)};
  };
}

const auto is_floor = [](const Point& p) { return p[2] == 0; };
const auto is_side = [](const Point& p) { return p[2] != 0 && (p[0] == 0 || p[0] == 1 || p[1] == 0 || p[1] == 1); };

/// A sheared grid of 3 x 3 x 2 cells, cut into tetrahedra, on a wall z = bend (x^2 + y^2) / 8. Below its middle a
/// tetrahedron is added whose two lower faces then lie on the wall: the common edge ab is the diagonal that the others
/// do not have.
struct Wall_with_pocket
{
  double bend; ///< 1: the wall is hollow, as seen from the cells; -1: round
  Deformed_mesh mesh;
  std::vector<std::vector<Index>> faces; ///< of the wall, the two of the pocket last
  std::vector<Index> ab;                 ///< the nodes inside the edge

  Wall_with_pocket(double bend_of_wall, int degree) : bend(bend_of_wall), mesh(grid(degree))
  {
    Small_mesh wall = mesh.mesh;
    wall.elements.clear();
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i)
        if (i != 1 || j != 1)
        {
          wall.add(Element_type::triangle, {vertex(i, j, 0), vertex(i + 1, j, 0), vertex(i + 1, j + 1, 0)});
          wall.add(Element_type::triangle, {vertex(i, j, 0), vertex(i + 1, j + 1, 0), vertex(i, j + 1, 0)});
        }
    wall.add(Element_type::triangle, {vertex(2, 1, 0), vertex(1, 2, 0), vertex(1, 1, 0)});
    wall.add(Element_type::triangle, {vertex(1, 2, 0), vertex(2, 1, 0), vertex(2, 2, 0)});
    const std::vector<Index>& nodes = wall.elements[Element_type::triangle];
    const auto stride = node_count(Element_type::triangle, degree);
    for (auto first = nodes.begin(); first != nodes.end(); first += stride)
      faces.emplace_back(first, first + stride);
    for (const int m : edge_nodes(Element_type::triangle, degree, 0).subspan(2))
      ab.push_back(faces.back()[std::size_t(m)]);
    for (const Index n : nodes)
    {
      // A little too far, as fits go: exactly on the wall the pocket is flat to within rounding.
      Point& p = mesh.nodes[std::size_t(n)];
      const Point& straight = mesh.mesh.nodes[std::size_t(n)];
      mesh.roles[std::size_t(n)] = Node_role::surface;
      p[2] = straight[2] + 1.02 * (height(straight[0], straight[1]) - straight[2]);
    }
  }

  double height(double x, double y) const { return bend * (x * x + y * y) / 8; }

  Point vertex(int i, int j, int k) const
  {
    const double x = i + bend * j / 4 - 1.5, y = j - 1.5;
    return {x, y, k + height(x, y)};
  }

  Small_mesh grid(int degree) const
  {
    Small_mesh result =
      cut_box(Element_type::tetrahedron, degree, {3, 3, 2}, [this](int i, int j, int k) { return vertex(i, j, k); });
    result.add(Element_type::tetrahedron, {vertex(2, 1, 0), vertex(1, 2, 0), vertex(1, 1, 0), vertex(2, 2, 0)});
    return result;
  }

  bool is_reduced(std::span<const Index> list) const
  {
    return std::ranges::any_of(list, [this](Index n) { return mesh.factors[std::size_t(n)] < 1; });
  }

  /// the largest angle between the normals on the two sides of edge ab, in radians.
  double kink_of_ab(const std::vector<Point>& nodes) const
  {
    double largest = 0;
    for (const double t : {0.0, 0.1, 0.25, 0.5, 0.75, 0.9, 1.0})
    {
      const Eigen::Vector3d one = normal(faces[faces.size() - 2], t, nodes), other = normal(faces.back(), 1 - t, nodes);
      largest = std::max(largest, std::atan2(one.cross(other).norm(), one.dot(other)));
    }
    return largest;
  }

  /// at (t, 0) of a face.
  Eigen::Vector3d normal(const std::vector<Index>& face, double t, const std::vector<Point>& nodes) const
  {
    std::vector<std::array<double, 3>> slopes(face.size());
    lagrange_derivatives(Element_type::triangle, mesh.mesh.degree, {t, 0, 0}, slopes);
    Eigen::Vector3d u = Eigen::Vector3d::Zero(), v = u;
    for (std::size_t m = 0; m < face.size(); ++m)
    {
      const Eigen::Map<const Eigen::Vector3d> p(nodes[std::size_t(face[m])].data());
      u += slopes[m][0] * p;
      v += slopes[m][1] * p;
    }
    return u.cross(v).normalized();
  }
};

const Restoration_options factors_only = {.repair_layers = 0};

} // namespace

TEST_CASE("restore_validity: what is valid is left alone, to the bit", "[volume]")
{
  const Element_type type = GENERATE(from_range(cell_types));
  const int degree = GENERATE(1, 2, 3);
  CAPTURE(element_name(type), degree);
  Deformed_mesh m(box_of(type, degree, 2));
  m.assign(Node_role::surface, [](const Point& p) { return p[0] < 0.1; });

  SECTION("straight")
  {}
  SECTION("curved")
  {
    m.displace([](const Point& p) -> Point { return {0.01 * std::sin(3 * p[1]), 0, 0.01 * std::sin(4 * p[0])}; });
  }
  const std::vector<Point> before = m.nodes;
  const Restoration_report report = m.restore();
  CHECK(m.nodes == before);
  CHECK(report.is_certified());
  CHECK(report.failing_cells == 0);
  CHECK(report.reduced_cells == 0);
  CHECK(report.excluded.empty());
  CHECK(report.rounds == 0);
  CHECK(report.restored.total().invalid + report.restored.total().undecided == 0);
  CHECK(*std::min_element(m.factors.begin(), m.factors.end()) == 1);
}

TEST_CASE("restore_validity: random large displacements end in a certified mesh", "[volume]")
{
  const Element_type type = GENERATE(from_range(cell_types));
  const int degree = GENERATE(1, 2, 3);
  const double size = GENERATE(0.1, 0.4, 10.0, 1e6);
  const Restoration_options options = GENERATE(Restoration_options{}, factors_only);
  const unsigned seed = 5;
  CAPTURE(element_name(type), degree, size, options.repair_layers, seed);
  Deformed_mesh m(box_of(type, degree, 2));
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-size / degree, size / degree);
  m.displace([&](const Point&) -> Point { return {uniform(random), uniform(random), uniform(random)}; });
  m.assign(Node_role::surface, [](const Point& p) { return p[0] < 0.1; });
  m.assign(Node_role::follower, [](const Point& p) { return p[0] > 0.9; });
  const std::vector<Point> full = m.nodes;

  const Restoration_report report = m.restore(options);
  if (size > 0.1)
    CHECK(report.failing_cells > 0);
  CHECK(report.is_certified());
  CHECK(report.excluded.empty());
  CHECK(is_valid(m));
  CHECK(report.restored.total().valid == report.straight.total().valid);
  CHECK(std::accumulate(report.nodes_of_level.begin(), report.nodes_of_level.end(), Index(0)) ==
        static_cast<Index>(m.nodes.size()));
  if (options.repair_layers == 0)
    CHECK(is_on_the_way(m, full));
}

TEST_CASE("restore_validity: nothing depends on threads, the order of cells or a power of two", "[volume]")
{
  const Element_type type = GENERATE(from_range(cell_types));
  CAPTURE(element_name(type));
  const auto make = [&] {
    Deformed_mesh m(box_of(type, 2, 3));
    std::mt19937 random(3);
    std::uniform_real_distribution<double> uniform(-0.15, 0.15);
    m.displace([&](const Point&) -> Point { return {uniform(random), uniform(random), uniform(random)}; });
    m.assign(Node_role::surface, [](const Point& p) { return p[0] < 0.1; });
    return m;
  };
  Deformed_mesh first = make();
  const Restoration_report expected = first.restore();
  CHECK(expected.failing_cells > 0);
  const auto check_same = [&](const Deformed_mesh& other, const Restoration_report& report) {
    CHECK(other.nodes == first.nodes);
    CHECK(other.factors == first.factors);
    CHECK(report.rounds == expected.rounds);
    CHECK(report.reduced_cells == expected.reduced_cells);
    CHECK(report.restored.histogram == expected.restored.histogram);
  };

  SECTION("threads")
  {
    for (const std::size_t threads : {1, 2, 7})
    {
      const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
      Deformed_mesh other = make();
      const Restoration_report report = other.restore();
      check_same(other, report);
    }
  }
  SECTION("order")
  {
    Deformed_mesh other = make();
    std::vector<Index>& list = other.mesh.elements[type];
    const auto stride = node_count(type, 2);
    std::vector<Index> reversed;
    for (auto cell = list.end(); cell != list.begin(); cell -= stride)
      reversed.insert(reversed.end(), cell - stride, cell);
    list = reversed;
    const Restoration_report report = other.restore();
    check_same(other, report);
  }
  SECTION("unit")
  {
    const double unit = GENERATE(0x1p-30, 0x1p30);
    Deformed_mesh other = make();
    for (auto* points : {&other.nodes, &other.mesh.nodes})
      for (Point& p : *points)
        p = {unit * p[0], unit * p[1], unit * p[2]};
    const Restoration_report report = other.restore();
    for (Point& p : other.nodes)
      p = {p[0] / unit, p[1] / unit, p[2] / unit};
    check_same(other, report);
  }
}

TEST_CASE("restore_validity: a floor that rises a hundred times its first cell", "[volume]")
{
  const Element_type type = GENERATE(from_range(cell_types));
  const int degree = GENERATE(2, 3);
  const double reach = GENERATE(0.001, 1.0); // a motion that stops in the first layer; and one that fades out smoothly
  CAPTURE(element_name(type), degree, reach);
  const double height = 0.001;
  Deformed_mesh m(layered_box(type, degree, height, 10));
  m.displace(bulge(100 * height, reach));
  m.assign(Node_role::follower, is_side);
  m.assign(Node_role::surface, is_floor);
  const std::vector<Point> full = m.nodes;

  const Restoration_report report = m.restore(factors_only);
  CHECK(report.is_certified());
  CHECK(is_valid(m));
  CHECK(is_on_the_way(m, full));
  for (std::size_t n = 0; n < m.nodes.size(); ++n) // the sides stay planes, to the bit
    for (std::size_t d = 0; d < 2; ++d)
      if (m.mesh.nodes[n][d] == 0 || m.mesh.nodes[n][d] == 1)
        CHECK(m.nodes[n][d] == m.mesh.nodes[n][d]);
}

TEST_CASE("restore_validity: the inside gives way before the surface", "[volume]")
{
  // Nodes inside a column of hexahedra are thrown about; the floor bulges little enough for the cells to bear it.
  Deformed_mesh m(layered_box(Element_type::hexahedron, 2, 0.2, 2));
  m.assign(Node_role::surface, is_floor);
  m.assign(Node_role::follower, is_side);
  m.displace([](const Point& p) -> Point {
    const Point s = bulge(0.02, 0.2)(p);
    return p[2] > 0 && p[2] < 0.5 && p[0] > 0.1 && p[0] < 0.9 && p[1] > 0.1 && p[1] < 0.9 ? Point{0.9, 0, s[2]} : s;
  });
  const Restoration_report report = m.restore(factors_only);
  CHECK(report.failing_cells > 0);
  CHECK(report.is_certified());
  CHECK(report.reduced_cells > 0);
  for (std::size_t n = 0; n < m.nodes.size(); ++n)
    if (m.roles[n] == Node_role::surface)
      CHECK(m.factors[n] == 1);
}

TEST_CASE("restore_validity: inner nodes are repaired, and nothing is given up", "[volume]")
{
  const Element_type type = GENERATE(from_range(cell_types));
  const int degree = GENERATE(2, 3);
  CAPTURE(element_name(type), degree);
  Deformed_mesh m(box_of(type, degree, 3));
  // A smooth motion that all cells bear, and within it nodes inside the volume that are thrown about.
  m.displace([](const Point& p) -> Point { return {0.02 * std::sin(3 * p[1]), 0, 0.02 * std::sin(4 * p[0])}; });
  const std::vector<Point> smooth = m.nodes;
  REQUIRE(bound_jacobians(smooth, m.mesh.blocks(), degree).total().invalid == 0);
  std::vector<char> is_corner(m.nodes.size());
  for (const auto& [t, list] : m.mesh.elements)
    for (std::size_t n = 0; n < list.size(); ++n)
      if (static_cast<int>(n % std::size_t(node_count(t, degree))) < corner_count(t))
        is_corner[std::size_t(list[n])] = 1;
  m.assign(Node_role::surface, [](const Point& p) {
    return p[0] < 0.2 || p[0] > 0.8 || p[1] < 0.2 || p[1] > 0.8 || p[2] < 0.2 || p[2] > 0.8;
  });
  // As far as it takes for some cells to fail; cells of more corners bear more.
  for (double size = 0.04; bound_jacobians(m.nodes, m.mesh.blocks(), degree).total().invalid == 0; size *= 1.2)
  {
    REQUIRE(size < 1);
    std::mt19937 random(6);
    std::uniform_real_distribution<double> uniform(-size / degree, size / degree);
    m.nodes = smooth;
    for (std::size_t n = 0; n < m.nodes.size(); ++n)
      if (m.roles[n] == Node_role::inside && !is_corner[n])
        for (double& x : m.nodes[n])
          x += uniform(random);
  }

  const Restoration_report report = m.restore();
  CHECK(report.is_certified());
  CHECK(report.failing_cells > 0);
  CHECK(report.repaired_cells == report.failing_cells);
  CHECK(report.repaired_nodes > 0);
  CHECK(report.reduced_cells == 0);
  CHECK(is_valid(m));
  for (std::size_t n = 0; n < m.nodes.size(); ++n)
    if (is_corner[n] || m.roles[n] != Node_role::inside)
      CHECK(m.nodes[n] == smooth[n]);
}

TEST_CASE("restore_validity: a cell with two faces on a smooth wall costs these and what shares their edges",
          "[volume]")
{
  const int degree = GENERATE(2, 3, 4);
  const double bend = GENERATE(-1.0, 1.0);
  CAPTURE(degree, bend);
  Wall_with_pocket wall(bend, degree);
  Deformed_mesh& m = wall.mesh;
  const std::vector<Point> full = m.nodes;
  REQUIRE(bound_jacobians(m.mesh.nodes, m.mesh.blocks(), degree).total().invalid == 0);
  const Restoration_report report = m.restore();
  CHECK(report.failing_cells == 1);
  CHECK(report.is_certified());
  CHECK(is_valid(m));

  std::vector<std::vector<Index>> reduced;
  for (const auto& face : wall.faces)
    if (wall.is_reduced(face))
      reduced.push_back(face);
  if (bend < 0) // Round: lowering ab opens the pocket.
  {
    CHECK(wall.is_reduced(wall.ab));
    CHECK(reduced == std::vector(wall.faces.end() - 2, wall.faces.end()));
    CHECK(wall.kink_of_ab(m.nodes) < wall.kink_of_ab(m.mesh.nodes));
  }
  else // Hollow: that would close it further. Two other edges have to give way, one at a and one at b.
  {
    CHECK_FALSE(wall.is_reduced(wall.ab));
    CHECK(reduced.size() == 3);
    CHECK(wall.is_reduced(wall.faces.back()) != wall.is_reduced(wall.faces[wall.faces.size() - 2]));
  }
  for (std::size_t n = 0; n < m.nodes.size(); ++n)
    if (m.roles[n] == Node_role::surface)
    {
      CHECK(m.factors[n] >= 0.75);
      CHECK(m.nodes[n][0] == m.mesh.nodes[n][0]);
      CHECK(m.nodes[n][2] - m.mesh.nodes[n][2] ==
            Approx(m.factors[n] * (full[n][2] - m.mesh.nodes[n][2])).margin(1e-14));
    }
}

TEST_CASE("restore_validity: relief depends neither on threads nor on the order of cells", "[volume]")
{
  const double bend = GENERATE(-1.0, 1.0);
  Wall_with_pocket first(bend, 3), other(bend, 3);
  first.mesh.restore();
  SECTION("threads")
  {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, GENERATE(1, 3));
    other.mesh.restore();
  }
  SECTION("order")
  {
    std::vector<Index>& list = other.mesh.mesh.elements[Element_type::tetrahedron];
    std::vector<Index> reversed;
    for (auto cell = list.end(); cell != list.begin(); cell -= node_count(Element_type::tetrahedron, 3))
      reversed.insert(reversed.end(), cell - node_count(Element_type::tetrahedron, 3), cell);
    list = reversed;
    other.mesh.restore();
  }
  CHECK(other.mesh.nodes == first.mesh.nodes);
  CHECK(other.mesh.factors == first.mesh.factors);
}

TEST_CASE("restore_validity: relief on one side of a linked pair is relief on both", "[volume]")
{
  const int degree = GENERATE(2, 3);
  Wall_with_pocket wall(-1, degree);
  const std::vector<Index>& far = wall.faces.front();
  std::vector<std::array<Index, 2>> linked;
  for (std::size_t m = 0; m < wall.ab.size(); ++m)
    linked.push_back({far[3 + m], wall.ab[m]}); // its first edge
  const Restoration_report report = restore_validity(wall.mesh.nodes, wall.mesh.mesh.nodes, wall.mesh.mesh.blocks(),
                                                     degree, {wall.mesh.roles, linked, wall.mesh.factors});
  CHECK(report.is_certified());
  CHECK(wall.is_reduced(wall.ab));
  for (const auto& [a, b] : linked)
    CHECK(wall.mesh.factors[std::size_t(a)] == wall.mesh.factors[std::size_t(b)]);
  if (degree == 3)
    CHECK(wall.mesh.factors[std::size_t(far.back())] < 1); // the node inside the face follows
}

TEST_CASE("restore_validity: linked nodes keep the same share", "[volume]")
{
  Deformed_mesh m(layered_box(Element_type::hexahedron, 2, 0.02, 3));
  m.displace([](const Point& p) -> Point {
    const Point s = bulge(0.1, 0.02)(p);
    return {s[0], s[1], p[0] < 0.3 ? s[2] : 0.1 * s[2]}; // it is the side x = 0 that fails
  });
  m.assign(Node_role::follower, is_side);
  m.assign(Node_role::surface, is_floor);
  std::vector<std::array<Index, 2>> linked;
  for (std::size_t a = 0; a < m.nodes.size(); ++a)
    for (std::size_t b = 0; b < m.nodes.size(); ++b)
      if (m.mesh.nodes[a][0] == 0 && m.mesh.nodes[b] == Point{1, m.mesh.nodes[a][1], m.mesh.nodes[a][2]})
        linked.push_back({static_cast<Index>(b), static_cast<Index>(a)});
  REQUIRE(linked.size() > 20);
  const Restoration_report report = restore_validity(m.nodes, m.mesh.nodes, m.mesh.blocks(), m.mesh.degree,
                                                     {m.roles, linked, m.factors}, {.repair_layers = 0});
  CHECK(report.is_certified());
  int reduced = 0;
  for (const auto& [a, b] : linked)
  {
    CHECK(m.factors[std::size_t(a)] == m.factors[std::size_t(b)]);
    reduced += m.factors[std::size_t(a)] < 1;
  }
  CHECK(reduced > 0);
}

TEST_CASE("restore_validity: the image of a linked node stays one, to the bit", "[volume]")
{
  // The side x = 1 is the side x = 0 further on by 1, and moves with it; it is the cells at x = 0 that fail.
  const bool is_led_from_afar = GENERATE(false, true); // y = 1 by y = 0 as well: an edge is an image twice
  const double rise = GENERATE(0.06, 0.1, 2.0);        // in the end all of it is given up
  const double height = 0.02;
  CAPTURE(is_led_from_afar, rise);
  const std::size_t directions = is_led_from_afar ? 2 : 1;
  Deformed_mesh m(layered_box(Element_type::hexahedron, 3, height, 4));
  m.displace([&](const Point& p) -> Point {
    const Point s = bulge(rise, height)(p);
    return {0, 0, (p[0] == 0 || p[0] == 1 ? 1 : 0.1) * s[2]};
  });
  m.assign(Node_role::follower, is_side);
  m.assign(Node_role::surface, is_floor);
  std::vector<std::array<Index, 2>> linked;
  std::vector<std::size_t> axes;
  for (std::size_t d = 0; d < directions; ++d)
    for (std::size_t a = 0; a < m.nodes.size(); ++a)
      for (std::size_t b = 0; b < m.nodes.size(); ++b)
        if (Point image = m.mesh.nodes[a]; m.mesh.nodes[a][d] == 0 && (image[d] = 1, m.mesh.nodes[b] == image))
        {
          linked.push_back({static_cast<Index>(a), static_cast<Index>(b)});
          axes.push_back(d);
        }
  // Where the image belongs: one off the floor by a third, which its own displacement would miss by a rounding.
  const auto image = [&](std::size_t pair, Point p) {
    p[axes[pair]] += 1;
    p[2] *= 1 + 0x1p-40;
    return p;
  };
  for (std::size_t pair = 0; pair < linked.size(); ++pair)
    m.nodes[std::size_t(linked[pair][1])] = image(pair, m.nodes[std::size_t(linked[pair][0])]);
  const Restoration_report report = restore_validity(m.nodes, m.mesh.nodes, m.mesh.blocks(), m.mesh.degree,
                                                     {m.roles, linked, m.factors, image}, {.repair_layers = 0});
  CHECK(report.is_certified());
  int reduced = 0;
  for (std::size_t pair = 0; pair < linked.size(); ++pair)
  {
    const auto [a, b] = linked[pair];
    const double factor = m.factors[std::size_t(a)];
    CHECK(m.factors[std::size_t(b)] == factor);
    if (factor == 0 || factor == 1 || m.nodes[std::size_t(a)] == m.mesh.nodes[std::size_t(a)])
      continue;
    ++reduced;
    CHECK(m.nodes[std::size_t(b)] == image(pair, m.nodes[std::size_t(a)]));
  }
  if (rise < 1)
    CHECK(reduced > 0);
}

TEST_CASE("restore_validity: reductions fade out", "[volume]")
{
  const auto floor = [](int layers) {
    Deformed_mesh m(cut_box(Element_type::hexahedron, 2, {9, 1, 1}, [](int i, int j, int k) -> Point {
      return {double(i), double(j), double(k)};
    }));
    m.assign(Node_role::surface, is_floor);
    m.displace([](const Point& p) -> Point {
      const double u = p[0] - std::floor(p[0]);
      return {0, 0, p[2] == 0 ? 4 * u * (1 - u) * (std::floor(p[0]) == 4 ? 3.0 : 0.05) : 0};
    });
    CHECK(m.restore({.repair_layers = 0, .smoothing_layers = layers}).is_certified());
    std::array<double, 9> result = {};
    for (std::size_t n = 0; n < m.nodes.size(); ++n)
      if (m.mesh.nodes[n][2] == 0 && m.mesh.nodes[n][0] != std::floor(m.mesh.nodes[n][0]))
        result[std::size_t(m.mesh.nodes[n][0])] = m.factors[n];
    return result;
  };
  const auto none = floor(0), one = floor(1), two = floor(2);
  REQUIRE(none[4] <= 0.25);
  CHECK(none[3] == 1);
  CHECK(one[3] < 1);
  CHECK(one[3] > one[4]);
  CHECK(one[2] == 1);
  CHECK(two[5] < 1);
  CHECK(two[6] < 1);
  CHECK(two[6] >= two[5]);
  CHECK(two[7] == 1);
}

TEST_CASE("restore_validity: cells that are wrong from the start are named and excluded", "[volume]")
{
  Small_mesh box = box_of(Element_type::hexahedron, 2, 2);
  const auto stride = node_count(Element_type::hexahedron, 2);
  std::vector<Index>& list = box.elements[Element_type::hexahedron];
  const std::vector<Index> cell(list.begin() + 3 * stride, list.begin() + 4 * stride);
  // Its mirror image, and one with all nodes in one plane, both on nodes of their own.
  for (const bool is_flat : {false, true})
    for (const Index n : cell)
    {
      Point p = box.nodes[static_cast<std::size_t>(n)];
      p[2] = is_flat ? 0 : -p[2];
      list.push_back(static_cast<Index>(box.nodes.size()));
      box.nodes.push_back(p);
    }
  Deformed_mesh m(box);
  std::mt19937 random(4);
  std::uniform_real_distribution<double> uniform(-0.2, 0.2);
  m.displace([&](const Point&) -> Point { return {uniform(random), uniform(random), uniform(random)}; });
  const Restoration_report report = m.restore();
  CHECK(report.excluded == std::vector<Block_element>{{0, 8}, {0, 9}});
  CHECK(report.is_certified());
  CHECK(report.straight.total().valid == 8);
  CHECK(report.restored.total().valid == 8);
}

TEST_CASE("restore_validity: a cell so flat that rounding folds it is excluded", "[volume]")
{
  // A tetrahedron of height 1e-16 far from the origin: the corners say valid, but its nodes cannot be told from flat.
  Small_mesh box;
  box.degree = 2;
  const std::vector<Point> corners = {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {0.3, 0.3, std::nextafter(1.0, 2.0)}};
  for (int m = 0; m < node_count(Element_type::tetrahedron, 2); ++m)
  {
    Point p = {0, 0, 0};
    const auto weights = corner_functions(Element_type::tetrahedron, reference_point(Element_type::tetrahedron, 2, m));
    for (std::size_t c = 0; c < 4; ++c)
      for (std::size_t d = 0; d < 3; ++d)
        p[d] += weights[c] * corners[c][d];
    box.elements[Element_type::tetrahedron].push_back(m);
    box.nodes.push_back(p);
  }
  REQUIRE(bound_jacobian(Element_type::tetrahedron, 1, corners).verdict == Validity::valid);
  REQUIRE(bound_jacobian(Element_type::tetrahedron, 2, box.nodes).verdict != Validity::valid);
  Deformed_mesh m(box);
  const Restoration_report report = m.restore();
  CHECK(report.excluded == std::vector<Block_element>{{0, 0}});
  CHECK(report.is_certified());
}

TEST_CASE("restore_validity: bad input is refused, and no cells are no trouble", "[volume]")
{
  Deformed_mesh m(box_of(Element_type::prism, 2, 1));
  const auto blocks = m.mesh.blocks();
  const std::vector<Node_role> few(m.roles.begin(), m.roles.end() - 1);
  const std::vector<Point> fewer(m.nodes.begin(), m.nodes.end() - 1);
  std::vector<double> factors(3);
  CHECK_THROWS_AS(restore_validity(m.nodes, m.mesh.nodes, blocks, 2, {few}), Input_error);
  CHECK_THROWS_AS(restore_validity(m.nodes, fewer, blocks, 2, {m.roles}), Input_error);
  CHECK_THROWS_AS(restore_validity(m.nodes, m.mesh.nodes, blocks, 0, {m.roles}), Input_error);
  CHECK_THROWS_AS(restore_validity(m.nodes, m.mesh.nodes, blocks, 7, {m.roles}), Input_error);
  CHECK_THROWS_AS(restore_validity(m.nodes, m.mesh.nodes, blocks, 2, {m.roles, {}, factors}), Input_error);
  CHECK_THROWS_AS(restore_validity(m.nodes, m.mesh.nodes, blocks, 2, {m.roles}, {.repair_layers = -1}), Input_error);
  CHECK_THROWS_AS(restore_validity(m.nodes, m.mesh.nodes, blocks, 2, {m.roles}, {.smoothing_layers = 1000}),
                  Input_error);
  const std::vector<std::array<Index, 2>> linked = {{0, 1000}};
  CHECK_THROWS_AS(restore_validity(m.nodes, m.mesh.nodes, blocks, 2, {m.roles, linked}), Input_error);
  const std::vector<Index> beyond = {0, 1, 2, 1000};
  CHECK_THROWS_AS(restore_validity(m.nodes, m.mesh.nodes,
                                   std::vector<Element_block>{{Element_type::tetrahedron, beyond}}, 1, {m.roles}),
                  Input_error);

  std::vector<Point> none;
  CHECK(restore_validity(none, none, std::vector<Element_block>(), 2, {}).is_certified());
}
