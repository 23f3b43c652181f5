#ifndef RECURVE_SURFACE_INTERNAL_FACE_TRIANGLES_H
#define RECURVE_SURFACE_INTERNAL_FACE_TRIANGLES_H

#include <recurve/core/types.h>
#include <recurve/surface/internal/straight_nodes.h>
#include <recurve/surface/internal/vector_3.h>

#include <CGAL/Box_intersection_d/Box_with_info_d.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangle_3.h>
#include <CGAL/boost/graph/iterator.h>
#include <CGAL/boost/graph/properties.h>
#include <CGAL/box_intersection_d.h>
#include <CGAL/intersections.h>

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

namespace recurve::internal::surface {

using Exact_kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

/// A flat piece of a face.
struct Face_triangle
{
  Index face = no_index;
  Exact_kernel::Triangle_3 triangle;
};

template <class Graph>
std::vector<std::vector<Index>> vertices_of_faces(const Graph& g)
{
  const auto numbers = get(CGAL::dynamic_vertex_property_t<Index>(), g);
  Index number = 0;
  for (const auto v : vertices(g))
    put(numbers, v, number++);
  std::vector<std::vector<Index>> result;
  for (const auto f : faces(g))
  {
    std::vector<Index> corners;
    for (const auto h : CGAL::halfedges_around_face(halfedge(f, g), g))
      corners.push_back(get(numbers, source(h, g)));
    std::sort(corners.begin(), corners.end());
    result.push_back(std::move(corners));
  }
  return result;
}

inline void add_triangle(Index face, const Exact_kernel::Point_3& a, const Exact_kernel::Point_3& b,
                         const Exact_kernel::Point_3& c, std::vector<Face_triangle>& triangles)
{
  if (!CGAL::collinear(a, b, c))
    triangles.push_back({face, Exact_kernel::Triangle_3(a, b, c)});
}

/// The nodes of a face on the lattice 0 <= i, j <= p (i + j <= p in a triangle).
template <class Graph, class Nodes, class VertexPointMap>
class Face_lattice
{
public:
  Face_lattice(const Graph& g, const Nodes& nodes, VertexPointMap vertex_points,
               typename boost::graph_traits<Graph>::face_descriptor face)
    : nodes_(nodes), vertex_points_(vertex_points), g_(g), face_(face)
  {
    for (const auto h : CGAL::halfedges_around_face(halfedge(face, g), g))
      sides_[static_cast<std::size_t>(count_++)] = h;
  }

  int corner_count() const { return count_; }

  Exact_kernel::Point_3 operator()(int i, int j) const
  {
    const int p = nodes_.degree();
    if (count_ == 3)
    {
      if (j == 0)
        return on_side(0, i);
      if (i + j == p)
        return on_side(1, j);
      if (i == 0)
        return on_side(2, p - j);
      return plain(nodes_.face_node(face_, (j - 1) * (2 * p - 2 - j) / 2 + i - 1));
    }
    if (j == 0)
      return on_side(0, i);
    if (i == p)
      return on_side(1, j);
    if (j == p)
      return on_side(2, p - i);
    if (i == 0)
      return on_side(3, p - j);
    return plain(nodes_.face_node(face_, (j - 1) * (p - 1) + i - 1));
  }

private:
  template <class Point3>
  static Exact_kernel::Point_3 plain(const Point3& x)
  {
    const Point p = point_of(x);
    return {p[0], p[1], p[2]};
  }

  Exact_kernel::Point_3 on_side(int side, int k) const
  {
    const auto h = sides_[static_cast<std::size_t>(side)];
    if (k == 0)
      return plain(get(vertex_points_, source(h, g_)));
    if (k == nodes_.degree())
      return plain(get(vertex_points_, target(h, g_)));
    return plain(nodes_.edge_node(h, k));
  }

  const Nodes& nodes_;
  VertexPointMap vertex_points_;
  const Graph& g_;
  typename boost::graph_traits<Graph>::face_descriptor face_;
  std::array<typename boost::graph_traits<Graph>::halfedge_descriptor, 4> sides_ = {};
  int count_ = 0;
};

template <class Graph, class Nodes, class VertexPointMap>
std::vector<Face_triangle> triangles_between_nodes(const Graph& g, const Nodes& nodes, VertexPointMap vertex_points)
{
  std::vector<Face_triangle> triangles;
  Index face = 0;
  const int p = nodes.degree();
  for (const auto f : faces(g))
  {
    const Face_lattice<Graph, Nodes, VertexPointMap> at(g, nodes, vertex_points, f);
    for (int j = 0; j < p; ++j)
      for (int i = 0; i < (at.corner_count() == 3 ? p - j : p); ++i)
      {
        add_triangle(face, at(i, j), at(i + 1, j), at(i, j + 1), triangles);
        if (at.corner_count() == 4 || i + j + 2 <= p)
          add_triangle(face, at(i + 1, j), at(i + 1, j + 1), at(i, j + 1), triangles);
      }
    ++face;
  }
  return triangles;
}

/// straight-sided faces; a quad is split.
template <class Graph, class VertexPointMap>
std::vector<Face_triangle> triangles_of_faces(const Graph& g, VertexPointMap vertex_points)
{
  std::vector<Face_triangle> triangles;
  Index face = 0;
  for (const auto f : faces(g))
  {
    std::array<Point, 4> corners = {};
    const int count = gather_corners(g, f, vertex_points, corners);
    const auto at = [&](int c) {
      const Point& x = corners[static_cast<std::size_t>(c)];
      return Exact_kernel::Point_3(x[0], x[1], x[2]);
    };
    add_triangle(face, at(0), at(1), at(count == 4 ? 3 : 2), triangles);
    if (count == 4)
      add_triangle(face, at(1), at(2), at(3), triangles);
    ++face;
  }
  return triangles;
}

/// pairs of faces without a common vertex whose triangles intersect, ascending.
inline std::vector<std::pair<Index, Index>> intersecting_faces(const std::vector<Face_triangle>& triangles,
                                                               const std::vector<std::vector<Index>>& corners)
{
  using Box = CGAL::Box_intersection_d::Box_with_info_d<double, 3, Index>;
  std::vector<Box> boxes;
  boxes.reserve(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t)
    boxes.emplace_back(triangles[t].triangle.bbox(), static_cast<Index>(t));
  std::vector<std::pair<Index, Index>> pairs;
  const auto share_vertex = [&](Index a, Index b) {
    const auto& of_a = corners[static_cast<std::size_t>(a)];
    const auto& of_b = corners[static_cast<std::size_t>(b)];
    return std::any_of(of_a.begin(), of_a.end(),
                       [&](Index v) { return std::binary_search(of_b.begin(), of_b.end(), v); });
  };
  CGAL::box_self_intersection_d(boxes.begin(), boxes.end(), [&](const Box& a, const Box& b) {
    const Face_triangle& first = triangles[static_cast<std::size_t>(a.info())];
    const Face_triangle& second = triangles[static_cast<std::size_t>(b.info())];
    if (first.face != second.face && !share_vertex(first.face, second.face) &&
        CGAL::do_intersect(first.triangle, second.triangle))
      pairs.emplace_back(std::minmax(first.face, second.face));
  });
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

} // namespace recurve::internal::surface

#endif
