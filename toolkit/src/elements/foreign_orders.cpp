// The node orders of Gmsh, the SIDS (CGNS), VTK and HOPR as rules that list lattice points: corners, edges, faces,
// interior, each format with its own numbering of edges and faces and its own order inside them. Nothing else in the
// library knows them.
#include "lattice.h"

#include <algorithm>
#include <functional>

namespace recurve::internal {

namespace {

using Edge = std::array<int, 2>;
using Corners = std::vector<int>;

/// One format's numbering of an element and the order of nodes inside its faces and cell.
struct Numbering
{
  std::vector<Edge> edges;
  std::vector<Corners> faces;
  std::function<Lattice(Element_type face, int degree)> inside_face;
  std::function<Lattice(Element_type cell, int degree)> inside_cell;
};

Lattice shifted(Lattice nodes, const Lattice_point& by)
{
  for (Lattice_point& node : nodes)
    for (int axis = 0; axis < 3; ++axis)
      node[axis] += by[axis];
  return nodes;
}

/// a single node, where the recursion of a format ends.
Lattice one_node()
{
  return {Lattice_point{0, 0, 0}};
}

Lattice listed(Element_type type, int degree, const Numbering& numbering)
{
  const Reference_element& element = reference_element(type);
  Lattice nodes;
  for (int corner = 0; corner < element.corner_count; ++corner)
    nodes.push_back(lattice_corner(type, degree, corner));
  for (const Edge& edge : numbering.edges)
    append_edge(nodes, type, degree, edge[0], edge[1]);
  for (const Corners& face : numbering.faces)
  {
    const Element_type face_type = face.size() == 3 ? Element_type::triangle : Element_type::quadrangle;
    for (const Lattice_point& ij : numbering.inside_face(face_type, degree))
      nodes.push_back(on_face(type, face, degree, ij));
  }
  const Lattice inside = element.dimension == 3   ? numbering.inside_cell(type, degree)
                         : element.dimension == 2 ? numbering.inside_face(type, degree)
                                                  : Lattice{};
  nodes.insert(nodes.end(), inside.begin(), inside.end());
  return nodes;
}

/// all nodes of an element of degree >= 0 by `nodes_of`, of which degree 0 is the single node and less is none.
Lattice nested(const std::function<Lattice(Element_type, int)>& nodes_of, Element_type type, int degree)
{
  if (degree < 0)
    return {};
  return degree == 0 ? one_node() : nodes_of(type, degree);
}

/// what is inside the element of degree p is an element of this much less degree, in formats that nest.
int inner_degree(Element_type type, int degree)
{
  switch (type)
  {
  case Element_type::triangle:
  case Element_type::pyramid: return degree - 3;
  case Element_type::tetrahedron: return degree - 4;
  default: return degree - 2;
  }
}

// --- Gmsh: everything nests
// --------------------------------------------------------------------------------------------

Lattice gmsh_nodes(Element_type type, int degree);

Lattice gmsh_inside_face(Element_type face, int degree)
{
  return shifted(nested(gmsh_nodes, face, inner_degree(face, degree)), {1, 1, 0});
}

Lattice gmsh_inside_cell(Element_type cell, int degree)
{
  if (cell != Element_type::prism)
    return shifted(nested(gmsh_nodes, cell, inner_degree(cell, degree)), {1, 1, 1});
  Lattice nodes;
  for (const Lattice_point& ij : gmsh_inside_face(Element_type::triangle, degree))
    for (const Lattice_point& k : nested(gmsh_nodes, Element_type::line, degree - 2))
      nodes.push_back({ij[0], ij[1], k[0] + 1});
  return nodes;
}

Numbering gmsh_numbering(Element_type type)
{
  Numbering n{{}, {}, gmsh_inside_face, gmsh_inside_cell};
  switch (type)
  {
  case Element_type::line: n.edges = {{0, 1}}; break;
  case Element_type::triangle: n.edges = {{0, 1}, {1, 2}, {2, 0}}; break;
  case Element_type::quadrangle: n.edges = {{0, 1}, {1, 2}, {2, 3}, {3, 0}}; break;
  case Element_type::tetrahedron:
    n.edges = {{0, 1}, {1, 2}, {2, 0}, {3, 0}, {3, 2}, {3, 1}};
    n.faces = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {3, 1, 2}};
    break;
  case Element_type::pyramid:
    n.edges = {{0, 1}, {0, 3}, {0, 4}, {1, 2}, {1, 4}, {2, 3}, {2, 4}, {3, 4}};
    n.faces = {{0, 1, 4}, {3, 0, 4}, {1, 2, 4}, {2, 3, 4}, {0, 3, 2, 1}};
    break;
  case Element_type::prism:
    n.edges = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 4}, {2, 5}, {3, 4}, {3, 5}, {4, 5}};
    n.faces = {{0, 2, 1}, {3, 4, 5}, {0, 1, 4, 3}, {0, 3, 5, 2}, {1, 2, 5, 4}};
    break;
  case Element_type::hexahedron:
    n.edges = {{0, 1}, {0, 3}, {0, 4}, {1, 2}, {1, 5}, {2, 3}, {2, 6}, {3, 7}, {4, 5}, {4, 7}, {5, 6}, {6, 7}};
    n.faces = {{0, 3, 2, 1}, {0, 1, 5, 4}, {0, 4, 7, 3}, {1, 2, 6, 5}, {2, 3, 7, 6}, {4, 5, 6, 7}};
    break;
  }
  return n;
}

