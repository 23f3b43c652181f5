#ifndef RECURVE_SRC_ELEMENTS_LATTICE_H
#define RECURVE_SRC_ELEMENTS_LATTICE_H

#include <recurve/elements/node_layout.h>

#include <span>
#include <vector>

namespace recurve::internal {

using Lattice = std::vector<Lattice_point>;

/// corner `corner` of the element of degree `degree` on its lattice.
inline Lattice_point lattice_corner(Element_type type, int degree, int corner)
{
  const std::array<int, 3>& c = reference_element(type).corners[corner];
  return {degree * c[0], degree * c[1], degree * c[2]};
}

/// the lattice point of a face, i along its first edge and j towards its last corner, as a lattice point of the cell.
/// `corners` are the face's corners as corners of the cell; of four, the third is not needed.
inline Lattice_point on_face(Element_type cell, std::span<const int> corners, int degree, const Lattice_point& ij)
{
  const Reference_element& element = reference_element(cell);
  const auto& a = element.corners[corners.front()];
  const auto& b = element.corners[corners[1]];
  const auto& c = element.corners[corners.back()];
  Lattice_point point;
  for (int axis = 0; axis < 3; ++axis)
    point[axis] = degree * a[axis] + ij[0] * (b[axis] - a[axis]) + ij[1] * (c[axis] - a[axis]);
  return point;
}

/// appends the nodes inside the edge from corner `from` to corner `to`, in that direction.
inline void append_edge(Lattice& nodes, Element_type type, int degree, int from, int to)
{
  const Lattice_point a = reference_element(type).corners[from];
  const Lattice_point b = reference_element(type).corners[to];
  for (int k = 1; k < degree; ++k)
    nodes.push_back({(degree - k) * a[0] + k * b[0], (degree - k) * a[1] + k * b[1], (degree - k) * a[2] + k * b[2]});
}

/// whether a lattice point with positive coordinates lies strictly inside the element.
bool is_inside(Element_type type, int degree, const Lattice_point& point);

/// the nodes inside the element, i fastest, then j, then k.
Lattice interior_lattice(Element_type type, int degree);

/// the nodes of `type` in the order of a foreign format; empty if the format has no such element.
Lattice foreign_nodes(Node_order order, Element_type type, int degree);

} // namespace recurve::internal

#endif
