#ifndef RECURVE_FEATURES_INTERNAL_EDGE_PATHS_H
#define RECURVE_FEATURES_INTERNAL_EDGE_PATHS_H

#include <recurve/features/internal/flat_surface.h>
#include <recurve/features/internal/vector_3.h>

#include <boost/graph/compressed_sparse_row_graph.hpp>
#include <boost/graph/dijkstra_shortest_paths.hpp>

#include <algorithm>
#include <limits>
#include <queue>
#include <tuple>
#include <utility>
#include <vector>

namespace recurve::internal::features {

/// Half-edges out of each vertex in the order of the vertices at which they end, which is the same for all models of a
/// graph: where two ways are equally good, the choice depends on nothing but the order of vertices.
inline Out_halfedges sorted_out_halfedges(const Flat_edges& edges)
{
  Out_halfedges out(edges, [](Index) { return true; });
  for (Index v = 0; v < edges.vertices; ++v)
    std::sort(out.halfedges.begin() + out.start[v], out.halfedges.begin() + out.start[v + 1],
              [&](Index a, Index b) { return edges.target[a] < edges.target[b]; });
  return out;
}

/// by how many degrees a curve turns that leaves the half-edge `h` along `following`.
inline double turning_angle(const Flat_surface& s, Index h, Index following)
{
  return angle_between(s.points[s.target[h]] - s.points[s.source_of(h)],
                       s.points[s.target[following]] - s.points[s.source_of(following)]);
}

inline double edge_length(const Flat_surface& s, Index e)
{
  return norm(s.points[s.target[2 * e]] - s.points[s.target[2 * e + 1]]);
}

/// Ways along edges from any of some vertices to any of others: half-edges in their order, empty if there is none.
class Path_finder
{
public:
  /// `is_open` tells per edge whether a way may take it.
  Path_finder(const Flat_surface& surface, const Out_halfedges& out, const std::vector<char>& is_open)
    : s_(surface), out_(out), is_open_(is_open)
  {}

  std::vector<Index> shortest(const std::vector<Index>& from, const std::vector<Index>& to) const;

  /// the way with the least sum of its turning angles and, edge by edge, of a multiple of the relative length: the
  /// flatter the surface at the edge, the longer it counts.
  std::vector<Index> along_crease(const std::vector<Index>& from, const std::vector<Index>& to,
                                  const std::vector<double>& dihedral) const;

private:
  struct Found
  {};

  /// ends the search at the first vertex of the set.
  struct Stop_at : boost::default_dijkstra_visitor
  {
    explicit Stop_at(const std::vector<Index>& vertices) : targets(&vertices) {}

    template <class Vertex, class Graph>
    void examine_vertex(Vertex v, const Graph&) const
    {
      if (std::find(targets->begin(), targets->end(), static_cast<Index>(v)) != targets->end())
        throw Found();
    }

    const std::vector<Index>* targets;
  };

  const Flat_surface& s_;
  const Out_halfedges& out_;
  const std::vector<char>& is_open_;
};

inline std::vector<Index> Path_finder::shortest(const std::vector<Index>& from, const std::vector<Index>& to) const
{
  using Graph = boost::compressed_sparse_row_graph<boost::directedS, boost::no_property, boost::no_property,
                                                   boost::no_property, std::size_t, std::size_t>;
  std::vector<std::pair<std::size_t, std::size_t>> arcs;
  std::vector<double> length;
  for (const Index h : out_.halfedges)
    if (is_open_[h / 2])
    {
      arcs.emplace_back(s_.source_of(h), s_.target[h]);
      length.push_back(edge_length(s_, h / 2));
    }
  const auto vertices = static_cast<std::size_t>(s_.vertices);
  const Graph graph(boost::edges_are_sorted, arcs.begin(), arcs.end(), vertices);
  std::vector<double> distance(vertices);
  std::vector<std::size_t> before(vertices);
  for (std::size_t v = 0; v < vertices; ++v)
    before[v] = v;
  const auto index = get(boost::vertex_index, graph);
  const std::vector<std::size_t> sources(from.begin(), from.end());
  try
  {
    boost::dijkstra_shortest_paths(
      graph, sources.begin(), sources.end(), boost::make_iterator_property_map(before.begin(), index),
      boost::make_iterator_property_map(distance.begin(), index),
      boost::make_iterator_property_map(length.begin(), get(boost::edge_index, graph)), index, std::less<double>(),
      std::plus<double>(), std::numeric_limits<double>::infinity(), 0., Stop_at(to));
  }
  catch (const Found&)
  {}

  const auto end = std::min_element(to.begin(), to.end(), [&](Index a, Index b) { return distance[a] < distance[b]; });
  std::vector<Index> path;
  for (auto v = static_cast<std::size_t>(*end); before[v] != v; v = before[v])
    path.push_back(*std::find_if(out_[static_cast<Index>(before[v])].begin(), out_[static_cast<Index>(before[v])].end(),
                                 [&](Index h) { return is_open_[h / 2] && s_.target[h] == static_cast<Index>(v); }));
  std::reverse(path.begin(), path.end());
  return path;
}

inline std::vector<Index> Path_finder::along_crease(const std::vector<Index>& from, const std::vector<Index>& to,
                                                    const std::vector<double>& dihedral) const
{
  // At this dihedral angle an edge counts half as long as in a plane.
  constexpr double half_angle = 10;
  // A way as long as the straight line, in a plane, costs as much as this many turned radians: three times a
  // half-circle, so that a round rim of 90 degrees is followed rather than cut short across a flat cap.
  constexpr double length_weight = 10;

  const double straight = norm(s_.points[to.front()] - s_.points[from.front()]);
  const auto step = [&](Index h) {
    const double relative_length = straight > 0 ? edge_length(s_, h / 2) / straight : 0;
    return length_weight * relative_length * half_angle / (half_angle + dihedral[h / 2]);
  };
  using Entry = std::tuple<double, Index, Index, Index>; // cost, target, source, half-edge: ties are by vertices
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  std::vector<double> cost(s_.target.size(), std::numeric_limits<double>::infinity());
  std::vector<Index> before(s_.target.size(), no_index);
  const auto reach = [&](Index h, Index previous, double c) {
    if (!is_open_[h / 2] || !(c < cost[h]))
      return;
    cost[h] = c;
    before[h] = previous;
    queue.emplace(c, s_.target[h], s_.source_of(h), h);
  };
  for (const Index v : from)
    for (const Index h : out_[v])
      reach(h, no_index, step(h));
  while (!queue.empty())
  {
    const auto [c, target, source, h] = queue.top();
    queue.pop();
    if (c > cost[h])
      continue;
    if (std::find(to.begin(), to.end(), target) != to.end())
    {
      std::vector<Index> path;
      for (Index g = h; g != no_index; g = before[g])
        path.push_back(g);
      std::reverse(path.begin(), path.end());
      return path;
    }
    for (const Index following : out_[target])
      if (following != (h ^ 1))
        reach(following, h, c + turning_angle(s_, h, following) / degrees_per_radian + step(following));
  }
  return {};
}

} // namespace recurve::internal::features

#endif