Lattice gmsh_nodes(Element_type type, int degree)
{
  return listed(type, degree, gmsh_numbering(type));
}

// --- SIDS: edges as in Reference_element; squares by rings, cells by layers
// ---------------------------------------------

/// the (n+1) x (n+1) lattice walked in rings from the outside, each from the first corner towards the second.
Lattice rings(int n)
{
  Lattice nodes;
  for (int low = 0, high = n; low <= high; ++low, --high)
  {
    if (low == high)
      nodes.push_back({low, low, 0});
    for (int i = low; i < high; ++i)
      nodes.push_back({i, low, 0});
    for (int j = low; j < high; ++j)
      nodes.push_back({high, j, 0});
    for (int i = high; i > low; --i)
      nodes.push_back({i, high, 0});
    for (int j = high; j > low; --j)
      nodes.push_back({low, j, 0});
  }
  return nodes;
}

Lattice cgns_inside_face(Element_type face, int degree)
{
  // Triangles nest as Gmsh's do; up to the quartic only three corners are inside.
  return face == Element_type::triangle ? gmsh_inside_face(face, degree) : shifted(rings(degree - 2), {1, 1, 0});
}

/// layers in k, each as the inside of face `layer`.
Lattice cgns_layers(Element_type layer, int degree)
{
  Lattice nodes;
  for (int k = 1; k < degree; ++k)
    for (const Lattice_point& ij : cgns_inside_face(layer, degree))
      nodes.push_back({ij[0], ij[1], k});
  return nodes;
}

Lattice cgns_inside_cell(Element_type cell, int degree)
{
  switch (cell)
  {
  case Element_type::prism: return cgns_layers(Element_type::triangle, degree);
  case Element_type::hexahedron: return cgns_layers(Element_type::quadrangle, degree);
  case Element_type::pyramid: // a pyramid of degree p - 3 whose squares are walked in rings
  {
    Lattice nodes;
    for (int k = 1; k <= degree - 2; ++k)
      for (const Lattice_point& ij : rings(degree - 2 - k))
        nodes.push_back({ij[0] + 1, ij[1] + 1, k});
    return nodes;
  }
  default: return interior_lattice(cell, degree); // of a tetrahedron of degree <= 4 one node at most
  }
}

Numbering cgns_numbering(Element_type type)
{
  Numbering n{{}, {}, cgns_inside_face, cgns_inside_cell};
  const Reference_element& element = reference_element(type);
  for (int edge = 0; edge < element.edge_count; ++edge)
    n.edges.push_back(element.edges[edge]);
  // The faces start where the SIDS's tables of mid-face nodes start, which is not always a face's first corner.
  switch (type)
  {
  case Element_type::tetrahedron: n.faces = {{0, 1, 2}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}; break;
  case Element_type::pyramid: n.faces = {{0, 1, 2, 3}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}}; break;
  case Element_type::prism: n.faces = {{0, 1, 2}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}, {3, 4, 5}}; break;
  case Element_type::hexahedron:
    n.faces = {{0, 1, 2, 3}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}, {4, 5, 6, 7}};
    break;
  default: break;
  }
  return n;
}

