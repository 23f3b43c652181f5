#include <recurve/elements/node_layout.h>

#include <recurve/core/exceptions.h>
#include <recurve/elements/basis.h>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <fstream>
#include <map>
#include <numeric>
#include <string>
#include <vector>

using namespace recurve;

namespace {

using Lattice = std::vector<Lattice_point>;

nlohmann::json published_orders()
{
  std::ifstream file(RECURVE_SOURCE_DIR "/tests/elements/node_orderings.json");
  return nlohmann::json::parse(file);
}

Lattice lattice_of(const nlohmann::json& row)
{
  Lattice nodes;
  for (const auto& node : row.at("nodes"))
    nodes.push_back({node[0], node[1], node.size() > 2 ? node[2].get<int>() : 0});
  return nodes;
}

Lattice ours(Node_order order, Element_type type, int degree)
{
  Lattice nodes;
  for (int m : canonical_of_foreign(order, type, degree))
    nodes.push_back(canonical_nodes(type, degree)[m]);
  return nodes;
}

Element_type type_named(const std::string& name)
{
  for (Element_type type : all_element_types)
    if (element_name(type) == name)
      return type;
  throw Input_error(name);
}

const std::map<std::string, Element_type> cgns_families = {{"TRI", Element_type::triangle},
                                                           {"QUAD", Element_type::quadrangle},
                                                           {"TETRA", Element_type::tetrahedron},
                                                           {"PENTA", Element_type::prism},
                                                           {"HEXA", Element_type::hexahedron}};

bool is_identity(const std::vector<int>& permutation)
{
  for (std::size_t m = 0; m < permutation.size(); ++m)
    if (permutation[m] != static_cast<int>(m))
      return false;
  return true;
}

std::vector<int> composed(std::span<const int> first, std::span<const int> second)
{
  std::vector<int> result;
  for (int m : second)
    result.push_back(first[m]);
  return result;
}

} // namespace

TEST_CASE("Gmsh's and VTK's node orders are those of the programs")
{
  const auto [key, order, rows] =
    GENERATE(std::tuple("gmsh", Node_order::gmsh, 28), std::tuple("vtk", Node_order::vtk, 25));
  const nlohmann::json published = published_orders()[key];
  CHECK(published.size() == static_cast<std::size_t>(rows));
  for (const auto& [name, row] : published.items())
  {
    CAPTURE(key, name);
    CHECK(ours(order, type_named(name.substr(0, name.size() - 1)), name.back() - '0') == lattice_of(row));
  }
}

TEST_CASE("CGNS's node orders are those of the SIDS")
{
  const nlohmann::json published = published_orders()["cgns"];
  CHECK(published.size() == 15);
  for (const auto& [name, row] : published.items())
  {
    CAPTURE(name);
    CHECK(ours(Node_order::cgns, cgns_families.at(name.substr(0, name.find('_'))), row.at("degree")) ==
          lattice_of(row));
  }
}

TEST_CASE("CGNS's pyramids are those of the SIDS's figures")
{
  // Read off the tables and layer drawings of PYRA_30 and PYRA_55, nodes counted from 0 there as N1 ....
  const Lattice cubic = ours(Node_order::cgns, Element_type::pyramid, 3);
  const Lattice base = {{1, 1, 0}, {2, 1, 0}, {2, 2, 0}, {1, 2, 0}};  // N22 .. N25
  const Lattice sides = {{1, 0, 1}, {2, 1, 1}, {1, 2, 1}, {0, 1, 1}}; // N26 .. N29 in the layer of N14, N16, N18, N20
  CHECK(Lattice(cubic.begin() + 21, cubic.begin() + 25) == base);
  CHECK(Lattice(cubic.begin() + 25, cubic.begin() + 29) == sides);
  CHECK(cubic[29] == Lattice_point{1, 1, 1}); // N30
  const Lattice quartic = ours(Node_order::cgns, Element_type::pyramid, 4);
  CHECK(quartic[5] == Lattice_point{1, 0, 0});  // N6, on the edge N1-N2
  CHECK(quartic[14] == Lattice_point{0, 3, 0}); // N15, on the edge N4-N1, beside N4
  CHECK(quartic[17] == Lattice_point{0, 0, 1}); // N18, on the edge N1-N5, beside N1
  CHECK(quartic[37] == Lattice_point{2, 2, 0}); // N38, the middle of the base
  CHECK(quartic[38] == Lattice_point{1, 0, 1}); // N39, centroid of N1-N7-N19
  CHECK(quartic[39] == Lattice_point{2, 0, 1}); // N40, of N2-N22-N7
  CHECK(quartic[40] == Lattice_point{1, 0, 2}); // N41, of N5-N19-N22
  CHECK(quartic[44] == Lattice_point{2, 3, 1}); // N45, of N3-N13-N25
  CHECK(quartic[49] == Lattice_point{0, 1, 2}); // N50, of N5-N28-N19
  CHECK(quartic[52] == Lattice_point{2, 2, 1}); // N53, third of the ring N51 .. N54
  CHECK(quartic[54] == Lattice_point{1, 1, 2}); // N55
}

