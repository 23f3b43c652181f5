#ifndef RECURVE_ELEMENTS_ELEMENT_H
#define RECURVE_ELEMENTS_ELEMENT_H

#include <array>
#include <cstdint>
#include <string_view>

namespace recurve {

enum class Element_type : std::uint8_t
{
  line,
  triangle,
  quadrangle,
  tetrahedron,
  pyramid,
  prism,
  hexahedron
};

inline constexpr std::array<Element_type, 7> all_element_types = {
  Element_type::line,    Element_type::triangle, Element_type::quadrangle, Element_type::tetrahedron,
  Element_type::pyramid, Element_type::prism,    Element_type::hexahedron};

/// Largest degree p of an element.
inline constexpr int max_degree = 6;

/// A face of a cell: its corners, as corner numbers of the cell, counter-clockwise seen from outside the cell.
struct Reference_face
{
  Element_type type = Element_type::triangle;
  int corner_count = 3;
  std::array<int, 4> corners = {};
};

/// One reference element. Corners lie at points of {0, 1}^3; the apex of the pyramid is (0, 0, 1), so that its
/// heights k hold the squares 0 <= i, j <= 1 - k. Corners, edges and faces are numbered as in the SIDS (CGNS).
///
///     line            0 (0,0,0)  1 (1,0,0)
///     triangle        0 (0,0,0)  1 (1,0,0)  2 (0,1,0)
///     quadrangle      0 (0,0,0)  1 (1,0,0)  2 (1,1,0)  3 (0,1,0)
///     tetrahedron     0 (0,0,0)  1 (1,0,0)  2 (0,1,0)  3 (0,0,1)
///     pyramid         0 (0,0,0)  1 (1,0,0)  2 (1,1,0)  3 (0,1,0)  4 (0,0,1)
///     prism           0 (0,0,0)  1 (1,0,0)  2 (0,1,0)  3 (0,0,1)  4 (1,0,1)  5 (0,1,1)
///     hexahedron      0 (0,0,0)  1 (1,0,0)  2 (1,1,0)  3 (0,1,0)  4 (0,0,1)  5 (1,0,1)  6 (1,1,1)  7 (0,1,1)
struct Reference_element
{
  Element_type type = Element_type::line;
  int dimension = 1;
  int corner_count = 2;
  int edge_count = 1;
  int face_count = 0; ///< faces of a cell; 0 for lines, triangles and quadrangles
  std::array<std::array<int, 3>, 8> corners = {};
  std::array<std::array<int, 2>, 12> edges = {}; ///< corner numbers, from first to second
  std::array<Reference_face, 6> faces = {};
};

/// the table row of `type`.
const Reference_element& reference_element(Element_type type);

/// "tetrahedron", ... in lower case, as in reports and messages.
std::string_view element_name(Element_type type);

/// number of nodes of the complete element of degree `degree` >= 1: 4, 10, 20, ... for tetrahedra.
constexpr int node_count(Element_type type, int degree)
{
  const int n = degree + 1;
  switch (type)
  {
  case Element_type::line: return n;
  case Element_type::triangle: return n * (n + 1) / 2;
  case Element_type::quadrangle: return n * n;
  case Element_type::tetrahedron: return n * (n + 1) * (n + 2) / 6;
  case Element_type::pyramid: return n * (n + 1) * (2 * n + 1) / 6;
  case Element_type::prism: return n * n * (n + 1) / 2;
  case Element_type::hexahedron: return n * n * n;
  }
  return 0;
}

constexpr int corner_count(Element_type type)
{
  return node_count(type, 1);
}

/// number of nodes strictly inside the element: not on its boundary, that is neither corner nor (of faces and cells) on
/// an edge nor (of cells) on a face.
int interior_node_count(Element_type type, int degree);

} // namespace recurve

#endif
