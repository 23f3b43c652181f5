#ifndef RECURVE_SURFACE_INTERNAL_STRAIGHT_NODES_H
#define RECURVE_SURFACE_INTERNAL_STRAIGHT_NODES_H

#include <recurve/core/exceptions.h>
#include <recurve/surface/internal/vector_3.h>

#include <CGAL/boost/graph/iterator.h>

#include <boost/graph/graph_traits.hpp>

#include <array>
#include <span>
#include <string>
#include <vector>

/// Where straight-sided edges, triangles and quads have their nodes.
namespace recurve::internal::surface {

/// Largest degree of an element, as in elements/element.h; the lattices below are tested against its node layout.
inline constexpr int max_element_degree = 6;

/// Node of a face at (i/p, j/p) of its reference element.
struct Lattice_node
{
  int i = 0;
  int j = 0;
};

inline void check_element_degree(int degree)
{
  if (degree < 1 || degree > max_element_degree)
    throw Input_error("degree of the elements: expected 1 to 6, found " + std::to_string(degree));
}

inline void check_corner_count(int corner_count, Index face)
{
  if (corner_count != 3 && corner_count != 4)
    throw Input_error("face " + std::to_string(face) + ": expected a triangle or a quadrangle, found " +
                      std::to_string(corner_count) + " corners");
}

template <class Graph>
void check_corner_counts(const Graph& g)
{
  Index number = 0;
  for (const auto f : faces(g))
    check_corner_count(static_cast<int>(CGAL::halfedges_around_face(halfedge(f, g), g).size()), number++);
}

inline std::vector<Lattice_node> make_interior_lattice(int corner_count, int degree)
{
  std::vector<Lattice_node> lattice;
  for (int j = 1; j < degree; ++j)
    for (int i = 1; i < (corner_count == 3 ? degree - j : degree); ++i)
      lattice.push_back({i, j});
  return lattice;
}

/// the nodes inside a face of degree `degree` in canonical order.
inline std::span<const Lattice_node> interior_lattice(int corner_count, int degree)
{
  using Table = std::array<std::array<std::vector<Lattice_node>, max_element_degree + 1>, 2>;
  static const Table table = [] {
    Table all;
    for (int corners = 3; corners <= 4; ++corners)
      for (int p = 1; p <= max_element_degree; ++p)
        all[corners - 3][p] = make_interior_lattice(corners, p);
    return all;
  }();
  return table[corner_count - 3][degree];
}

/// the corners of a face from source(halfedge(f, g)) on; at most the first four. \return how many it has.
template <class Graph, class VertexPointMap>
int gather_corners(const Graph& g, typename boost::graph_traits<Graph>::face_descriptor f, VertexPointMap vertex_points,
                   std::array<Point, 4>& corners)
{
  int count = 0;
  const auto first = halfedge(f, g);
  auto h = first;
  do
  {
    if (count < 4)
      corners[count] = point_of(get(vertex_points, source(h, g)));
    ++count;
    h = next(h, g);
  } while (h != first);
  return count;
}

inline Point straight_edge_node(const Point& a, const Point& b, int k, int degree)
{
  return add(a, scaled(static_cast<double>(k) / degree, subtract(b, a)));
}

inline Point straight_face_node(const std::array<Point, 4>& corners, int corner_count, const Lattice_node& node,
                                int degree)
{
  const double x = static_cast<double>(node.i) / degree;
  const double y = static_cast<double>(node.j) / degree;
  const Point along = scaled(x, subtract(corners[1], corners[0]));
  const Point up = scaled(y, subtract(corners[corner_count - 1], corners[0]));
  Point way = add(along, up);
  if (corner_count == 4) // what bends a quad out of a parallelogram
  {
    const Point twist = subtract(subtract(corners[2], corners[1]), subtract(corners[3], corners[0]));
    way = add(way, scaled(x * y, twist));
  }
  return add(corners[0], way);
}

} // namespace recurve::internal::surface

#endif
