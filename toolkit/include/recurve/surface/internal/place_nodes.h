#ifndef RECURVE_SURFACE_INTERNAL_PLACE_NODES_H
#define RECURVE_SURFACE_INTERNAL_PLACE_NODES_H

#include <recurve/elements/blend_weights.h>
#include <recurve/features/feature_curves.h>
#include <recurve/surface/internal/face_normal.h>
#include <recurve/surface/internal/straight_nodes.h>
#include <recurve/surface/internal/vector_3.h>
#include <recurve/surface/local_fit.h>

#include <CGAL/boost/graph/iterator.h>
#include <CGAL/boost/graph/properties.h>
#include <boost/graph/graph_traits.hpp>

#include <algorithm>
#include <array>
#include <span>
#include <vector>

namespace recurve::internal::surface {

/// A displacement below this part of the length of the edge is the round-off of the fit, not a shape.
inline constexpr double least_relative_displacement = 1e-13;

/// `displacement`, or nothing where it is below round-off. \param length  of the edge. \param magnitude  largest
/// coordinate nearby: points are not known better than to their last digits.
inline Point clear_round_off(const Point& displacement, double edge_length, double magnitude)
{
  const double bound = std::max(least_relative_displacement * edge_length, coordinate_resolution * magnitude);
  return length(displacement) > bound ? displacement : Point{0, 0, 0};
}

inline bool is_zero(const Point& displacement)
{
  return displacement == Point{0, 0, 0};
}

/// The splines of the feature curves of two or more edges. Points are taken relative to the first one of their curve,
/// so that the place of the mesh costs no digits.
template <class Graph>
class Curve_places
{
  using Traits = boost::graph_traits<Graph>;
  using halfedge_descriptor = typename Traits::halfedge_descriptor;
  using edge_descriptor = typename Traits::edge_descriptor;
  using Place_numbers = typename boost::property_map<Graph, CGAL::dynamic_edge_property_t<Index>>::const_type;

public:
  template <class VertexPointMap>
  Curve_places(const Graph& g, const std::vector<Feature_curve<Graph>>& curves, VertexPointMap vertex_points,
               const Curve_fit_options& options)
    : numbers_(get(CGAL::dynamic_edge_property_t<Index>(), g))
  {
    for (const edge_descriptor e : edges(g))
      put(numbers_, e, no_index);
    for (const Feature_curve<Graph>& curve : curves)
      if (curve.halfedges.size() >= 2)
        add(g, curve, vertex_points, options);
  }

  bool is_on_curve(edge_descriptor e) const { return get(numbers_, e) != no_index; }

  /// number of edges on splines.
  Index size() const { return static_cast<Index>(places_.size()); }

  /// from the straight edge `e` to the spline, at k/p of the way along its half-edge `h`.
  Point displacement(edge_descriptor e, halfedge_descriptor h, int k, int degree) const
  {
    const Place& place = places_[get(numbers_, e)];
    const bool is_along = place.halfedge == h;
    const Point on_curve =
      splines_[place.curve](place.segment, static_cast<double>(is_along ? k : degree - k) / degree);
    return subtract(on_curve, is_along ? straight_edge_node(place.start, place.end, k, degree)
                                       : straight_edge_node(place.end, place.start, k, degree));
  }

private:
  struct Place
  {
    Index curve = no_index;
    Index segment = no_index;
    halfedge_descriptor halfedge; ///< in the direction of the curve
    Point start = {};             ///< relative to the curve's first point
    Point end = {};
  };

  template <class VertexPointMap>
  void add(const Graph& g, const Feature_curve<Graph>& curve, VertexPointMap vertex_points,
           const Curve_fit_options& options)
  {
    std::vector<Point> points;
    for (const halfedge_descriptor h : curve.halfedges)
      points.push_back(point_of(get(vertex_points, source(h, g))));
    if (!curve.is_closed)
      points.push_back(point_of(get(vertex_points, target(curve.halfedges.back(), g))));
    const Point first = points.front();
    for (Point& x : points)
      x = subtract(x, first);
    for (std::size_t i = 0; i < curve.halfedges.size(); ++i)
    {
      const halfedge_descriptor h = curve.halfedges[i];
      put(numbers_, edge(h, g), size());
      places_.push_back(
        {static_cast<Index>(splines_.size()), static_cast<Index>(i), h, points[i], points[(i + 1) % points.size()]});
    }
    splines_.emplace_back(points, curve.is_closed, options);
  }