TEST_CASE("rows are the loops of HOPR's specification")
{
  const int degree = GENERATE(1, 2, 3, 4, 5, 6);
  CAPTURE(degree);
  Lattice hexahedron, prism, pyramid, tetrahedron;
  for (int k = 0; k <= degree; ++k)
    for (int j = 0; j <= degree; ++j)
      for (int i = 0; i <= degree; ++i)
        hexahedron.push_back({i, j, k});
  for (int k = 0; k <= degree; ++k)
    for (int j = 0; j <= degree; ++j)
      for (int i = 0; i <= degree - j; ++i)
        prism.push_back({i, j, k});
  for (int k = 0; k <= degree; ++k)
    for (int j = 0; j <= degree - k; ++j)
      for (int i = 0; i <= degree - k; ++i)
        pyramid.push_back({i, j, k});
  for (int k = 0; k <= degree; ++k)
    for (int j = 0; j <= degree - k; ++j)
      for (int i = 0; i <= degree - j - k; ++i)
        tetrahedron.push_back({i, j, k});
  CHECK(ours(Node_order::rows, Element_type::hexahedron, degree) == hexahedron);
  CHECK(ours(Node_order::rows, Element_type::prism, degree) == prism);
  CHECK(ours(Node_order::rows, Element_type::pyramid, degree) == pyramid);
  CHECK(ours(Node_order::rows, Element_type::tetrahedron, degree) == tetrahedron);
}

TEST_CASE("permutations to and from every foreign order undo each other")
{
  const int degree = GENERATE(1, 2, 3, 4, 5, 6);
  const Node_order order = GENERATE(Node_order::cgns, Node_order::gmsh, Node_order::vtk, Node_order::rows);
  for (Element_type type : all_element_types)
    if (has_node_order(order, type, degree))
    {
      CAPTURE(element_name(type), degree, static_cast<int>(order));
      const auto there = canonical_of_foreign(order, type, degree), back = foreign_of_canonical(order, type, degree);
      CHECK(there.size() == static_cast<std::size_t>(node_count(type, degree)));
      CHECK(is_identity(composed(there, back)));
      CHECK(is_identity(composed(back, there)));
    }
}

TEST_CASE("an order that a format does not have is refused by name")
{
  CHECK_THROWS_WITH(canonical_of_foreign(Node_order::cgns, Element_type::hexahedron, 5),
                    "CGNS has no hexahedron of degree 5");
  CHECK_THROWS_AS(foreign_of_canonical(Node_order::vtk, Element_type::pyramid, 2), Input_error);
  CHECK_FALSE(has_node_order(Node_order::gmsh, Element_type::line, 7));
}

TEST_CASE("the nodes of an edge or face, taken from the cell, lie on it where its own layout has them")
{
  const int degree = GENERATE(1, 2, 3, 4, 5, 6);
  for (Element_type type : all_element_types)
  {
    const Reference_element& element = reference_element(type);
    const auto nodes = canonical_nodes(type, degree);
    for (int e = 0; e < element.edge_count; ++e)
    {
      const auto on_edge = edge_nodes(type, degree, e);
      const auto line = canonical_nodes(Element_type::line, degree);
      CAPTURE(element_name(type), degree, e);
      REQUIRE(on_edge.size() == line.size());
      const auto &a = element.corners[element.edges[e][0]], &b = element.corners[element.edges[e][1]];
      for (std::size_t m = 0; m < line.size(); ++m)
        for (int axis = 0; axis < 3; ++axis)
          CHECK(nodes[on_edge[m]][axis] == degree * a[axis] + line[m][0] * (b[axis] - a[axis]));
    }
    for (int f = 0; f < element.face_count; ++f)
    {
      const Reference_face& face = element.faces[f];
      const auto on_face = face_nodes(type, degree, f);
      const auto flat = canonical_nodes(face.type, degree);
      CAPTURE(element_name(type), degree, f);
      REQUIRE(on_face.size() == flat.size());
      const auto &a = element.corners[face.corners[0]], &b = element.corners[face.corners[1]],
                 &c = element.corners[face.corners[face.corner_count - 1]];
      for (std::size_t m = 0; m < flat.size(); ++m)
        for (int axis = 0; axis < 3; ++axis)
          CHECK(nodes[on_face[m]][axis] ==
                degree * a[axis] + flat[m][0] * (b[axis] - a[axis]) + flat[m][1] * (c[axis] - a[axis]));
    }
  }
}

