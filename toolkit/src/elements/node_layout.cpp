#include <recurve/elements/node_layout.h>

#include "lattice.h"

#include <recurve/core/exceptions.h>

#include <algorithm>
#include <string>

namespace recurve {

namespace internal {

bool is_inside(Element_type type, int degree, const Lattice_point& point)
{
  const auto [i, j, k] = point;
  const int p = degree;
  switch (type)
  {
  case Element_type::line: return i < p;
  case Element_type::triangle: return i + j < p;
  case Element_type::quadrangle: return i < p && j < p;
  case Element_type::tetrahedron: return i + j + k < p;
  case Element_type::pyramid: return i + k < p && j + k < p;
  case Element_type::prism: return i + j < p && k < p;
  case Element_type::hexahedron: return i < p && j < p && k < p;
  }
  return false;
}

Lattice interior_lattice(Element_type type, int degree)
{
  const int dimension = reference_element(type).dimension;
  Lattice nodes;
  for (int k = dimension > 2 ? 1 : 0; k < (dimension > 2 ? degree : 1); ++k)
    for (int j = dimension > 1 ? 1 : 0; j < (dimension > 1 ? degree : 1); ++j)
      for (int i = 1; i < degree; ++i)
        if (is_inside(type, degree, {i, j, k}))
          nodes.push_back({i, j, k});
  return nodes;
}

} // namespace internal

namespace {

using namespace internal;

constexpr int order_count = 4;

/// for each of `points` its place in `nodes`.
std::vector<int> places(const Lattice& points, const Lattice& nodes)
{
  std::vector<int> result;
  for (const Lattice_point& point : points)
    result.push_back(static_cast<int>(std::find(nodes.begin(), nodes.end(), point) - nodes.begin()));
  return result;
}

std::vector<int> inverse(const std::vector<int>& permutation)
{
  std::vector<int> result(permutation.size());
  for (std::size_t m = 0; m < permutation.size(); ++m)
    result[permutation[m]] = static_cast<int>(m);
  return result;
}

/// All that is known of one element at one degree; see node_layout.h for each.
struct Layout
{
  Lattice nodes;
  std::array<int, 12> first_edge_node = {};
  std::array<int, 6> first_face_node = {};
  int first_interior_node = 0;
  std::array<std::vector<int>, 12> edge_nodes;
  std::array<std::vector<int>, 6> face_nodes;
  std::array<std::array<std::vector<int>, 2>, 4> orientations; ///< of a face: [first corner][reversed]
  std::array<std::vector<int>, order_count> canonical_of_foreign, foreign_of_canonical;
};

Lattice canonical_lattice(Element_type type, int degree, Layout& layout)
{
  const Reference_element& element = reference_element(type);
  Lattice nodes;
  for (int corner = 0; corner < element.corner_count; ++corner)
    nodes.push_back(lattice_corner(type, degree, corner));
  for (int edge = 0; edge < element.edge_count; ++edge)
  {
    layout.first_edge_node[edge] = static_cast<int>(nodes.size());
    append_edge(nodes, type, degree, element.edges[edge][0], element.edges[edge][1]);
  }
  for (int f = 0; f < element.face_count; ++f)
  {
    layout.first_face_node[f] = static_cast<int>(nodes.size());
    const Reference_face& face = element.faces[f];
    for (const Lattice_point& ij : interior_lattice(face.type, degree))
      nodes.push_back(on_face(type, {face.corners.data(), static_cast<std::size_t>(face.corner_count)}, degree, ij));
  }
  // The inside of a line is that of its one edge.
  layout.first_interior_node = element.dimension > 1 ? static_cast<int>(nodes.size()) : layout.first_edge_node[0];
  if (element.dimension > 1)
    for (const Lattice_point& point : interior_lattice(type, degree))
      nodes.push_back(point);
  return nodes;
}

/// the canonical nodes of a line, triangle or quadrangle, which have no faces to look up.
Lattice canonical_lattice(Element_type type, int degree)
{
  Layout unused;
  return canonical_lattice(type, degree, unused);
}

std::vector<int> nodes_on_edge(Element_type type, int degree, int edge, const Lattice& nodes)
{
  const std::array<int, 2>& ends = reference_element(type).edges[edge];
  Lattice points = {lattice_corner(type, degree, ends[0]), lattice_corner(type, degree, ends[1])};
  append_edge(points, type, degree, ends[0], ends[1]);
  return places(points, nodes);
}

/// the nodes of the face with these corners, in its own canonical order, by their number in `nodes`.
std::vector<int> nodes_on_face(Element_type type, int degree, std::span<const int> corners, const Lattice& nodes)
{
  const Element_type face = corners.size() == 3 ? Element_type::triangle : Element_type::quadrangle;
  Lattice points;
  for (const Lattice_point& ij : canonical_lattice(face, degree))
    points.push_back(on_face(type, corners, degree, ij));
  return places(points, nodes);
}

void fill_orientations(Element_type type, int degree, Layout& layout)
{
  const int n = corner_count(type);
  for (int first = 0; first < n; ++first)
    for (int reversed = 0; reversed < 2; ++reversed)
    {
      std::array<int, 4> corners;
      for (int c = 0; c < n; ++c)
        corners[c] = (first + (reversed ? n - c : c)) % n;
      layout.orientations[first][reversed] =
        nodes_on_face(type, degree, {corners.data(), static_cast<std::size_t>(n)}, layout.nodes);
    }
}

Layout make_layout(Element_type type, int degree)
{
  Layout layout;
  layout.nodes = canonical_lattice(type, degree, layout);
  const Reference_element& element = reference_element(type);
  for (int edge = 0; edge < element.edge_count; ++edge)
    layout.edge_nodes[edge] = nodes_on_edge(type, degree, edge, layout.nodes);
  for (int f = 0; f < element.face_count; ++f)
  {
    const Reference_face& face = element.faces[f];
    layout.face_nodes[f] =
      nodes_on_face(type, degree, {face.corners.data(), static_cast<std::size_t>(face.corner_count)}, layout.nodes);
  }
  if (element.dimension == 2)
    fill_orientations(type, degree, layout);
  for (int order = 0; order < order_count; ++order)
  {
    layout.canonical_of_foreign[order] =
      places(foreign_nodes(static_cast<Node_order>(order), type, degree), layout.nodes);
    layout.foreign_of_canonical[order] = inverse(layout.canonical_of_foreign[order]);
  }
  return layout;
}

std::vector<Layout> make_all_layouts()
{
  std::vector<Layout> layouts;
  for (Element_type type : all_element_types)
    for (int degree = 1; degree <= max_degree; ++degree)
      layouts.push_back(make_layout(type, degree));
  return layouts;
}

const Layout& layout_of(Element_type type, int degree)
{
  static const std::vector<Layout> layouts = make_all_layouts();
  return layouts[static_cast<int>(type) * max_degree + degree - 1];
}

std::string order_name(Node_order order)
{
  constexpr const char* names[order_count] = {"CGNS", "Gmsh", "VTK", "HOPR"};
  return names[static_cast<int>(order)];
}

void require_order(Node_order order, Element_type type, int degree)
{
  if (!has_node_order(order, type, degree))
    throw Input_error(order_name(order) + " has no " + std::string(element_name(type)) + " of degree " +
                      std::to_string(degree));
}

} // namespace

std::span<const Lattice_point> canonical_nodes(Element_type type, int degree)
{
  return layout_of(type, degree).nodes;
}

int first_edge_node(Element_type type, int degree, int edge)
{
  return layout_of(type, degree).first_edge_node[edge];
}

int first_face_node(Element_type type, int degree, int face)
{
  return layout_of(type, degree).first_face_node[face];
}

int first_interior_node(Element_type type, int degree)
{
  return layout_of(type, degree).first_interior_node;
}

std::span<const int> edge_nodes(Element_type type, int degree, int edge)
{
  return layout_of(type, degree).edge_nodes[edge];
}

std::span<const int> face_nodes(Element_type type, int degree, int face)
{
  return layout_of(type, degree).face_nodes[face];
}

std::span<const int> face_orientation(Element_type face_type, int degree, int first, bool reversed)
{
  return layout_of(face_type, degree).orientations[first][reversed ? 1 : 0];
}

bool has_node_order(Node_order order, Element_type type, int degree)
{
  return degree >= 1 && degree <= max_degree &&
         !layout_of(type, degree).canonical_of_foreign[static_cast<int>(order)].empty();
}

std::span<const int> canonical_of_foreign(Node_order order, Element_type type, int degree)
{
  require_order(order, type, degree);
  return layout_of(type, degree).canonical_of_foreign[static_cast<int>(order)];
}

std::span<const int> foreign_of_canonical(Node_order order, Element_type type, int degree)
{
  require_order(order, type, degree);
  return layout_of(type, degree).foreign_of_canonical[static_cast<int>(order)];
}

} // namespace recurve