  Place_numbers numbers_;
  std::vector<Place> places_;
  std::vector<Curve_spline> splines_;
};

/// The displacements of all p + 1 nodes (zero at the ends) of each edge of a face, from its corner to the next corner.
using Edge_displacements = std::array<std::array<Point, max_element_degree + 1>, 4>;

inline const Blend_weights& blend_weights_of_face(int corner_count, int degree)
{
  using Table = std::array<std::array<Blend_weights, max_element_degree + 1>, 2>;
  static const Table table = [] {
    Table all;
    for (std::size_t p = 1; p <= max_element_degree; ++p)
    {
      all[0][p] = Blend_weights(Element_type::triangle, static_cast<int>(p));
      all[1][p] = Blend_weights(Element_type::quadrangle, static_cast<int>(p));
    }
    return all;
  }();
  return table[corner_count - 3][degree];
}

/// the blend of the displacements of a face's edges at its inner node `number`. It maps polynomials to polynomials of
/// the same degree, so that nodes along a curve, which are spaced by arc length, cost the face no order.
inline Point blend_in_face(const Edge_displacements& edges, int corner_count, int number, int degree)
{
  Point sum = {0, 0, 0};
  for (const Weight_rows::Entry& entry : blend_weights_of_face(corner_count, degree).blend().row(number))
  {
    const int on_edge = entry.column - corner_count; // canonical order: corners, then edge after edge
    sum = add(sum, scaled(entry.weight, edges[on_edge / (degree - 1)][on_edge % (degree - 1) + 1]));
  }
  return sum;
}

/// Where the nodes of a surface go. Functions are safe to be called by several threads.
template <class Graph, class FaceFitMap, class VertexPointMap>
class Node_placer
{
  using Traits = boost::graph_traits<Graph>;
  using halfedge_descriptor = typename Traits::halfedge_descriptor;
  using edge_descriptor = typename Traits::edge_descriptor;
  using face_descriptor = typename Traits::face_descriptor;

public:
  Node_placer(const Graph& g, FaceFitMap fits, VertexPointMap vertex_points, const Curve_places<Graph>& curves,
              int degree)
    : g_(&g), fits_(fits), vertex_points_(vertex_points), curves_(&curves), degree_(degree)
  {}

  /// A node of an edge or face: where it is in the straight-sided mesh and how far it goes.
  struct Placed_node
  {
    Point straight = {};
    Point displacement = {};
  };

  /// \param nodes  p - 1 nodes, from source(h, g) on. \return the length of the edge.
  double place_edge(halfedge_descriptor h, std::span<Placed_node> nodes) const
  {
    const edge_descriptor e = edge(h, *g_);
    const Point a = point_of(get(vertex_points_, source(h, *g_)));
    const Point b = point_of(get(vertex_points_, target(h, *g_)));
    const double edge_length = length(subtract(b, a));
    const double magnitude = std::max(largest_coordinate(a), largest_coordinate(b));
    for (int k = 1; k < degree_; ++k)
      nodes[k - 1].straight = straight_edge_node(a, b, k, degree_);
    if (curves_->is_on_curve(e))
      for (int k = 1; k < degree_; ++k)
        nodes[k - 1].displacement = curves_->displacement(e, h, k, degree_);
    else
      lift_edge_nodes(h, nodes);
    for (int k = 1; k < degree_; ++k)
      nodes[k - 1].displacement = clear_round_off(nodes[k - 1].displacement, edge_length, magnitude);
    return edge_length;
  }

  /// \param nodes  filled with the nodes inside the face, in canonical order. \return the length of the longest edge.
  double place_face(face_descriptor f, std::vector<Placed_node>& nodes) const
  {
    std::array<Point, 4> corners = {};
    const int corner_count = gather_corners(*g_, f, vertex_points_, corners);
    double longest = 0, magnitude = 0;
    for (int i = 0; i < corner_count; ++i)
    {
      longest = std::max(longest, length(subtract(corners[(i + 1) % corner_count], corners[i])));
      magnitude = std::max(magnitude, largest_coordinate(corners[i]));
    }
    const typename boost::property_traits<FaceFitMap>::value_type& fit = get(fits_, f);
    Edge_displacements edges;
    const bool is_blended = gather_edges(f, is_flat(fit), edges);
    nodes.clear();
    for (const Lattice_node lattice : interior_lattice(corner_count, degree_))
    {
      Placed_node node;
      node.straight = straight_face_node(corners, corner_count, lattice, degree_);
      Point way = {0, 0, 0};
      if (is_blended)
        way = blend_in_face(edges, corner_count, static_cast<int>(nodes.size()), degree_);
      way = add(way, lift(fit, add(node.straight, way), corner_count, lattice));
      node.displacement = clear_round_off(way, longest, magnitude);
      nodes.push_back(node);
    }
    return longest;
  }

private:
  /// whether the fits are those of vertices, blended over edges and faces.
  static constexpr bool is_blended_fit = requires(FaceFitMap fits, halfedge_descriptor h) { fits.edge_fit(h); };