TEST_CASE("first_edge_node and first_face_node start the runs of nodes inside edges and faces")
{
  const int degree = GENERATE(2, 3, 4, 5, 6);
  for (Element_type type : all_element_types)
  {
    const Reference_element& element = reference_element(type);
    CAPTURE(element_name(type), degree);
    for (int e = 0; e < element.edge_count; ++e)
      for (int k = 0; k < degree - 1; ++k)
        CHECK(edge_nodes(type, degree, e)[2 + k] == first_edge_node(type, degree, e) + k);
    for (int f = 0; f < element.face_count; ++f)
    {
      const Element_type face = element.faces[f].type;
      for (int m = 0; m < interior_node_count(face, degree); ++m)
        CHECK(face_nodes(type, degree, f)[first_interior_node(face, degree) + m] ==
              first_face_node(type, degree, f) + m);
    }
  }
}

TEST_CASE("orientations of a face form the group of its symmetries")
{
  const int degree = GENERATE(1, 2, 3, 4, 5, 6);
  const Element_type type = GENERATE(Element_type::triangle, Element_type::quadrangle);
  const int n = corner_count(type);
  CAPTURE(degree, element_name(type));
  CHECK(is_identity(composed(face_orientation(type, degree, 0, false), face_orientation(type, degree, 0, false))));
  for (int first = 0; first < n; ++first)
  {
    const auto turn = face_orientation(type, degree, first, false);
    const auto back = face_orientation(type, degree, (n - first) % n, false);
    const auto mirror = face_orientation(type, degree, first, true);
    CHECK(is_identity(composed(turn, back)));
    CHECK(is_identity(composed(mirror, mirror)));
    for (int c = 0; c < n; ++c)
    {
      CHECK(turn[c] == (first + c) % n);
      CHECK(mirror[c] == (first - c + n) % n);
    }
    // a turn by one, `first` times over
    std::vector<int> turned(node_count(type, degree));
    std::iota(turned.begin(), turned.end(), 0);
    for (int step = 0; step < first; ++step)
      turned = composed(turned, face_orientation(type, degree, 1, false));
    CHECK(turned == std::vector<int>(turn.begin(), turn.end()));
  }
}

TEST_CASE("two cells that number a shared face differently agree on where its nodes are")
{
  const int degree = GENERATE(1, 2, 3, 4, 5, 6);
  const Element_type type = GENERATE(Element_type::triangle, Element_type::quadrangle);
  const int n = corner_count(type);
  // corners in no symmetric position, and not in a plane
  const std::array<std::array<double, 3>, 4> corners = {{{0, 0, 0}, {2, 0.25, 0}, {1.5, 3, 1}, {-0.5, 1, 0.75}}};
  const auto places = [&](int first, bool is_reversed) {
    std::vector<std::array<double, 3>> points;
    for (const Lattice_point& node : canonical_nodes(type, degree))
    {
      std::array<double, 4> weights = {};
      lagrange_basis(type, 1, {double(node[0]) / degree, double(node[1]) / degree, 0},
                     std::span<double>(weights).first(static_cast<std::size_t>(n)));
      std::array<double, 3> x = {};
      for (int c = 0; c < n; ++c)
        for (std::size_t d = 0; d < 3; ++d)
          x[d] += weights[c] * corners[(is_reversed ? first - c + n : first + c) % n][d];
      points.push_back(x);
    }
    return points;
  };
  const auto here = places(0, false);
  for (int first = 0; first < n; ++first)
    for (bool is_reversed : {false, true})
    {
      CAPTURE(degree, element_name(type), first, is_reversed);
      const auto there = places(first, is_reversed);
      const auto match = face_orientation(type, degree, first, is_reversed);
      for (std::size_t m = 0; m < there.size(); ++m)
        for (std::size_t d = 0; d < 3; ++d)
          CHECK(there[m][d] == Approx(here[static_cast<std::size_t>(match[m])][d]).margin(1e-14));
    }
}
