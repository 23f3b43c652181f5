#include <recurve/volume/blend_interior.h>

#include <recurve/core/exceptions.h>
#include <volume/small_meshes.h>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <Eigen/Core>
#include <catch2/catch.hpp>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <set>

using namespace recurve;
using namespace recurve::tests;

namespace {

using Function = std::function<double(const Point&)>;

/// `f` less its interpolant of degree 1, so that it vanishes at the corners as every displacement does.
Function without_corners(Element_type type, const Function& f)
{
  return [type, f](const Point& xi) {
    double value = f(xi);
    const std::vector<double> n = corner_functions(type, xi);
    for (std::size_t c = 0; c < n.size(); ++c)
    {
      const auto& corner = reference_element(type).corners[c];
      value -= n[c] * f({double(corner[0]), double(corner[1]), double(corner[2])});
    }
    return value;
  };
}

Function monomial(std::array<int, 3> powers)
{
  return [powers](const Point& xi) {
    return std::pow(xi[0], powers[0]) * std::pow(xi[1], powers[1]) * std::pow(xi[2], powers[2]);
  };
}

/// largest error of the nodes inside the reference element (`on_faces`: inside its faces) if the nodes on edges and
/// faces (on edges only) are displaced by `f`.
double blend_error(Element_type type, int degree, const Function& f, bool on_faces = false)
{
  const Function u = without_corners(type, f);
  Small_mesh mesh;
  mesh.degree = degree;
  std::vector<Point> corners;
  for (int c = 0; c < corner_count(type); ++c)
    corners.push_back(reference_point(type, 1, c));
  mesh.add(type, corners);
  const std::vector<Index>& element = mesh.elements[type];
  const int first_given = corner_count(type);
  const int first_asked = on_faces ? first_face_node(type, degree, 0) : first_interior_node(type, degree);
  const int end_asked = on_faces ? first_interior_node(type, degree) : node_count(type, degree);

  std::vector<Node_state> states(mesh.nodes.size(), Node_state::straight);
  const std::vector<Point> straight = mesh.nodes;
  const std::array<double, 3> amplitudes = {1, -0.5, 0.25};
  const auto curved = [&](int m) {
    Point p = straight[std::size_t(element[std::size_t(m)])];
    for (std::size_t d = 0; d < 3; ++d)
      p[d] += amplitudes[d] * u(reference_point(type, degree, m));
    return p;
  };
  for (int m = first_given; m < first_asked; ++m)
  {
    mesh.nodes[std::size_t(element[std::size_t(m)])] = curved(m);
    states[std::size_t(element[std::size_t(m)])] = Node_state::placed;
  }
  blend_interior(mesh.nodes, states, mesh.blocks(), degree);
  double error = 0;
  for (int m = first_asked; m < end_asked; ++m)
    for (std::size_t d = 0; d < 3; ++d)
      error = std::max(error, std::abs(mesh.nodes[std::size_t(element[std::size_t(m)])][d] - curved(m)[d]));
  return error;
}

constexpr double round_off = 1e-13; // displacements are of order 1

/// displaces the nodes on the edges (and every third on a face) of the elements' corner at the origin.
std::vector<Node_state> place_near_origin(Small_mesh& mesh, unsigned seed)
{
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> shift(-0.02, 0.02);
  std::vector<Node_state> states(mesh.nodes.size(), Node_state::straight);
  std::set<Index> candidates;
  for (const auto& [type, list] : mesh.elements)
    for (std::size_t e = 0; e < list.size(); e += std::size_t(node_count(type, mesh.degree)))
    {
      const int first_face =
        first_edge_node(type, mesh.degree, 0) + reference_element(type).edge_count * (mesh.degree - 1);
      for (int m = corner_count(type); m < first_interior_node(type, mesh.degree); ++m)
        if (m < first_face || m % 3 == 0)
          candidates.insert(list[e + std::size_t(m)]);
    }
  for (const Index id : candidates)
  {
    Point& p = mesh.nodes[std::size_t(id)];
    if (p[0] + p[1] + p[2] > 0.9)
      continue;
    for (double& x : p)
      x += shift(random);
    states[std::size_t(id)] = Node_state::placed;
  }
  return states;
}

} // namespace

