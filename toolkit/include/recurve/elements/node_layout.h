#ifndef RECURVE_ELEMENTS_NODE_LAYOUT_H
#define RECURVE_ELEMENTS_NODE_LAYOUT_H

#include <recurve/elements/element.h>

#include <array>
#include <span>

namespace recurve {

/// Position of a node of an element of degree p on the integer lattice; divided by p it is the reference coordinate.
using Lattice_point = std::array<int, 3>;

/// the nodes of the element in canonical order, as lattice points: the corners; then edge by edge (in the order of
/// `Reference_element::edges`, each from its first to its second corner) the nodes inside edges; then face by face
/// the nodes inside faces; then the nodes inside the cell.
///
/// Inside a face the order is that of the face's own interior: the face's lattice has i from its corner 0 to its corner
/// 1 and j from its corner 0 to its last corner, i runs fastest. Inside a cell i runs fastest, k slowest. \pre 1 <=
/// degree <= max_degree. The span stays valid for the life of the program.
std::span<const Lattice_point> canonical_nodes(Element_type type, int degree);

/// canonical number of the first node inside edge `edge`; its degree - 1 nodes follow one another.
int first_edge_node(Element_type type, int degree, int edge);

/// canonical number of the first node inside face `face` of a cell; they follow one another.
int first_face_node(Element_type type, int degree, int face);

/// canonical number of the first node inside the element (inside the face, for triangles and quadrangles).
int first_interior_node(Element_type type, int degree);

/// canonical numbers, in the cell, of all nodes of edge `edge`, in the canonical order of a line (both ends first).
std::span<const int> edge_nodes(Element_type type, int degree, int edge);

/// canonical numbers, in the cell, of all nodes of face `face`, in the canonical order of the face as a triangle or
/// quadrangle with the corners of `Reference_element::faces[face]`.
std::span<const int> face_nodes(Element_type type, int degree, int face);

/// for a triangle or quadrangle whose corners are renumbered, where its nodes go: node m of the renumbered face is node
/// result[m] of the original. The renumbered face's corner c is corner (first + c) mod n of the original, or
/// (first - c) mod n if `reversed`. Used to match a face with its neighbour's view of it.
std::span<const int> face_orientation(Element_type face_type, int degree, int first, bool reversed);

/// Node orders of foreign formats, complete element families only.
enum class Node_order : std::uint8_t
{
  cgns, ///< SIDS; degree <= 4
  gmsh, ///< MSH 2.2 and 4.1; degree <= 6
  vtk,  ///< Lagrange cells of VTK >= 9.1 (files of version 2.2); degree <= 6; no pyramid
  rows  ///< HOPR, and SU2 above degree 1: the lattice row by row, i fastest and k slowest; degree <= 6
};

bool has_node_order(Node_order order, Element_type type, int degree);

/// permutation from canonical to foreign: foreign node m is canonical node result[m].
/// \throws Input_error unless has_node_order().
std::span<const int> canonical_of_foreign(Node_order order, Element_type type, int degree);

/// its inverse: canonical node m is foreign node result[m].
std::span<const int> foreign_of_canonical(Node_order order, Element_type type, int degree);

} // namespace recurve

#endif
