#ifndef RECURVE_ELEMENTS_BASIS_H
#define RECURVE_ELEMENTS_BASIS_H

#include <recurve/elements/element.h>

#include <Eigen/Core>

#include <array>
#include <span>

namespace recurve {

/// Coordinates in the reference element; see `Reference_element`.
using Reference_point = std::array<double, 3>;

/// evaluates all Lagrange functions of the canonical (equispaced) nodes at `xi`: values[m] is 1 at node m, 0 at the
/// others. On the pyramid they are the rational functions whose space is that of Bergot, Cohen & Duruflé 2010, J. Sci.
/// Comput. 42 (polynomials on each face; spanned by the Bernstein functions of Chan & Warburton 2015). Elsewhere:
/// complete (simplex), tensor-product (quadrangle, hexahedron) or mixed (prism) polynomials of degree `degree`. \pre
/// values.size() == node_count(type, degree)
void lagrange_basis(Element_type type, int degree, const Reference_point& xi, std::span<double> values);

/// evaluates their derivatives with respect to the reference coordinates. At the apex of a pyramid the limit along the
/// axis.
void lagrange_derivatives(Element_type type, int degree, const Reference_point& xi,
                          std::span<std::array<double, 3>> derivatives);

/// evaluates all Bernstein functions, numbered like the canonical nodes (function m has its control point at node m):
/// non-negative, of sum 1. On the pyramid, with a = x/(1-z), b = y/(1-z): B_ijk = C(p,k) z^k (1-z)^(p-k) B_i^{p-k}(a)
/// B_j^{p-k}(b) (Chan & Warburton 2015, SIAM J. Sci. Comput. 37).
void bernstein_basis(Element_type type, int degree, const Reference_point& xi, std::span<double> values);

/// matrix M with: Lagrange nodal values = M * Bernstein coefficients, that is M(m, n) = B_n(node m).
const Eigen::MatrixXd& bernstein_to_lagrange(Element_type type, int degree);

/// its inverse, computed in extended precision.
const Eigen::MatrixXd& lagrange_to_bernstein(Element_type type, int degree);

/// a pyramid as the hexahedron whose upper face has collapsed into the apex: matrix that takes the nodes of the pyramid
/// to those of the hexahedron, both in canonical order. The map (a, b, c) -> (a (1-c), b (1-c), c) makes every pyramid
/// function a polynomial of degree <= p in each of a, b, c, so that both elements are the same curved cell.
const Eigen::MatrixXd& pyramid_to_hexahedron(int degree);

} // namespace recurve

#endif