TEST_CASE("blend_interior: the polynomials it promises are reproduced inside the element", "[volume]")
{
  const int degree = GENERATE(2, 3, 4, 5, 6);
  const Element_type type = GENERATE(Element_type::triangle, Element_type::quadrangle, Element_type::tetrahedron,
                                     Element_type::pyramid, Element_type::prism, Element_type::hexahedron);
  CAPTURE(degree, element_name(type));
  for (int a = 0; a <= degree; ++a)
    for (int b = 0; b <= degree; ++b)
      for (int c = 0; c <= (reference_element(type).dimension == 3 ? degree : 0); ++c)
      {
        bool is_promised = false;
        switch (type)
        {
        case Element_type::triangle: is_promised = a + b <= 2; break;
        case Element_type::quadrangle: is_promised = std::min(a, b) <= 1; break;
        case Element_type::tetrahedron: is_promised = a + b + c <= std::min(3, degree); break;
        case Element_type::prism: is_promised = a + b <= degree && (a + b <= 2 || c <= 1); break;
        case Element_type::hexahedron: is_promised = std::min({a, b, c}) <= 1; break;
        default: is_promised = a + b + c <= std::min(3, degree); break;
        }
        if (!is_promised)
          continue;
        CAPTURE(a, b, c);
        CHECK(blend_error(type, degree, monomial({a, b, c})) < round_off);
      }
}

TEST_CASE("blend_interior: the rational functions of a pyramid are reproduced", "[volume]")
{
  const int degree = GENERATE(3, 4, 5, 6);
  CAPTURE(degree);
  for (int m = 0; m <= 2; ++m)
    for (int i = 0; i <= m; ++i)
      for (int j = 0; j <= m; ++j)
      {
        CAPTURE(m, i, j);
        const Function f = [=](const Point& xi) {
          const double r = 1 - xi[2];
          return r == 0 ? (m == 0 ? 1.0 : 0.0)
                        : std::pow(r, m) * std::pow(xi[0] / r, i) * std::pow(xi[1] / r, j) * std::pow(xi[2], 2 - m);
        };
        CHECK(blend_error(Element_type::pyramid, degree, f) < round_off);
      }
}

TEST_CASE("blend_interior: faces follow their edges", "[volume]")
{
  const int degree = GENERATE(2, 3, 4, 5, 6);
  const Element_type type =
    GENERATE(Element_type::tetrahedron, Element_type::pyramid, Element_type::prism, Element_type::hexahedron);
  CAPTURE(degree, element_name(type));
  const int exact = type == Element_type::hexahedron ? 3 : 2;
  for (int a = 0; a <= std::min(exact, degree); ++a)
    for (int b = 0; a + b <= exact && b <= degree; ++b)
      for (int c = 0; a + b + c <= exact && c <= degree; ++c)
      {
        CAPTURE(a, b, c);
        CHECK(blend_error(type, degree, monomial({a, b, c}), true) < round_off);
      }
}

TEST_CASE("blend_interior: what it does not promise differs by a bubble only", "[volume]")
{
  // A polynomial of the full degree has an inner part that its trace does not determine: if the test could not see
  // that, it could not see an error either.
  CHECK(blend_error(Element_type::hexahedron, 4, monomial({2, 2, 2})) > 1e-3);
  CHECK(blend_error(Element_type::triangle, 3, monomial({2, 1, 0})) > 1e-3);
  CHECK(blend_error(Element_type::tetrahedron, 4, monomial({2, 1, 1})) > 1e-4);
}