// --- VTK: edges and square faces run along the axes; simplices nest
// ----------------------------------------------------

Lattice vtk_nodes(Element_type type, int degree);

Lattice vtk_inside_simplex_face(Element_type face, int degree)
{
  return shifted(nested(vtk_nodes, face, inner_degree(face, degree)), {1, 1, 0});
}

Lattice vtk_inside_cell(Element_type cell, int degree)
{
  if (cell == Element_type::tetrahedron)
    return shifted(nested(vtk_nodes, cell, inner_degree(cell, degree)), {1, 1, 1});
  return interior_lattice(cell, degree);
}

Numbering vtk_numbering(Element_type type)
{
  Numbering n{{}, {}, interior_lattice, vtk_inside_cell};
  switch (type)
  {
  case Element_type::line: n.edges = {{0, 1}}; break;
  case Element_type::triangle:
    n.edges = {{0, 1}, {1, 2}, {2, 0}};
    n.inside_face = vtk_inside_simplex_face;
    break;
  case Element_type::quadrangle: n.edges = {{0, 1}, {1, 2}, {3, 2}, {0, 3}}; break;
  case Element_type::tetrahedron:
    n.edges = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
    n.faces = {{0, 1, 3}, {2, 3, 1}, {0, 3, 2}, {0, 2, 1}};
    n.inside_face = vtk_inside_simplex_face;
    break;
  case Element_type::prism: // unlike the triangle itself, its triangles do not nest
    n.edges = {{0, 1}, {1, 2}, {2, 0}, {3, 4}, {4, 5}, {5, 3}, {0, 3}, {1, 4}, {2, 5}};
    n.faces = {{0, 1, 2}, {3, 4, 5}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}};
    break;
  case Element_type::hexahedron: // the numbering since VTK 9.1
    n.edges = {{0, 1}, {1, 2}, {3, 2}, {0, 3}, {4, 5}, {5, 6}, {7, 6}, {4, 7}, {0, 4}, {1, 5}, {2, 6}, {3, 7}};
    n.faces = {{0, 3, 7, 4}, {1, 2, 6, 5}, {0, 1, 5, 4}, {3, 2, 6, 7}, {0, 1, 2, 3}, {4, 5, 6, 7}};
    break;
  default: break;
  }
  return n;
}

Lattice vtk_nodes(Element_type type, int degree)
{
  return listed(type, degree, vtk_numbering(type));
}

// --- HOPR and SU2: no corners first, but the lattice row by row
// ---------------------------------------------------------------------

/// whether the element has the lattice point. The heights of a pyramid are squares, each smaller than the one below.
bool is_on_lattice(Element_type type, int degree, const Lattice_point& point)
{
  const auto& [i, j, k] = point;
  switch (type)
  {
  case Element_type::triangle:
  case Element_type::prism: return i + j <= degree;
  case Element_type::tetrahedron: return i + j + k <= degree;
  case Element_type::pyramid: return std::max(i, j) + k <= degree;
  default: return true;
  }
}

Lattice rows_of_nodes(Element_type type, int degree)
{
  const int dimension = reference_element(type).dimension;
  Lattice nodes;
  for (int k = 0; k <= (dimension > 2 ? degree : 0); ++k)
    for (int j = 0; j <= (dimension > 1 ? degree : 0); ++j)
      for (int i = 0; i <= degree; ++i)
        if (is_on_lattice(type, degree, {i, j, k}))
          nodes.push_back({i, j, k});
  return nodes;
}

} // namespace

Lattice foreign_nodes(Node_order order, Element_type type, int degree)
{
  switch (order)
  {
  case Node_order::gmsh: return gmsh_nodes(type, degree);
  case Node_order::cgns: return degree <= 4 ? listed(type, degree, cgns_numbering(type)) : Lattice{};
  case Node_order::vtk: return type != Element_type::pyramid ? vtk_nodes(type, degree) : Lattice{};
  case Node_order::rows: return rows_of_nodes(type, degree);
  }
  return {};
}

} // namespace recurve::internal
