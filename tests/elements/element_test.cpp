#include <recurve/elements/element.h>
#include <recurve/elements/node_layout.h>

#include <catch2/catch.hpp>

#include <algorithm>
#include <map>
#include <set>

using namespace recurve;

namespace {

using Vector = std::array<double, 3>;

Vector corner(const Reference_element& element, int c)
{
  return {double(element.corners[c][0]), double(element.corners[c][1]), double(element.corners[c][2])};
}

Vector minus(const Vector& a, const Vector& b)
{
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

double triple(const Vector& a, const Vector& b, const Vector& c)
{
  return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

Vector centre(const Reference_element& element)
{
  Vector sum = {};
  for (int c = 0; c < element.corner_count; ++c)
    for (int axis = 0; axis < 3; ++axis)
      sum[axis] += double(element.corners[c][axis]) / element.corner_count;
  return sum;
}

} // namespace

TEST_CASE("corners, edges and faces of every cell satisfy Euler's formula")
{
  for (Element_type type : all_element_types)
  {
    const Reference_element& element = reference_element(type);
    CAPTURE(element_name(type));
    CHECK(element.type == type);
    CHECK(element.corner_count == corner_count(type));
    if (element.dimension == 3)
      CHECK(element.corner_count - element.edge_count + element.face_count == 2);
    if (element.dimension == 2)
      CHECK(element.corner_count == element.edge_count);
  }
}

TEST_CASE("every face is counter-clockwise seen from outside, and planar")
{
  for (Element_type type : all_element_types)
  {
    const Reference_element& element = reference_element(type);
    for (int f = 0; f < element.face_count; ++f)
    {
      CAPTURE(element_name(type), f);
      const Reference_face& face = element.faces[f];
      CHECK(corner_count(face.type) == face.corner_count);
      const Vector a = corner(element, face.corners[0]), b = corner(element, face.corners[1]),
                   c = corner(element, face.corners[2]);
      CHECK(triple(minus(b, a), minus(c, a), minus(centre(element), a)) < 0);
      if (face.corner_count == 4)
        CHECK(triple(minus(b, a), minus(c, a), minus(corner(element, face.corners[3]), a)) == 0);
    }
  }
}

TEST_CASE("the edges of a cell are those of its faces, each between two faces that run along it in opposite directions")
{
  for (Element_type type : all_element_types)
  {
    const Reference_element& element = reference_element(type);
    if (element.dimension < 3)
      continue;
    CAPTURE(element_name(type));
    std::map<std::pair<int, int>, int> directed;
    for (int f = 0; f < element.face_count; ++f)
      for (int c = 0; c < element.faces[f].corner_count; ++c)
        ++directed[{element.faces[f].corners[c], element.faces[f].corners[(c + 1) % element.faces[f].corner_count]}];
    CHECK(directed.size() == 2u * static_cast<unsigned>(element.edge_count));
    for (int e = 0; e < element.edge_count; ++e)
    {
      const auto [from, to] = element.edges[e];
      CHECK(directed.count({from, to}) == 1);
      CHECK(directed.count({to, from}) == 1);
    }
  }
}

TEST_CASE("node counts are those of the published element families")
{
  // Names of CGNS: TRI_6, QUAD_9, TETRA_10, ... carry the number of nodes.
  CHECK(node_count(Element_type::triangle, 4) == 15);
  CHECK(node_count(Element_type::quadrangle, 4) == 25);
  CHECK(node_count(Element_type::tetrahedron, 4) == 35);
  CHECK(node_count(Element_type::pyramid, 4) == 55);
  CHECK(node_count(Element_type::prism, 4) == 75);
  CHECK(node_count(Element_type::hexahedron, 4) == 125);
}

TEST_CASE("corners, nodes inside edges, faces and cell add up to all nodes")
{
  const int degree = GENERATE(1, 2, 3, 4, 5, 6);
  for (Element_type type : all_element_types)
  {
    const Reference_element& element = reference_element(type);
    CAPTURE(element_name(type), degree);
    int nodes = element.corner_count + interior_node_count(type, degree);
    if (element.dimension > 1)
      nodes += element.edge_count * (degree - 1);
    for (int f = 0; f < element.face_count; ++f)
      nodes += interior_node_count(element.faces[f].type, degree);
    CHECK(nodes == node_count(type, degree));
    CHECK(first_interior_node(type, degree) + interior_node_count(type, degree) == node_count(type, degree));
  }
}
