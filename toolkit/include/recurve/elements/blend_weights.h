#ifndef RECURVE_ELEMENTS_BLEND_WEIGHTS_H
#define RECURVE_ELEMENTS_BLEND_WEIGHTS_H

#include <recurve/elements/element.h>
#include <recurve/elements/node_layout.h>

#include <Eigen/Core>
#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

namespace recurve {

/// A matrix that says how each of a few nodes follows from others: row r holds its non-zero entries.
struct Weight_rows
{
  struct Entry
  {
    int column;
    double weight;
  };

  std::vector<int> first = {0};
  std::vector<Entry> entries;

  int size() const { return static_cast<int>(first.size()) - 1; }

  std::span<const Entry> row(int r) const
  {
    return std::span(entries).subspan(static_cast<std::size_t>(first[r]),
                                      static_cast<std::size_t>(first[r + 1] - first[r]));
  }

  void add(int column, double weight) { entries.push_back({column, weight}); }
  void end_row() { first.push_back(static_cast<int>(entries.size())); }
};

/// computes the two matrices that blending an element of one type and degree needs.
///
/// The displacement inside the element is a sum of one term per edge and one per face. With la and lb the linear
/// functions that are 1 at one end of an edge and 0 at the other, the displacement along the edge (zero at both ends)
/// is la lb f(lb - la) with a polynomial f of degree p - 2, and its term inside the element is w la lb f(lb - la),
/// where w fades from 1 on the edge to 0 on all faces that do not contain it. What a face has beyond the terms of its
/// edges is continued in the same way: w la lb lc g(la, lb, lc) from a triangle and w u(1-u) v(1-v) g(u, v) from a
/// quadrangle. On a quadrangle and a hexahedron that is Gordon & Hall's transfinite interpolation; on simplices it is
/// the hierarchical extension of Szabo & Babuska, which maps polynomials to polynomials of the same degree; on a prism
/// it is both, and on a pyramid Gordon & Hall's in each section parallel to the base.
class Blend_weights
{
public:
  Blend_weights() = default;
  Blend_weights(Element_type type, int degree);

  /// per node: its straight position is that of corner 0 plus the sum of weight * (corner - corner 0).
  const Weight_rows& straight() const { return straight_; }

  /// per interior node: weights of the displacements of the nodes on edges and faces.
  const Weight_rows& blend() const { return blend_; }

private:
  // Extended precision, so that the weights are exact to a double's last bits and zeros can be told from rounding.
  using Real = long double;
  using Row = Eigen::Matrix<Real, 1, Eigen::Dynamic>;
  using Matrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
  using Reference = std::array<Real, 3>;

  /// The functions of an edge, at one point of the element.
  struct Edge_view
  {
    Real la, lb, w;
  };

  /// Those of a triangular face.
  struct Triangle_view
  {
    std::array<Real, 3> l;
    Real w;
  };

  /// Those of a quadrangular face: `g` is w u(1-u) v(1-v), `shrink` the size of the section of a pyramid.
  struct Quadrangle_view
  {
    Real u, v, g, shrink;
  };

  static Real side(int corner_coordinate, Real x) { return corner_coordinate ? x : 1 - x; }
  static std::array<Real, 4> barycentric(const Reference& x) { return {1 - x[0] - x[1] - x[2], x[0], x[1], x[2]}; }

  /// position inside the section of a pyramid, in [0, 1]^2. \pre x is not the apex.
  static Reference collapsed(const Reference& x) { return {x[0] / (1 - x[2]), x[1] / (1 - x[2]), x[2]}; }

  Reference reference_point(int node) const;
  Real corner_function(int corner, const Reference& x) const;
  Edge_view edge_view(int edge, const Reference& x) const;
  Edge_view pyramid_edge_view(int a, int b, const Reference& x) const;
  Triangle_view triangle_view(int face, const Reference& x) const;
  Quadrangle_view quadrangle_view(int face, const Reference& x) const;

  Row edge_row(const Edge_view& view) const;
  Row triangle_row(const Triangle_view& view) const;
  Row quadrangle_row(const Quadrangle_view& view) const;
  Row edge_part(const Reference& x) const;
  Row face_row(int face, const Reference& x) const;

  void prepare_fits();
  void fill_straight();
  void fill_blend();

