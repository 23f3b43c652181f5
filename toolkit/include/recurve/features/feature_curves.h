#ifndef RECURVE_FEATURES_FEATURE_CURVES_H
#define RECURVE_FEATURES_FEATURE_CURVES_H

#include <recurve/features/curve_spline.h>
#include <recurve/features/internal/edge_chains.h>

#include <CGAL/boost/graph/iterator.h>

#include <boost/graph/graph_traits.hpp>

#include <vector>

namespace recurve {

/// A chain of critical edges between sharp vertices, or closed.
template <class Graph>
struct Feature_curve
{
  using halfedge_descriptor = typename boost::graph_traits<Graph>::halfedge_descriptor;

  std::vector<halfedge_descriptor> halfedges; ///< each starts where the one before it ends
  bool is_closed = false; ///< smooth and closed: the last half-edge ends where the first starts, and no sharp vertex
                          ///< is on the curve. (A loop through one sharp vertex is open, with equal ends.)
};

/// the feature curves of `g`: maximal chains of critical edges that end at sharp vertices and at vertices where other
/// than two critical edges meet. Each critical edge is in exactly one curve.
///
/// Order and direction depend on nothing but the order of `vertices(g)`: curves are sorted by their first vertex, then
/// by their second; an open curve starts at its smaller end, a closed one at its smallest vertex towards its smaller
/// neighbour.
///
/// \tparam Graph              model of `FaceListGraph`.
/// \tparam EdgeIsCriticalMap  model of `ReadablePropertyMap`: edge_descriptor -> bool or char.
/// \tparam VertexIsSharpMap   model of `ReadablePropertyMap`: vertex_descriptor -> bool or char.
/// \par Complexity  linear in the size of `g`, and n log n in the number of curves.
template <class Graph, class EdgeIsCriticalMap, class VertexIsSharpMap>
std::vector<Feature_curve<Graph>> trace_feature_curves(const Graph& g, EdgeIsCriticalMap edge_is_critical,
                                                       VertexIsSharpMap vertex_is_sharp)
{
  namespace f = internal::features;
  const f::Flat_edges flat = f::flatten_edges(g);
  const auto is_critical = f::read_flags(edges(g), edge_is_critical);
  const auto is_sharp = f::read_flags(vertices(g), vertex_is_sharp);
  std::vector<typename Feature_curve<Graph>::halfedge_descriptor> halfedge_of;
  for (const auto e : CGAL::make_range(edges(g)))
    halfedge_of.push_back(halfedge(e, g));

  std::vector<Feature_curve<Graph>> curves;
  for (const f::Edge_chain& chain : f::Chain_tracer(flat, is_critical, is_sharp).run())
  {
    Feature_curve<Graph>& curve = curves.emplace_back();
    curve.is_closed = chain.is_closed;
    for (const Index h : chain.halfedges)
      curve.halfedges.push_back(h % 2 == 0 ? halfedge_of[h / 2] : opposite(halfedge_of[h / 2], g));
  }
  return curves;
}

/// vertex_is_critical: marks the vertices of critical edges and the sharp vertices. The map is written completely.
///
/// \tparam VertexIsCriticalMap  model of `WritablePropertyMap`: vertex_descriptor -> bool or char.
/// \par Complexity  linear in the size of `g`.
template <class Graph, class EdgeIsCriticalMap, class VertexIsSharpMap, class VertexIsCriticalMap>
void mark_critical_vertices(const Graph& g, EdgeIsCriticalMap edge_is_critical, VertexIsSharpMap vertex_is_sharp,
                            VertexIsCriticalMap vertex_is_critical)
{
  namespace f = internal::features;
  const f::Flat_edges flat = f::flatten_edges(g);
  const auto is_critical = f::read_flags(edges(g), edge_is_critical);
  auto flags = f::read_flags(vertices(g), vertex_is_sharp);
  for (Index e = 0; e < flat.number_of_edges(); ++e)
    if (is_critical[e])
      flags[flat.target[2 * e]] = flags[flat.target[2 * e + 1]] = 1;
  f::write_flags(vertices(g), flags, vertex_is_critical);
}

/// edge_curve: numbers the curves of `curves` 0, 1, ... and writes its curve's number to each of their edges, -1 to all
/// others.
///
/// \tparam EdgeCurveMap  model of `WritablePropertyMap`: edge_descriptor -> a signed integer.
/// \par Complexity  linear in the edges of `g`.
template <class Graph, class EdgeCurveMap>
void number_feature_curves(const Graph& g, const std::vector<Feature_curve<Graph>>& curves, EdgeCurveMap edge_curve)
{
  using Number = typename boost::property_traits<EdgeCurveMap>::value_type;
  for (const auto e : CGAL::make_range(edges(g)))
    put(edge_curve, e, Number(-1));
  for (std::size_t i = 0; i < curves.size(); ++i)
    for (const auto h : curves[i].halfedges)
      put(edge_curve, edge(h, g), static_cast<Number>(i));
}

/// face_region: numbers the surface regions of `g`, the connected faces bounded by critical edges, and returns how many
/// there are. They are numbered in the order of the first face of each in `faces(g)`.
///
/// \tparam FaceRegionMap  model of `WritablePropertyMap`: face_descriptor -> an integer.
/// \par Complexity  linear in the size of `g`.
template <class Graph, class EdgeIsCriticalMap, class FaceRegionMap>
Index number_surface_regions(const Graph& g, EdgeIsCriticalMap edge_is_critical, FaceRegionMap face_region)
{
  using Number = typename boost::property_traits<FaceRegionMap>::value_type;
  using Face = typename boost::graph_traits<Graph>::face_descriptor;
  for (const auto f : CGAL::make_range(faces(g)))
    put(face_region, f, Number(-1));
  Index regions = 0;
  std::vector<Face> front;
  for (const auto seed : CGAL::make_range(faces(g)))
  {
    if (get(face_region, seed) != Number(-1))
      continue;
    put(face_region, seed, static_cast<Number>(regions));
    front.assign(1, seed);
    while (!front.empty())
    {
      const Face f = front.back();
      front.pop_back();
      for (const auto h : CGAL::halfedges_around_face(halfedge(f, g), g))
      {
        const Face other = face(opposite(h, g), g);
        if (get(edge_is_critical, edge(h, g)) || other == boost::graph_traits<Graph>::null_face() ||
            get(face_region, other) != Number(-1))
          continue;
        put(face_region, other, static_cast<Number>(regions));
        front.push_back(other);
      }
    }
    ++regions;
  }
  return regions;
}

} // namespace recurve

#endif