TEST_CASE("blend_interior: nothing placed, nothing moved", "[volume]")
{
  const Element_type type = GENERATE(from_range(cell_types));
  const int degree = GENERATE(2, 4);
  Small_mesh mesh = box_of(type, degree, 2);
  const std::vector<Point> before = mesh.nodes;
  const Node_state state = GENERATE(Node_state::straight, Node_state::fixed);
  std::vector<Node_state> states(mesh.nodes.size(), state);
  const Blend_report report = blend_interior(mesh.nodes, states, mesh.blocks(), degree);
  CHECK(mesh.nodes == before);
  CHECK(std::ranges::all_of(states, [&](Node_state s) { return s == state; }));
  CHECK(report.touched_elements == 0);
  CHECK(report.blended_nodes == 0);
  CHECK(report.largest_displacement == 0);
}

TEST_CASE("blend_interior: nodes placed where they stood move nothing", "[volume]")
{
  const Element_type type = GENERATE(from_range(cell_types));
  const int degree = GENERATE(2, 3, 6);
  CAPTURE(degree, element_name(type));
  Small_mesh mesh = box_of(type, degree, 2);
  const std::vector<Point> before = mesh.nodes;
  std::vector<Node_state> states = place_near_origin(mesh, 1);
  mesh.nodes = before;
  CHECK(blend_interior(mesh.nodes, states, mesh.blocks(), degree).blended_nodes == 0);
  CHECK(mesh.nodes == before);
}

TEST_CASE("blend_interior: elements without a placed node, edges, corners and fixed nodes keep their bits", "[volume]")
{
  const Element_type type = GENERATE(from_range(cell_types));
  const int degree = GENERATE(2, 3, 4, 6);
  CAPTURE(degree, element_name(type));
  Small_mesh mesh = box_of(type, degree, 2);
  std::vector<Node_state> states = place_near_origin(mesh, 1);
  for (std::size_t m = 0; m < states.size(); m += 5)
    if (states[m] == Node_state::straight)
      states[m] = Node_state::fixed;
  const std::vector<Point> before = mesh.nodes;
  const std::vector<Node_state> states_before = states;
  const Blend_report report = blend_interior(mesh.nodes, states, mesh.blocks(), degree);

  std::set<Index> movable;
  Index touched = 0;
  for (const auto& [t, list] : mesh.elements)
  {
    const auto n = std::size_t(node_count(t, degree));
    const int first_face = first_edge_node(t, degree, 0) + reference_element(t).edge_count * (degree - 1);
    for (std::size_t e = 0; e < list.size(); e += n)
    {
      bool is_touched = false;
      for (std::size_t m = std::size_t(corner_count(t)); m < n; ++m)
        is_touched = is_touched || states_before[std::size_t(list[e + m])] == Node_state::placed;
      touched += is_touched;
      if (is_touched)
        movable.insert(list.begin() + std::ptrdiff_t(e) + first_face, list.begin() + std::ptrdiff_t(e + n));
    }
  }
  CHECK(report.touched_elements == touched);
  Index moved = 0;
  for (std::size_t m = 0; m < before.size(); ++m)
  {
    const bool has_moved = mesh.nodes[m] != before[m];
    moved += has_moved;
    CHECK((states[m] == Node_state::blended) == has_moved);
    if (has_moved)
    {
      CHECK(states_before[m] == Node_state::straight);
      CHECK(movable.contains(static_cast<Index>(m)));
    }
  }
  CHECK(report.blended_nodes == moved);
  if (degree >= 4)
    CHECK(moved > 0);
}

TEST_CASE("blend_interior: the order of the elements does not matter, to the bit", "[volume]")
{
  const Element_type type = GENERATE(from_range(cell_types));
  const int degree = GENERATE(2, 3, 4, 5, 6);
  CAPTURE(degree, element_name(type));
  Small_mesh mesh = box_of(type, degree, 2);
  std::vector<Node_state> states = place_near_origin(mesh, 2);
  Small_mesh other = mesh;
  std::vector<Node_state> other_states = states;

  const auto n = std::size_t(node_count(type, degree));
  std::vector<Index>& list = other.elements[type];
  std::vector<Index> reversed;
  for (std::size_t e = list.size() / n; e-- > 0;)
    reversed.insert(reversed.end(), list.begin() + std::ptrdiff_t(e * n), list.begin() + std::ptrdiff_t((e + 1) * n));
  // two blocks and another number of threads as well
  const std::vector<Element_block> blocks = {{type, std::span<const Index>(reversed).first(n)},
                                             {type, std::span<const Index>(reversed).subspan(n)}};
  {
    const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, std::size_t(GENERATE(1, 7)));
    blend_interior(other.nodes, other_states, blocks, degree);
  }
  blend_interior(mesh.nodes, states, mesh.blocks(), degree);
  CHECK(mesh.nodes == other.nodes);
  CHECK(states == other_states);
}