  /// displaces the nodes inside the edge of `h` by the mean of the fits on its two sides.
  void lift_edge_nodes(halfedge_descriptor h, std::span<Placed_node> nodes) const
  {
    const face_descriptor left = face(h, *g_);
    const face_descriptor right = face(opposite(h, *g_), *g_);
    const face_descriptor none = Traits::null_face();
    const auto lift_by_both = [&](const auto& left_displacement, const auto& right_displacement) {
      for (int k = 1; k < degree_; ++k)
      {
        const Point& x = nodes[k - 1].straight;
        nodes[k - 1].displacement = left == none ? right_displacement(x, k)
                                    : right == none
                                      ? left_displacement(x, k)
                                      : scaled(0.5, add(left_displacement(x, k), right_displacement(x, k)));
      }
    };
    if constexpr (is_blended_fit)
    {
      using Fit = typename boost::property_traits<FaceFitMap>::value_type;
      const Fit left_fit = left == none ? Fit() : fits_.edge_fit(h);
      const Fit right_fit = right == none ? Fit() : fits_.edge_fit(opposite(h, *g_));
      const auto displacement = [this](const Fit& fit, const Point& x, int k) {
        const double t = static_cast<double>(k) / degree_;
        const std::array<double, 2> weights = {1 - t, t};
        return fit.displacement(x, weights);
      };
      lift_by_both([&](const Point& x, int k) { return displacement(left_fit, x, k); },
                   [&](const Point& x, int k) { return displacement(right_fit, x, degree_ - k); });
    }
    else
      lift_by_both([&](const Point& x, int) { return get(fits_, left).displacement(x); },
                   [&](const Point& x, int) { return get(fits_, right).displacement(x); });
  }

  /// from `x`, which started at `lattice` inside a face, to the surface of the fit.
  template <class Fit>
  Point lift(const Fit& fit, const Point& x, [[maybe_unused]] int corner_count,
             [[maybe_unused]] const Lattice_node& lattice) const
  {
    if constexpr (is_blended_fit)
    {
      const double s = static_cast<double>(lattice.i) / degree_;
      const double t = static_cast<double>(lattice.j) / degree_;
      if (corner_count == 3)
        return fit.displacement(x, std::array<double, 3>{1 - s - t, s, t});
      return fit.displacement(x, std::array<double, 4>{(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t});
    }
    else
      return fit.displacement(x);
  }

  /// whether a blend of vertex fits is flat; edges of the face may bend all the same.
  template <class Fit>
  static bool is_flat([[maybe_unused]] const Fit& fit)
  {
    if constexpr (is_blended_fit)
      return fit.is_flat();
    else
      return false;
  }

  /// gathers the displacements of the edges of `f` if one of them moves along a spline, or `takes_all`.
  /// \return whether one such edge moves.
  bool gather_edges(face_descriptor f, bool takes_all, Edge_displacements& edges) const
  {
    const auto around = CGAL::halfedges_around_face(halfedge(f, *g_), *g_);
    const auto is_taken = [&](halfedge_descriptor h) { return takes_all || curves_->is_on_curve(edge(h, *g_)); };
    if (std::none_of(around.begin(), around.end(), is_taken))
      return false;
    bool is_moved = false;
    int side = 0;
    for (const halfedge_descriptor h : around)
    {
      std::array<Placed_node, max_element_degree> nodes;
      place_edge(h, nodes);
      edges[side][0] = edges[side][degree_] = {0, 0, 0};
      for (int k = 1; k < degree_; ++k)
      {
        edges[side][k] = nodes[k - 1].displacement;
        is_moved = is_moved || (is_taken(h) && !is_zero(edges[side][k]));
      }
      ++side;
    }
    return is_moved;
  }

  const Graph* g_;
  FaceFitMap fits_;
  VertexPointMap vertex_points_;
  const Curve_places<Graph>* curves_;
  int degree_;
};

} // namespace recurve::internal::surface

#endif