  const Reference_element* element_ = nullptr;
  int degree_ = 1;
  Matrix edge_fit_, triangle_fit_, quadrangle_fit_; ///< from nodal values to coefficients of f and g
  Weight_rows straight_, blend_;
};

inline Blend_weights::Blend_weights(Element_type type, int degree) : element_(&reference_element(type)), degree_(degree)
{
  fill_straight();
  if (interior_node_count(type, degree) > 0 && element_->dimension > 1)
  {
    prepare_fits();
    fill_blend();
  }
}

inline Blend_weights::Reference Blend_weights::reference_point(int node) const
{
  const Lattice_point l = canonical_nodes(element_->type, degree_)[static_cast<std::size_t>(node)];
  return {static_cast<Real>(l[0]) / degree_, static_cast<Real>(l[1]) / degree_, static_cast<Real>(l[2]) / degree_};
}

/// the function of degree 1 that is 1 at `corner` and 0 at the others.
inline Blend_weights::Real Blend_weights::corner_function(int corner, const Reference& x) const
{
  const std::array<int, 3>& c = element_->corners[static_cast<std::size_t>(corner)];
  switch (element_->type)
  {
  case Element_type::triangle:
  case Element_type::tetrahedron: return barycentric(x)[static_cast<std::size_t>(corner)];
  case Element_type::prism:
    return barycentric({x[0], x[1], 0})[static_cast<std::size_t>(corner % 3)] * side(c[2], x[2]);
  case Element_type::pyramid:
  {
    if (corner == 4 || x[2] == 1)
      return corner == 4 ? x[2] : 0;
    const Reference s = collapsed(x);
    return side(c[0], s[0]) * side(c[1], s[1]) * (1 - x[2]);
  }
  default:
  {
    Real value = 1;
    for (int d = 0; d < element_->dimension; ++d)
      value *= side(c[static_cast<std::size_t>(d)], x[static_cast<std::size_t>(d)]);
    return value;
  }
  }
}

inline Blend_weights::Edge_view Blend_weights::pyramid_edge_view(int a, int b, const Reference& x) const
{
  const auto& ca = element_->corners[static_cast<std::size_t>(a)];
  const auto& cb = element_->corners[static_cast<std::size_t>(b)];
  const Reference s = collapsed(x);
  if (a == 4 || b == 4)
  {
    const auto& base = a == 4 ? cb : ca;
    return {side(ca[2], x[2]), side(cb[2], x[2]), side(base[0], s[0]) * side(base[1], s[1])};
  }
  const std::size_t along = ca[0] != cb[0] ? 0 : 1;
  return {side(ca[along], s[along]) * (1 - x[2]), side(cb[along], s[along]) * (1 - x[2]),
          side(ca[1 - along], s[1 - along])};
}

inline Blend_weights::Edge_view Blend_weights::edge_view(int edge, const Reference& x) const
{
  const auto [a, b] = element_->edges[static_cast<std::size_t>(edge)];
  const auto& ca = element_->corners[static_cast<std::size_t>(a)];
  const auto& cb = element_->corners[static_cast<std::size_t>(b)];
  switch (element_->type)
  {
  case Element_type::triangle:
  case Element_type::tetrahedron: return {corner_function(a, x), corner_function(b, x), 1};
  case Element_type::pyramid: return pyramid_edge_view(a, b, x);
  case Element_type::prism:
  {
    const auto l = barycentric({x[0], x[1], 0});
    if (ca[2] != cb[2])
      return {side(ca[2], x[2]), side(cb[2], x[2]), l[static_cast<std::size_t>(a % 3)]};
    return {l[static_cast<std::size_t>(a % 3)], l[static_cast<std::size_t>(b % 3)], side(ca[2], x[2])};
  }
  default:
  {
    Edge_view view = {1, 1, 1};
    for (std::size_t d = 0; d < static_cast<std::size_t>(element_->dimension); ++d)
      if (ca[d] != cb[d])
      {
        view.la = side(ca[d], x[d]);
        view.lb = side(cb[d], x[d]);
      }
      else
        view.w *= side(ca[d], x[d]);
    return view;
  }
  }
}

inline Blend_weights::Triangle_view Blend_weights::triangle_view(int face, const Reference& x) const
{
  const Reference_face& f = element_->faces[static_cast<std::size_t>(face)];
  Triangle_view view = {{}, 1};
  const auto corner = [&](std::size_t m) { return static_cast<std::size_t>(f.corners[m]); };
  if (element_->type == Element_type::tetrahedron)
    for (std::size_t m = 0; m < 3; ++m)
      view.l[m] = barycentric(x)[corner(m)];
  else if (element_->type == Element_type::prism)
  {
    for (std::size_t m = 0; m < 3; ++m)
      view.l[m] = barycentric({x[0], x[1], 0})[corner(m) % 3];
    view.w = side(element_->corners[corner(0)][2], x[2]);
  }
  else
  {
    // Of a pyramid: its base edge runs along one coordinate of the section, and the face fades along the other.
    const std::size_t apex = corner(0) == 4 ? 0 : corner(1) == 4 ? 1 : 2;
    const auto& ca = element_->corners[corner((apex + 1) % 3)];
    const auto& cb = element_->corners[corner((apex + 2) % 3)];
    const std::size_t along = ca[0] != cb[0] ? 0 : 1;
    const Reference s = collapsed(x);
    view.l[apex] = x[2];
    view.l[(apex + 1) % 3] = side(ca[along], s[along]) * (1 - x[2]);
    view.l[(apex + 2) % 3] = side(cb[along], s[along]) * (1 - x[2]);
    view.w = side(ca[1 - along], s[1 - along]);
  }
  return view;
}

inline Blend_weights::Quadrangle_view Blend_weights::quadrangle_view(int face, const Reference& x) const
{
  const Reference_face& f = element_->faces[static_cast<std::size_t>(face)];
  const auto& c0 = element_->corners[static_cast<std::size_t>(f.corners[0])];
  const auto& c1 = element_->corners[static_cast<std::size_t>(f.corners[1])];
  const auto& c3 = element_->corners[static_cast<std::size_t>(f.corners[3])];

  // the pair of functions along one side of the face, and what is left of their sum inside the cell
  const auto along = [&](int a, int b) -> std::pair<Real, Real> {
    const auto& ca = element_->corners[static_cast<std::size_t>(a)];
    const auto& cb = element_->corners[static_cast<std::size_t>(b)];
    if (element_->type == Element_type::prism && ca[2] == cb[2])
    {
      const auto l = barycentric({x[0], x[1], 0});
      return {l[static_cast<std::size_t>(a % 3)], l[static_cast<std::size_t>(b % 3)]};
    }
    const Reference s = element_->type == Element_type::pyramid ? collapsed(x) : x;
    const std::size_t d = ca[0] != cb[0] ? 0 : ca[1] != cb[1] ? 1 : 2;
    return {side(ca[d], s[d]), side(cb[d], s[d])};
  };
  const auto [ua, ub] = along(f.corners[0], f.corners[1]);
  const auto [va, vb] = along(f.corners[0], f.corners[3]);
  Quadrangle_view view = {(1 + ub - ua) / 2, (1 + vb - va) / 2, ua * ub * va * vb, 1};
  if (element_->type == Element_type::pyramid)
  {
    view.shrink = 1 - x[2];
    view.g *= view.shrink * view.shrink;
  }
  else if (element_->type == Element_type::hexahedron)
    for (std::size_t d = 0; d < 3; ++d)
      if (c0[d] == c1[d] && c0[d] == c3[d])
        view.g *= side(c0[d], x[d]);
  return view;
}

/// prepares the inverses of the small Vandermonde matrices, in powers centred on the middle of the edge or face.
inline void Blend_weights::prepare_fits()
{
  const int p = degree_, n = p - 1;
  edge_fit_.resize(n, n);
  for (int k = 1; k < p; ++k)
  {
    const Real t = static_cast<Real>(k) / p;
    for (int m = 0; m < n; ++m)
      edge_fit_(k - 1, m) = t * (1 - t) * std::pow(2 * t - 1, static_cast<Real>(m));
  }
  quadrangle_fit_.resize(n * n, n * n);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i)
      for (int b = 0; b < n; ++b)
        for (int a = 0; a < n; ++a)
          quadrangle_fit_(j * n + i, b * n + a) = edge_fit_(i, a) * edge_fit_(j, b);
  const int triangle_nodes = interior_node_count(Element_type::triangle, p);
  triangle_fit_.resize(triangle_nodes, triangle_nodes);
  for (int j = 1, row = 0; j < p; ++j)
    for (int i = 1; i + j < p; ++i, ++row)
    {
      const Real lb = static_cast<Real>(i) / p, lc = static_cast<Real>(j) / p;
      for (int b = 0, column = 0; b <= p - 3; ++b)
        for (int a = 0; a + b <= p - 3; ++a, ++column)
          triangle_fit_(row, column) = (1 - lb - lc) * lb * lc * std::pow(3 * lb - 1, static_cast<Real>(a)) *
                                       std::pow(3 * lc - 1, static_cast<Real>(b));
    }
  edge_fit_ = edge_fit_.fullPivLu().inverse().eval();
  quadrangle_fit_ = quadrangle_fit_.fullPivLu().inverse().eval();
  if (triangle_nodes > 0)
    triangle_fit_ = triangle_fit_.fullPivLu().inverse().eval();
}

