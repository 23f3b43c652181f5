#ifndef RECURVE_VOLUME_BLEND_INTERIOR_H
#define RECURVE_VOLUME_BLEND_INTERIOR_H

#include <recurve/core/types.h>
#include <recurve/volume/element_block.h>
#include <recurve/volume/internal/blend_elements.h>
#include <recurve/volume/node_state.h>

#include <algorithm>
#include <span>
#include <vector>

namespace recurve {

/// What `blend_interior()` did.
struct Blend_report
{
  Index touched_elements = 0;      ///< elements with a placed node off their corners
  Index blended_nodes = 0;         ///< nodes that were moved inside faces and cells
  double largest_displacement = 0; ///< of a blended node, in the unit of the points

  Blend_report& operator+=(const Blend_report& other)
  {
    touched_elements += other.touched_elements;
    blended_nodes += other.blended_nodes;
    largest_displacement = std::max(largest_displacement, other.largest_displacement);
    return *this;
  }
};

/// moves the nodes inside faces and cells after the nodes on displaced edges and faces, so that an element with a
/// curved edge or face stays a smooth image of its straight self and neighbours keep sharing their nodes.
///
/// On entry every node stands where its straight-sided element has it, except those in state `Node_state::placed`,
/// which already have their final position. Corners never move. The nodes inside an edge that are not placed stay.
/// A node inside a face follows the placed nodes on the edges of its face, a node inside a cell the displaced nodes on
/// its edges and faces, by transfinite interpolation in the reference element:
///   - quadrangle, hexahedron: Gordon & Hall. A displacement is reproduced if it is a sum of monomials that have a
///     coordinate of degree 0 or 1; so all polynomials of total degree <= 3 (quadrangle), <= 5 (hexahedron).
///   - triangle, tetrahedron: hierarchical extension. All polynomials of degree <= 2 (triangle), <= 3 (tetrahedron).
///   - prism: both; all polynomials of total degree <= 4.
///   - pyramid: Gordon & Hall in each section; all polynomials of degree <= 3, and the pyramid's space of degree 2.
/// "Reproduced": if the displacement on edges (of a cell: on edges and faces) is the trace of such a function that
/// vanishes at the corners, the nodes inside get its values, to round-off. Of the element's other functions the
/// result has the same trace and degree and differs by a bubble, which no trace determines.
///
/// A node moves only if a placed node moves it: all other nodes, and those whose displacement is within the rounding of
/// their element's corners, keep their bits. Each node gets one value, whatever the order of the elements, the number
/// of threads (oneTBB's) and the cell from which its face is seen. Faces in a plane parallel to the axes stay in it to
/// the bit.
///
/// \tparam PointRange   model of `Point_range` (random access, sized), writable; not copied.
/// \tparam StateRange   contiguous range of `Node_state`, one per node.
/// \tparam BlockRange   model of `Element_block_range`: cells, and triangles or quadrangles that are no cell's face;
///                      lines are ignored.
/// \param nodes   positions of all nodes.
/// \param states  on exit `Node_state::blended` for each node that was moved.
/// \param degree  degree p of all elements.
/// \throws Input_error if `degree` is outside [1, max_degree], sizes do not match, or an element names a node that does
///         not exist; nothing is changed then.
/// \par Complexity  one pass over the elements' nodes; beyond it, work and memory in proportion to the touched
/// elements. \par Source      Gordon & Hall 1973, Numer. Math. 21; Szabo & Babuska 1991, Finite Element Analysis.
template <Point_range PointRange, class StateRange, Element_block_range BlockRange>
Blend_report blend_interior(PointRange&& nodes, StateRange&& states, const BlockRange& blocks, int degree)
{
  std::vector<Element_block> views;
  views.reserve(std::size(blocks));
  for (const auto& block : blocks)
    views.push_back({block.type, std::span<const Index>(block.nodes)});
  internal::Interior_blend blend(nodes, std::span<Node_state>(states), views, degree);
  blend.find_touched_elements();
  blend.blend_faces();
  blend.blend_cells();
  return {blend.touched_elements(), blend.blended_nodes(), blend.largest_displacement()};
}

} // namespace recurve

#endif
