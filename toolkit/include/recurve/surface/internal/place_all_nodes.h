#ifndef RECURVE_SURFACE_INTERNAL_PLACE_ALL_NODES_H
#define RECURVE_SURFACE_INTERNAL_PLACE_ALL_NODES_H

#include <recurve/core/progress.h>
#include <recurve/surface/curving_surface_report.h>
#include <recurve/surface/internal/place_nodes.h>
#include <recurve/surface/surface_nodes.h>

#include <CGAL/boost/graph/iterator.h>
#include <boost/property_map/property_map.hpp>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <vector>

namespace recurve::internal::surface {

/// Edges or faces whose nodes are placed in parallel before they are handed over one by one.
inline constexpr Index items_per_block = 16384;

inline constexpr auto curving_stage = "curve surface";

inline void add_to_report(const Point& displacement, double edge_length, Curving_surface_report& report)
{
  const double way = length(displacement);
  report.largest_displacement = std::max(report.largest_displacement, way);
  if (edge_length > 0)
    report.largest_relative_displacement = std::max(report.largest_relative_displacement, way / edge_length);
}

template <class Point3, class Node>
Point3 moved_point(const Node& node)
{
  const Point x = add(node.straight, node.displacement);
  return Point3(x[0], x[1], x[2]);
}

/// calls work(i) for i = first, ..., last - 1 on all threads.
template <class Work>
void for_each_in_parallel(Index first, Index last, const Work& work)
{
  tbb::parallel_for(tbb::blocked_range<Index>(first, last), [&work](const tbb::blocked_range<Index>& range) {
    for (Index i = range.begin(); i < range.end(); ++i)
      work(i);
  });
}

template <class Point3, class Graph, class Placer, class EdgeNodeMap>
void place_edges(const Graph& g, const Placer& placer, EdgeNodeMap edge_nodes, int degree,
                 const Progress_callback& progress, Curving_surface_report& report)
{
  using edge_descriptor = typename boost::graph_traits<Graph>::edge_descriptor;
  const auto range = edges(g);
  const std::vector<edge_descriptor> all(range.begin(), range.end());
  report.edges = static_cast<Index>(all.size());
  const Index per_edge = degree - 1;
  std::vector<typename Placer::Placed_node> nodes(std::min(items_per_block, report.edges) * per_edge);
  std::vector<double> lengths(std::min(items_per_block, report.edges));
  for (Index first = 0; first < report.edges; first += items_per_block)
  {
    const Index last = std::min(first + items_per_block, report.edges);
    for_each_in_parallel(first, last, [&](Index i) {
      lengths[i - first] = placer.place_edge(
        halfedge(all[i], g), {nodes.data() + (i - first) * per_edge, static_cast<std::size_t>(per_edge)});
    });
    for (Index i = first; i < last; ++i)
      for (int k = 1; k < degree; ++k)
      {
        const auto& node = nodes[(i - first) * per_edge + k - 1];
        if (is_zero(node.displacement))
          continue;
        put(edge_nodes, Edge_node<Graph>{halfedge(all[i], g), k}, moved_point<Point3>(node));
        ++report.moved_edge_nodes;
        add_to_report(node.displacement, lengths[i - first], report);
      }
    report_progress(progress, curving_stage, 0.5 * static_cast<double>(last) / report.edges);
  }
}

template <class Point3, class Graph, class Placer, class FaceNodeMap>
void place_faces(const Graph& g, const Placer& placer, FaceNodeMap face_nodes, const Progress_callback& progress,
                 Curving_surface_report& report)
{
  using face_descriptor = typename boost::graph_traits<Graph>::face_descriptor;
  const auto range = faces(g);
  const std::vector<face_descriptor> all(range.begin(), range.end());
  report.faces = static_cast<Index>(all.size());
  std::vector<std::vector<typename Placer::Placed_node>> nodes(std::min(items_per_block, report.faces));
  std::vector<double> lengths(nodes.size());
  for (Index first = 0; first < report.faces; first += items_per_block)
  {
    const Index last = std::min(first + items_per_block, report.faces);
    for_each_in_parallel(first, last,
                         [&](Index i) { lengths[i - first] = placer.place_face(all[i], nodes[i - first]); });
    for (Index i = first; i < last; ++i)
      for (int m = 0; m < static_cast<int>(nodes[i - first].size()); ++m)
      {
        const auto& node = nodes[i - first][m];
        if (is_zero(node.displacement))
          continue;
        put(face_nodes, Face_node<Graph>{all[i], m}, moved_point<Point3>(node));
        ++report.moved_face_nodes;
        add_to_report(node.displacement, lengths[i - first], report);
      }
    report_progress(progress, curving_stage, 0.5 + 0.5 * static_cast<double>(last) / report.faces);
  }
}

/// places all nodes in parallel and writes those that move, in the order of `edges(g)` and `faces(g)`.
template <class Graph, class Placer, class EdgeNodeMap, class FaceNodeMap>
Curving_surface_report place_all_nodes(const Graph& g, const Placer& placer, const Curve_places<Graph>& curves,
                                       EdgeNodeMap edge_nodes, FaceNodeMap face_nodes, int degree,
                                       const Progress_callback& progress)
{
  Curving_surface_report report;
  report.curve_edges = curves.size();
  report_progress(progress, curving_stage, 0);
  place_edges<typename boost::property_traits<EdgeNodeMap>::value_type>(g, placer, edge_nodes, degree, progress,
                                                                        report);
  place_faces<typename boost::property_traits<FaceNodeMap>::value_type>(g, placer, face_nodes, progress, report);
  return report;
}

} // namespace recurve::internal::surface

#endif