/// weights of the nodes inside an edge, in its order, at the point of `view`.
inline Blend_weights::Row Blend_weights::edge_row(const Edge_view& view) const
{
  Row powers(degree_ - 1);
  for (int m = 0; m < degree_ - 1; ++m)
    powers[m] = view.w * view.la * view.lb * std::pow(view.lb - view.la, static_cast<Real>(m));
  return powers * edge_fit_;
}

inline Blend_weights::Row Blend_weights::triangle_row(const Triangle_view& view) const
{
  // A point off the face belongs to the point of the face that shares its excess equally among the three.
  const auto& l = view.l;
  const Real excess = (1 - l[0] - l[1] - l[2]) / 3;
  const Real b = 3 * (l[1] + excess) - 1, c = 3 * (l[2] + excess) - 1;
  Row powers(triangle_fit_.rows());
  for (int j = 0, m = 0; j <= degree_ - 3; ++j)
    for (int i = 0; i + j <= degree_ - 3; ++i, ++m)
      powers[m] = view.w * l[0] * l[1] * l[2] * std::pow(b, static_cast<Real>(i)) * std::pow(c, static_cast<Real>(j));
  return powers * triangle_fit_;
}

inline Blend_weights::Row Blend_weights::quadrangle_row(const Quadrangle_view& view) const
{
  const int n = degree_ - 1;
  Row powers(n * n);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i)
      powers[j * n + i] = view.g * std::pow(2 * view.u - 1, static_cast<Real>(i)) *
                          std::pow(2 * view.v - 1, static_cast<Real>(j)) *
                          std::pow(view.shrink, static_cast<Real>(std::max(i, j)));
  return powers * quadrangle_fit_;
}