TEST_CASE("blend_interior: a face has the value that its own edges give it, whichever cell shows it", "[volume]")
{
  const Element_type type = GENERATE(from_range(cell_types));
  const int degree = GENERATE(2, 3, 4, 5, 6);
  CAPTURE(degree, element_name(type));
  Small_mesh mesh = box_of(type, degree, 1);
  std::vector<Node_state> states = place_near_origin(mesh, 3);
  Small_mesh faces_only = mesh;
  std::vector<Node_state> face_states = states;
  const std::vector<Index>& list = mesh.elements[type];
  const auto n = std::size_t(node_count(type, degree));
  std::map<Element_type, std::vector<Index>> faces;
  for (std::size_t e = 0; e < list.size(); e += n)
    for (int f = 0; f < reference_element(type).face_count; ++f)
      for (const int m : face_nodes(type, degree, f))
        faces[reference_element(type).faces[std::size_t(f)].type].push_back(list[e + std::size_t(m)]);
  faces_only.elements = faces;
  blend_interior(mesh.nodes, states, mesh.blocks(), degree);
  blend_interior(faces_only.nodes, face_states, faces_only.blocks(), degree);
  std::size_t compared = 0;
  for (const auto& [t, nodes] : faces)
    for (const Index id : nodes)
    {
      ++compared;
      CHECK(mesh.nodes[std::size_t(id)] == faces_only.nodes[std::size_t(id)]);
    }
  CHECK(compared > 0);
}

TEST_CASE("blend_interior: a face in a plane stays in it to the bit", "[volume]")
{
  const int degree = GENERATE(2, 3, 4, 5, 6);
  const bool is_triangle = GENERATE(true, false);
  const std::size_t normal = std::size_t(GENERATE(0, 1, 2));
  const double height = GENERATE(0.0, 0.3, -1e7 / 3);
  const Element_type type = is_triangle ? Element_type::triangle : Element_type::quadrangle;
  CAPTURE(degree, is_triangle, normal, height);
  std::vector<Point> nodes;
  std::vector<Index> element;
  const std::vector<std::array<double, 2>> corners = {{0.1, 0.7}, {1.3, 0.6}, {1.7, 1.9}, {-0.2, 1.1}};
  const int edge_end = first_interior_node(type, degree);
  std::vector<Node_state> states;
  for (int m = 0; m < node_count(type, degree); ++m)
  {
    const std::vector<double> n = corner_functions(type, reference_point(type, degree, m));
    Point p = {0, 0, 0};
    p[normal] = height;
    for (std::size_t c = 0; c < n.size(); ++c)
      for (std::size_t d = 0; d < 2; ++d)
        p[(normal + 1 + d) % 3] += n[c] * corners[c][d];
    states.push_back(Node_state::straight);
    if (m >= corner_count(type) && m < edge_end)
    {
      p[(normal + 1) % 3] += 0.1 * m;
      states.back() = Node_state::placed;
    }
    nodes.push_back(p);
    element.push_back(m);
  }
  const Blend_report report = blend_interior(nodes, states, std::vector<Element_block>{{type, element}}, degree);
  CHECK(report.blended_nodes == interior_node_count(type, degree));
  for (const Point& p : nodes)
    CHECK(p[normal] == height);
}

