#ifndef RECURVE_FEATURES_INTERNAL_FLAT_SURFACE_H
#define RECURVE_FEATURES_INTERNAL_FLAT_SURFACE_H

#include <recurve/core/exceptions.h>
#include <recurve/core/types.h>
#include <recurve/features/internal/numbering.h>

#include <CGAL/number_utils.h>

#include <cmath>
#include <string>
#include <vector>

namespace recurve::internal::features {

/// Vertex pairs of a graph: half-edges 2e and 2e + 1 of the edge e, in the order of `edges(g)`.
struct Flat_edges
{
  Index vertices = 0;
  std::vector<Index> target; ///< per half-edge, in the order of `vertices(g)`

  Index number_of_edges() const { return static_cast<Index>(target.size()) / 2; }
  Index source_of(Index h) const { return target[h ^ 1]; }
};

/// A face graph as flat arrays, so that what follows is compiled once for all models. Faces in the order of `faces(g)`.
struct Flat_surface : Flat_edges
{
  std::vector<Point> points;        ///< per vertex
  std::vector<Index> next;          ///< per half-edge, around its face
  std::vector<Index> face;          ///< per half-edge; no_index on a border
  std::vector<Index> face_halfedge; ///< per face, one of its half-edges

  Index number_of_vertices() const { return static_cast<Index>(points.size()); }
  Index number_of_faces() const { return static_cast<Index>(face_halfedge.size()); }
  bool is_border_edge(Index e) const { return face[2 * e] == no_index || face[2 * e + 1] == no_index; }
};

/// Half-edges by source vertex: those of v are `halfedges[start[v]]` to `halfedges[start[v + 1] - 1]`, ascending.
struct Out_halfedges
{
  std::vector<Index> start, halfedges;

  /// gathers the half-edges whose edge satisfies `is_taken`.
  template <class Predicate>
  Out_halfedges(const Flat_edges& edges, Predicate is_taken) : start(static_cast<std::size_t>(edges.vertices) + 1, 0)
  {
    const Index ne = edges.number_of_edges();
    for (Index h = 0; h < 2 * ne; ++h)
      if (is_taken(h / 2))
        ++start[edges.source_of(h) + 1];
    for (Index v = 0; v < edges.vertices; ++v)
      start[v + 1] += start[v];
    halfedges.resize(static_cast<std::size_t>(start.back()));
    std::vector<Index> end(start.begin(), start.end() - 1);
    for (Index h = 0; h < 2 * ne; ++h)
      if (is_taken(h / 2))
        halfedges[end[edges.source_of(h)]++] = h;
  }

  struct Range
  {
    const Index *first, *last;
    const Index* begin() const { return first; }
    const Index* end() const { return last; }
    Index size() const { return last - first; }
  };
  Range operator[](Index v) const { return {halfedges.data() + start[v], halfedges.data() + start[v + 1]}; }
};

/// writes `flags`, in the order of the range `descriptors`, to `map`.
template <class Range, class Map>
void write_flags(const Range& descriptors, const std::vector<char>& flags, Map map)
{
  using Value = typename boost::property_traits<Map>::value_type;
  for (std::size_t i = 0; const auto d : CGAL::make_range(descriptors))
    put(map, d, static_cast<Value>(flags[i++] != 0));
}

/// reads a map of bool or char in the order of the range `descriptors`.
template <class Range, class Map>
std::vector<char> read_flags(const Range& descriptors, Map map)
{
  std::vector<char> flags;
  for (const auto d : CGAL::make_range(descriptors))
    flags.push_back(get(map, d) ? 1 : 0);
  return flags;
}

/// reads a map of face_descriptor -> an integer in the order of `faces(g)`.
template <class Graph, class FacePatchMap>
std::vector<Index> read_patches(const Graph& g, FacePatchMap map)
{
  std::vector<Index> patches;
  for (const auto f : CGAL::make_range(faces(g)))
    patches.push_back(static_cast<Index>(get(map, f)));
  return patches;
}

/// the edges of `g` alone.
template <class Graph>
Flat_edges flatten_edges(const Graph& g)
{
  const auto vertex_number = number_vertices(g);
  Flat_edges flat;
  flat.vertices = vertex_number.size();
  flat.target.reserve(2 * num_edges(g));
  for (const auto e : CGAL::make_range(edges(g)))
  {
    const auto h = halfedge(e, g);
    flat.target.push_back(vertex_number(target(h, g)));
    flat.target.push_back(vertex_number(source(h, g)));
  }
  return flat;
}

/// `g` with the positions `points` of its vertices.
template <class Graph, class VertexPointMap>
Flat_surface flatten(const Graph& g, VertexPointMap points)
{
  Flat_surface flat;
  static_cast<Flat_edges&>(flat) = flatten_edges(g);
  flat.points.reserve(static_cast<std::size_t>(flat.vertices));
  for (const auto v : CGAL::make_range(vertices(g)))
  {
    const auto& p = get(points, v);
    flat.points.push_back({CGAL::to_double(p[0]), CGAL::to_double(p[1]), CGAL::to_double(p[2])});
    for (const double x : flat.points.back())
      if (!std::isfinite(x))
        throw Input_error("features: the position of vertex " + std::to_string(flat.points.size() - 1) +
                          " is not finite");
  }
  Numbering halfedge_number(index_map<boost::halfedge_index_t>(g));
  halfedge_number.reserve(flat.target.size());
  Index n = 0;
  for (const auto e : CGAL::make_range(edges(g)))
  {
    halfedge_number.add(halfedge(e, g), n++);
    halfedge_number.add(opposite(halfedge(e, g), g), n++);
  }
  flat.next.assign(flat.target.size(), no_index);
  flat.face.assign(flat.target.size(), no_index);
  for (const auto f : CGAL::make_range(faces(g)))
  {
    const Index id = flat.number_of_faces();
    const auto first = halfedge(f, g);
    flat.face_halfedge.push_back(halfedge_number(first));
    auto h = first;
    do
    {
      const Index number = halfedge_number(h);
      h = next(h, g);
      flat.next[number] = halfedge_number(h);
      flat.face[number] = id;
    } while (h != first);
  }
  return flat;
}

} // namespace recurve::internal::features

#endif