/// weights of all nodes of the element for the sum of the terms of its edges.
inline Blend_weights::Row Blend_weights::edge_part(const Reference& x) const
{
  Row row = Row::Zero(node_count(element_->type, degree_));
  for (int e = 0; e < element_->edge_count; ++e)
    row.segment(first_edge_node(element_->type, degree_, e), degree_ - 1) += edge_row(edge_view(e, x));
  return row;
}

inline Blend_weights::Row Blend_weights::face_row(int face, const Reference& x) const
{
  return element_->faces[static_cast<std::size_t>(face)].type == Element_type::triangle
           ? triangle_row(triangle_view(face, x))
           : quadrangle_row(quadrangle_view(face, x));
}

inline void Blend_weights::fill_straight()
{
  for (int m = 0; m < node_count(element_->type, degree_); ++m)
  {
    const Reference x = reference_point(m);
    for (int c = 1; c < element_->corner_count; ++c)
      if (const Real weight = corner_function(c, x); weight != 0)
        straight_.add(c, static_cast<double>(weight));
    straight_.end_row();
  }
}

inline void Blend_weights::fill_blend()
{
  // Weights are of order 1; what is smaller than this is a zero blurred by rounding in extended precision.
  constexpr Real blurred_zero = 1e-15L;

  const Element_type type = element_->type;
  std::vector<std::vector<Row>> edge_part_of_face_nodes(static_cast<std::size_t>(element_->face_count));
  for (int f = 0; f < element_->face_count; ++f)
    for (int m = 0; m < interior_node_count(element_->faces[static_cast<std::size_t>(f)].type, degree_); ++m)
      edge_part_of_face_nodes[static_cast<std::size_t>(f)].push_back(
        edge_part(reference_point(first_face_node(type, degree_, f) + m)));

  const int first = first_interior_node(type, degree_);
  for (int node = first; node < node_count(type, degree_); ++node)
  {
    const Reference x = reference_point(node);
    Row row = edge_part(x);
    for (int f = 0; f < element_->face_count; ++f)
    {
      const auto& edge_parts = edge_part_of_face_nodes[static_cast<std::size_t>(f)];
      if (edge_parts.empty())
        continue;
      const Row beyond_edges = face_row(f, x);
      for (Eigen::Index m = 0; m < beyond_edges.size(); ++m)
      {
        row[first_face_node(type, degree_, f) + m] += beyond_edges[m];
        row -= beyond_edges[m] * edge_parts[static_cast<std::size_t>(m)];
      }
    }
    for (int column = 0; column < first; ++column)
      if (std::abs(row[column]) > blurred_zero)
        blend_.add(column, static_cast<double>(row[column]));
    blend_.end_row();
  }
}

} // namespace recurve

#endif
