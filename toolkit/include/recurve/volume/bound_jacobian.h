#ifndef RECURVE_VOLUME_BOUND_JACOBIAN_H
#define RECURVE_VOLUME_BOUND_JACOBIAN_H

#include <recurve/core/exceptions.h>
#include <recurve/core/types.h>
#include <recurve/elements/element.h>
#include <recurve/volume/element_block.h>
#include <recurve/volume/internal/bound_elements.h>
#include <recurve/volume/jacobian_bounds.h>

#include <span>
#include <string>

namespace recurve {

/// bounds the Jacobian determinant of one cell and certifies whether it is positive in all of the closed cell.
///
/// det J is a polynomial (on a pyramid: its quotient by a square that the collapsed coordinates bring in). Its
/// Bernstein coefficients, computed as products of those of the derivatives, bound it; where they do not decide, the
/// cell is halved and halved again. Every rounding error is accounted for; what floating point cannot decide is
/// computed anew with integers, in which the given doubles are exact. So `valid` and `invalid` are theorems about the
/// polynomial map through the given nodes, and "undecided" is what stays open within the limits of `options`: det J
/// touches zero without crossing it, or nearly so. A node that is not finite makes the cell undecided and leaves the
/// bounds infinite.
///
/// \param type     tetrahedron, pyramid, prism or hexahedron.
/// \param nodes    canonical order. A cell that is known to be straight may be given by its corners, with degree 1.
/// \throws Input_error if `type` is no cell, `degree` is outside [1, max_degree], the number of nodes is not that of
/// the
///         type and degree, or an option is out of range.
/// \par Complexity  one evaluation of all coefficients, O(p^8) for a hexahedron, and O(p^4) for each part.
/// \par Source      Johnen, Remacle & Geuzaine 2013, J. Comput. Phys. 233; doc/certified_validity.md.
inline Jacobian_bounds bound_jacobian(Element_type type, int degree, std::span<const Point> nodes,
                                      const Jacobian_options& options = {})
{
  internal::check_element(type, degree);
  internal::check_options(options);
  if (nodes.size() != static_cast<std::size_t>(node_count(type, degree)))
    throw Input_error("bound_jacobian: " + std::to_string(nodes.size()) + " nodes, where a " +
                      std::string(element_name(type)) + " of degree " + std::to_string(degree) + " has " +
                      std::to_string(node_count(type, degree)));
  thread_local internal::Jacobian_bounder bounder(internal::narrow_kernel);
  const internal::Jacobian_table& table = internal::jacobian_table(type, degree);
  internal::set_nodes(bounder, table, nodes);
  Jacobian_bounds result;
  bounder.bound(table, options, {&result, 1});
  return result;
}

/// For `bound_jacobians()`: no cell is known to be straight.
struct None_straight
{
  bool operator()(Index, Index) const { return false; }
};

/// For `bound_jacobians()`: nobody asks for the bounds of single cells.
struct Ignore_bounds
{
  void operator()(Index, Index, const Jacobian_bounds&) const {}
};

/// certifies many cells in parallel (oneTBB's threads). The result does not depend on the number of threads, to the
/// bit, and each cell gets the bounds of `bound_jacobian()`.
///
/// \tparam PointRange   model of `Point_range`; not copied.
/// \tparam BlockRange   model of `Element_block_range`, cells only.
/// \tparam IsStraight  callable (Index block, Index element) -> bool: whether the cell is exactly the straight one of
/// its
///                      corners, so that the test of degree 1 on its corners suffices. Nothing checks that it is true;
///                      but a cell so flat that rounding of its other nodes may fold it is tested with all of them.
/// \tparam Visit        callable (Index block, Index element, const Jacobian_bounds&), for each cell once, in any order
///                      and from several threads at a time.
/// \param degree        degree p of all cells.
/// \throws Input_error as `bound_jacobian()`, or if the nodes of a block are no whole number of cells or a cell names a
///         node that does not exist; some cells may have been visited then.
/// \par Complexity      linear in the cells; no allocation per cell.
template <Point_range PointRange, Element_block_range BlockRange, class IsStraight = None_straight,
          class Visit = Ignore_bounds>
Jacobian_report bound_jacobians(const PointRange& nodes, const BlockRange& blocks, int degree,
                                const Jacobian_options& options = {}, const IsStraight& is_straight = {},
                                const Visit& visit = {})
{
  internal::check_options(options);
  for (const auto& block : blocks)
    internal::check_element(block.type, degree);
  using Bounder = internal::Block_bounder<PointRange, IsStraight, Visit>;
  typename Bounder::Bounders bounders(internal::wide_kernel());
  Jacobian_report report;
  Index number = 0;
  for (const auto& block : blocks)
  {
    const Element_block view{block.type, std::span<const Index>(block.nodes)};
    report += Bounder(nodes, view, number++, degree, options, is_straight, visit, bounders).report();
  }
  return report;
}

} // namespace recurve

#endif
