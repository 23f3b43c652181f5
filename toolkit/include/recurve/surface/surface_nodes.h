#ifndef RECURVE_SURFACE_SURFACE_NODES_H
#define RECURVE_SURFACE_SURFACE_NODES_H

#include <recurve/core/exceptions.h>
#include <recurve/core/types.h>
#include <recurve/surface/internal/straight_nodes.h>

#include <CGAL/boost/graph/iterator.h>
#include <CGAL/boost/graph/properties.h>
#include <boost/graph/graph_traits.hpp>
#include <boost/property_map/property_map.hpp>

#include <span>
#include <string>
#include <vector>

namespace recurve {

/// Name of a node inside an edge.
template <class Graph>
struct Edge_node
{
  typename boost::graph_traits<Graph>::halfedge_descriptor halfedge; ///< the edge, seen from source(halfedge)
  int k = 0;                                                         ///< 1 <= k <= p - 1: at k/p of the way to target
};

/// Name of a node inside a face.
template <class Graph>
struct Face_node
{
  typename boost::graph_traits<Graph>::face_descriptor face;
  int m = 0; ///< counted from 0 over the interior nodes only, in the canonical order (elements/node_layout.h) of the
             ///< triangle or quadrangle whose corner 0 is source(halfedge(face, g)) and which turns like the face
};

/// Nodes of degree p on the edges and in the faces of a graph, in flat arrays; at first where the straight-sided faces
/// have them. The corners are the points of the graph.
///
/// \tparam Graph    model of `FaceListGraph`; triangles and quads. The graph must outlive this object and keep its
///                  vertices, edges and faces.
/// \tparam Point3  CGAL point, made from three doubles.
template <class Graph, class Point3 = typename boost::property_traits<
                         typename boost::property_map<Graph, CGAL::vertex_point_t>::const_type>::value_type>
class Surface_nodes
{
  using Traits = boost::graph_traits<Graph>;
  using Halfedge_numbers = typename boost::property_map<Graph, CGAL::dynamic_halfedge_property_t<Index>>::const_type;
  using Face_numbers = typename boost::property_map<Graph, CGAL::dynamic_face_property_t<Index>>::const_type;

public:
  using halfedge_descriptor = typename Traits::halfedge_descriptor;
  using edge_descriptor = typename Traits::edge_descriptor;
  using face_descriptor = typename Traits::face_descriptor;

  /// Writable map to the nodes inside edges, for `curve_surface()`.
  struct Edge_map
  {
    using key_type = Edge_node<Graph>;
    using value_type = Point3;
    using reference = void;
    using category = boost::writable_property_map_tag;

    Surface_nodes* nodes = nullptr;

    friend void put(const Edge_map& map, const key_type& key, const Point3& point)
    {
      map.nodes->set_edge_node(key.halfedge, key.k, point);
    }
  };

  /// Writable map to the nodes inside faces, for `curve_surface()`.
  struct Face_map
  {
    using key_type = Face_node<Graph>;
    using value_type = Point3;
    using reference = void;
    using category = boost::writable_property_map_tag;

    Surface_nodes* nodes = nullptr;

    friend void put(const Face_map& map, const key_type& key, const Point3& point)
    {
      map.nodes->set_face_node(key.face, key.m, point);
    }
  };

  /// fills all nodes with their straight-sided positions.
  /// \throws Input_error if `degree` is outside [1, 6] or a face is neither triangle nor quad.
  template <class VertexPointMap>
  Surface_nodes(const Graph& g, int degree, VertexPointMap vertex_points);

  Surface_nodes(const Graph& g, int degree) : Surface_nodes(g, degree, get(CGAL::vertex_point, g)) {}

  int degree() const { return degree_; }

  Edge_map edge_map() { return {this}; }
  Face_map face_map() { return {this}; }

  /// node k of the edge seen from source(`halfedge`), 1 <= k <= p - 1; both halfedges of an edge name the same nodes.
  const Point3& edge_node(halfedge_descriptor halfedge, int k) const
  {
    return edge_points_[edge_position(halfedge, k)];
  }

  /// number of nodes inside `face`.
  int face_node_count(face_descriptor face) const
  {
    const Index f = get(face_numbers_, face);
    return static_cast<int>(face_first_[f + 1] - face_first_[f]);
  }

  /// node m inside `face`, numbered as in `Face_node`.
  const Point3& face_node(face_descriptor face, int m) const { return face_points_[face_position(face, m)]; }

  void set_edge_node(halfedge_descriptor halfedge, int k, const Point3& point)
  {
    edge_points_[edge_position(halfedge, k)] = point;
  }

  void set_face_node(face_descriptor face, int m, const Point3& point) { face_points_[face_position(face, m)] = point; }

  /// all nodes inside edges: p - 1 per edge, in the order of `edges(g)`, each from source(halfedge(edge, g)).
  std::span<const Point3> edge_nodes() const { return edge_points_; }

  /// all nodes inside faces, in the order of `faces(g)`.
  std::span<const Point3> face_nodes() const { return face_points_; }

private:
  // Half-edges are numbered 2 e and 2 e + 1. Asking whether h == halfedge(edge(h, g), g) would not do: an edge of CGAL
  // may remember which of its half-edges it was made from.
  Index edge_position(halfedge_descriptor h, int k) const
  {
    const Index number = get(halfedge_numbers_, h);
    return number / 2 * (degree_ - 1) + (number % 2 == 0 ? k : degree_ - k) - 1;
  }

  Index face_position(face_descriptor f, int m) const { return face_first_[get(face_numbers_, f)] + m; }

  const Graph* graph_;
  int degree_;
  Halfedge_numbers halfedge_numbers_;
  Face_numbers face_numbers_;
  std::vector<Index> face_first_;
  std::vector<Point3> edge_points_;
  std::vector<Point3> face_points_;
};

template <class Graph, class Point3>
template <class VertexPointMap>
Surface_nodes<Graph, Point3>::Surface_nodes(const Graph& g, int degree, VertexPointMap vertex_points)
  : graph_(&g), degree_(degree), halfedge_numbers_(get(CGAL::dynamic_halfedge_property_t<Index>(), g)),
    face_numbers_(get(CGAL::dynamic_face_property_t<Index>(), g))
{
  internal::surface::check_element_degree(degree);
  const auto push = [](std::vector<Point3>& points, const Point& x) { points.emplace_back(x[0], x[1], x[2]); };
  Index number = 0;
  for (const edge_descriptor e : edges(g))
  {
    const halfedge_descriptor h = halfedge(e, g);
    put(halfedge_numbers_, h, number++);
    put(halfedge_numbers_, opposite(h, g), number++);
    const Point a = internal::surface::point_of(get(vertex_points, source(h, g)));
    const Point b = internal::surface::point_of(get(vertex_points, target(h, g)));
    for (int k = 1; k < degree; ++k)
      push(edge_points_, internal::surface::straight_edge_node(a, b, k, degree));
  }
  number = 0;
  face_first_.push_back(0);
  for (const face_descriptor f : faces(g))
  {
    std::array<Point, 4> corners = {};
    const int corner_count = internal::surface::gather_corners(g, f, vertex_points, corners);
    internal::surface::check_corner_count(corner_count, number);
    put(face_numbers_, f, number++);
    for (const internal::surface::Lattice_node node : internal::surface::interior_lattice(corner_count, degree))
      push(face_points_, internal::surface::straight_face_node(corners, corner_count, node, degree));
    face_first_.push_back(static_cast<Index>(face_points_.size()));
  }
}

} // namespace recurve

#endif