TEST_CASE("blend_interior: unit and origin do not matter", "[volume]")
{
  const Element_type type = GENERATE(from_range(cell_types));
  const double scale = GENERATE(1e-6, 1.0, 1e6);
  const double offset = GENERATE(0.0, 1e6);
  CAPTURE(element_name(type), scale, offset);
  const int degree = 4;
  Small_mesh mesh = box_of(type, degree, 1);
  std::vector<Node_state> states = place_near_origin(mesh, 4);
  std::vector<Point> moved = mesh.nodes;
  for (Point& p : moved)
    for (double& x : p)
      x = scale * (x + offset);
  std::vector<Node_state> moved_states = states;
  blend_interior(mesh.nodes, states, mesh.blocks(), degree);
  blend_interior(moved, moved_states, mesh.blocks(), degree);
  for (std::size_t m = 0; m < moved.size(); ++m)
    for (std::size_t d = 0; d < 3; ++d)
      CHECK(moved[m][d] / scale - offset == Approx(mesh.nodes[m][d]).margin(1e-14 + 4e-15 * offset));
}

TEST_CASE("blend_interior: takes any range of points", "[volume]")
{
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  const int degree = 3;
  Small_mesh mesh = box_of(Element_type::hexahedron, degree, 1);
  std::vector<Node_state> states = place_near_origin(mesh, 5);
  std::vector<Kernel::Point_3> cgal_points;
  std::vector<Eigen::Vector3d> eigen_points;
  for (const Point& p : mesh.nodes)
  {
    cgal_points.emplace_back(p[0], p[1], p[2]);
    eigen_points.emplace_back(p[0], p[1], p[2]);
  }
  std::vector<Node_state> cgal_states = states, eigen_states = states;
  blend_interior(mesh.nodes, states, mesh.blocks(), degree);
  blend_interior(cgal_points, cgal_states, mesh.blocks(), degree);
  blend_interior(eigen_points, eigen_states, mesh.blocks(), degree);
  CHECK(std::ranges::count(states, Node_state::blended) > 0);
  for (std::size_t m = 0; m < mesh.nodes.size(); ++m)
    for (std::size_t d = 0; d < 3; ++d)
    {
      CHECK(cgal_points[m][int(d)] == mesh.nodes[m][d]);
      CHECK(eigen_points[m][Eigen::Index(d)] == mesh.nodes[m][d]);
    }
}

TEST_CASE("blend_interior: bad input is refused and changes nothing", "[volume]")
{
  Small_mesh mesh = box_of(Element_type::tetrahedron, 3, 1);
  std::vector<Node_state> states = place_near_origin(mesh, 6);
  const std::vector<Point> before = mesh.nodes;
  const std::vector<Node_state> states_before = states;
  CHECK_THROWS_AS(blend_interior(mesh.nodes, states, mesh.blocks(), 0), Input_error);
  CHECK_THROWS_AS(blend_interior(mesh.nodes, states, mesh.blocks(), 7), Input_error);
  CHECK_THROWS_AS(blend_interior(mesh.nodes, states, mesh.blocks(), 5), Input_error);
  std::vector<Node_state> too_few(states.begin(), states.end() - 1);
  CHECK_THROWS_AS(blend_interior(mesh.nodes, too_few, mesh.blocks(), 3), Input_error);
  std::vector<Element_block> blocks = mesh.blocks();
  mesh.elements[Element_type::tetrahedron].back() = static_cast<Index>(mesh.nodes.size());
  CHECK_THROWS_WITH(blend_interior(mesh.nodes, states, blocks, 3),
                    Catch::Contains("tetrahedron 5") && Catch::Contains("names node"));
  mesh.elements[Element_type::tetrahedron].back() = -1;
  CHECK_THROWS_AS(blend_interior(mesh.nodes, states, blocks, 3), Input_error);
  CHECK(mesh.nodes == before);
  CHECK(states == states_before);

  std::vector<Point> no_nodes;
  std::vector<Node_state> no_states;
  CHECK(blend_interior(no_nodes, no_states, std::vector<Element_block>{}, 3).blended_nodes == 0);
}
