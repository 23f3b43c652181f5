#ifndef RECURVE_SURFACE_INTERNAL_GATHER_SURFACE_H
#define RECURVE_SURFACE_INTERNAL_GATHER_SURFACE_H

#include <recurve/core/exceptions.h>
#include <recurve/core/named_parameters.h>
#include <recurve/surface/internal/face_normal.h>
#include <recurve/surface/internal/surface_arrays.h>
#include <recurve/surface/internal/vector_3.h>

#include <CGAL/boost/graph/iterator.h>
#include <CGAL/boost/graph/properties.h>
#include <boost/graph/graph_traits.hpp>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <numeric>
#include <string>
#include <vector>

namespace recurve::internal::surface {

/// Critical edges at a vertex from which on it is sharp: three edges belong to at least two curves.
inline constexpr int sharp_edge_count = 3;

/// What is read from the graph, before it is cut along its critical edges.
struct Uncut_surface
{
  std::vector<Point> points;  ///< per vertex of the graph
  std::vector<Point> normals; ///< the caller's, per vertex of the graph, or empty
  std::vector<int> critical_edge_counts;
  std::vector<std::uint8_t> is_sharp;
  std::vector<Index> face_first;
  std::vector<Index> corner_vertices; ///< vertices of the graph
  std::vector<std::uint8_t> is_critical_edge;
  std::vector<Index> opposite_corners; ///< the corner whose edge is the same one seen from the other face, or no_index

  bool is_critical(Index vertex) const { return critical_edge_counts[vertex] > 0 || is_sharp[vertex] != 0; }
};

/// Reads a graph, one thing after the other: property maps of foreign graphs need not be safe for threads.
template <class Graph, class NamedParameters>
class Graph_reader
{
  using Traits = boost::graph_traits<Graph>;
  using Vertex_numbers = typename boost::property_map<Graph, CGAL::dynamic_vertex_property_t<Index>>::const_type;
  using Halfedge_numbers = typename boost::property_map<Graph, CGAL::dynamic_halfedge_property_t<Index>>::const_type;
  using halfedge_descriptor = typename Traits::halfedge_descriptor;

public:
  Graph_reader(const Graph& g, const NamedParameters& params)
    : g_(g), params_(params), vertex_numbers_(get(CGAL::dynamic_vertex_property_t<Index>(), g)),
      corner_of_(get(CGAL::dynamic_halfedge_property_t<Index>(), g))
  {}

  Uncut_surface read()
  {
    read_vertices();
    read_faces();
    read_edges();
    return std::move(surface_);
  }

private:
  void read_vertices()
  {
    const auto point_map = parameter_or<names::vertex_point_map>(params_, get(CGAL::vertex_point, g_));
    [[maybe_unused]] const auto normal_map = parameter_or<names::vertex_normal_map>(params_, nullptr);
    [[maybe_unused]] const auto sharp_map = parameter_or<names::vertex_is_constrained_map>(params_, nullptr);
    for (const auto v : vertices(g_))
    {
      const Index number = static_cast<Index>(surface_.points.size());
      put(vertex_numbers_, v, number);
      const Point x = point_of(get(point_map, v));
      if (!std::isfinite(x[0]) || !std::isfinite(x[1]) || !std::isfinite(x[2]))
        throw Input_error("vertex " + std::to_string(number) + " of the surface: coordinate is not finite");
      surface_.points.push_back(x);
      if constexpr (has_parameter<NamedParameters, names::vertex_normal_map>)
        surface_.normals.push_back(point_of(get(normal_map, v)));
      if constexpr (has_parameter<NamedParameters, names::vertex_is_constrained_map>)
        surface_.is_sharp.push_back(get(sharp_map, v) ? 1 : 0);
      else
        surface_.is_sharp.push_back(0);
    }
    surface_.critical_edge_counts.assign(surface_.points.size(), 0);
  }

  void read_faces()
  {
    for (const auto h : halfedges(g_))
      put(corner_of_, h, no_index);
    surface_.face_first.push_back(0);
    std::vector<halfedge_descriptor> around;
    for (const auto f : faces(g_))
    {
      around.clear();
      for (const auto h : CGAL::halfedges_around_face(halfedge(f, g_), g_))
        around.push_back(h);
      const auto number_of = [this](halfedge_descriptor h) { return get(vertex_numbers_, source(h, g_)); };
      const auto lowest =
        std::min_element(around.begin(), around.end(),
                         [&](halfedge_descriptor a, halfedge_descriptor b) { return number_of(a) < number_of(b); });
      std::rotate(around.begin(), lowest, around.end());
      for (const auto h : around)
      {
        put(corner_of_, h, static_cast<Index>(corner_halfedges_.size()));
        corner_halfedges_.push_back(h);
        surface_.corner_vertices.push_back(number_of(h));
      }
      surface_.face_first.push_back(static_cast<Index>(corner_halfedges_.size()));
    }
  }

  void read_edges()
  {
    [[maybe_unused]] const auto critical_map = parameter_or<names::edge_is_constrained_map>(params_, nullptr);
    const auto is_critical = [&]([[maybe_unused]] typename Traits::edge_descriptor e) -> bool {
      if constexpr (has_parameter<NamedParameters, names::edge_is_constrained_map>)
        return get(critical_map, e) ? true : false;
      else
        return false;
    };
    for (const auto e : edges(g_))
      if (is_critical(e))
      {
        ++surface_.critical_edge_counts[get(vertex_numbers_, source(halfedge(e, g_), g_))];
        ++surface_.critical_edge_counts[get(vertex_numbers_, target(halfedge(e, g_), g_))];
      }
    for (std::size_t v = 0; v < surface_.points.size(); ++v)
      if (surface_.critical_edge_counts[v] >= sharp_edge_count)
        surface_.is_sharp[v] = 1;
    for (const auto h : corner_halfedges_)
    {
      surface_.is_critical_edge.push_back(is_critical(edge(h, g_)) ? 1 : 0);
      surface_.opposite_corners.push_back(get(corner_of_, opposite(h, g_)));
    }
  }

  const Graph& g_;
  const NamedParameters& params_;
  Vertex_numbers vertex_numbers_;
  Halfedge_numbers corner_of_;
  std::vector<halfedge_descriptor> corner_halfedges_;
  Uncut_surface surface_;
};

/// Cuts a surface open along its critical edges.
class Surface_cutter
{
public:
  Surface_cutter(const Uncut_surface& uncut, Neighbor_rule rule) : uncut_(uncut), rule_(rule) {}

  Surface_arrays cut()
  {
    cut_.face_first = uncut_.face_first;
    cut_.is_critical_edge = uncut_.is_critical_edge;
    cut_.corner_faces.resize(uncut_.corner_vertices.size());
    for (Index f = 0; f < cut_.face_count(); ++f)
      std::fill(cut_.corner_faces.begin() + cut_.face_first[f], cut_.corner_faces.begin() + cut_.face_first[f + 1], f);
    number_vertices();
    gather_corners_of_vertices();
    mark_rims();
    gather_neighbors();
    compute_normals();
    return std::move(cut_);
  }

private:
  /// Corners of one vertex belong together when one can turn from face to face between them without crossing a critical
  /// edge.
  std::vector<Index> unite_corners() const
  {
    std::vector<Index> parents(uncut_.corner_vertices.size());
    std::iota(parents.begin(), parents.end(), Index(0));
    const auto root_of = [&parents](Index corner) {
      while (parents[corner] != corner)
        corner = parents[corner] = parents[parents[corner]];
      return corner;
    };
    for (Index corner = 0; corner < static_cast<Index>(parents.size()); ++corner)
    {
      const Index opposite = uncut_.opposite_corners[corner];
      if (opposite == no_index || uncut_.is_critical_edge[corner])
        continue;
      const Index a = root_of(corner);
      const Index b = root_of(cut_.next_corner(opposite));
      parents[std::max(a, b)] = std::min(a, b); // the lowest corner stands for the group, whatever the order
    }
    for (Index corner = 0; corner < static_cast<Index>(parents.size()); ++corner)
      parents[corner] = parents[parents[corner]]; // parents are lower and therefore roots already
    return parents;
  }

  /// Vertices of the cut surface in the order of the graph's, those of one vertex by their lowest corner.
  void number_vertices()
  {
    const std::vector<Index> roots = unite_corners();
    std::vector<Index> first(uncut_.points.size() + 1, 0);
    for (Index corner = 0; corner < static_cast<Index>(roots.size()); ++corner)
      if (roots[corner] == corner)
        ++first[uncut_.corner_vertices[corner] + 1];
    std::partial_sum(first.begin(), first.end(), first.begin());
    const Index count = first.back();
    cut_.points.resize(count);
    cut_.original_vertices.resize(count);
    cut_.corner_vertices.resize(roots.size());
    for (Index corner = 0; corner < static_cast<Index>(roots.size()); ++corner)
    {
      if (roots[corner] != corner)
      {
        cut_.corner_vertices[corner] = cut_.corner_vertices[roots[corner]];
        continue;
      }
      const Index original = uncut_.corner_vertices[corner];
      const Index number = first[original]++;
      cut_.corner_vertices[corner] = number;
      cut_.original_vertices[number] = original;
      cut_.points[number] = uncut_.points[original];
    }
  }

  void gather_corners_of_vertices()
  {
    cut_.corner_first.assign(cut_.points.size() + 1, 0);
    for (const Index vertex : cut_.corner_vertices)
      ++cut_.corner_first[vertex + 1];
    std::partial_sum(cut_.corner_first.begin(), cut_.corner_first.end(), cut_.corner_first.begin());
    std::vector<Index> place(cut_.corner_first.begin(), cut_.corner_first.end() - 1);
    cut_.vertex_corners.resize(cut_.corner_vertices.size());
    for (Index corner = 0; corner < static_cast<Index>(cut_.corner_vertices.size()); ++corner)
      cut_.vertex_corners[place[cut_.corner_vertices[corner]]++] = corner;
  }

  void mark_rims()
  {
    cut_.is_rim.assign(cut_.points.size(), 0);
    for (Index corner = 0; corner < static_cast<Index>(cut_.corner_vertices.size()); ++corner)
      if (uncut_.is_critical_edge[corner] || uncut_.opposite_corners[corner] == no_index)
        cut_.is_rim[cut_.corner_vertices[corner]] = cut_.is_rim[cut_.corner_vertices[cut_.next_corner(corner)]] = 1;
    cut_.is_tip.assign(cut_.points.size(), 0);
    for (Index vertex = 0; vertex < cut_.vertex_count(); ++vertex)
      cut_.is_tip[vertex] = uncut_.is_sharp[cut_.original_vertices[vertex]] && !cut_.is_rim[vertex] ? 1 : 0;
  }

  void gather_neighbors()
  {
    cut_.neighbor_first.push_back(0);
    for (Index vertex = 0; vertex < cut_.vertex_count(); ++vertex)
    {
      const Index original = cut_.original_vertices[vertex];
      const std::size_t first = cut_.neighbors.size();
      if (rule_ == Neighbor_rule::whole_region ? !cut_.is_tip[vertex] : !uncut_.is_sharp[original])
        add_neighbors(vertex, rule_ == Neighbor_rule::along_curves && uncut_.is_critical(original));
      std::sort(cut_.neighbors.begin() + first, cut_.neighbors.end());
      cut_.neighbors.erase(std::unique(cut_.neighbors.begin() + first, cut_.neighbors.end()), cut_.neighbors.end());
      cut_.neighbor_first.push_back(static_cast<Index>(cut_.neighbors.size()));
    }
  }

  void add_neighbors(Index vertex, bool only_critical)
  {
    for (const Index corner : cut_.corners_of_vertex(vertex))
    {
      const Index previous = cut_.previous_corner(corner);
      if (!only_critical || cut_.is_critical_edge[corner])
        cut_.neighbors.push_back(cut_.corner_vertices[cut_.next_corner(corner)]);
      if (!only_critical || cut_.is_critical_edge[previous])
        cut_.neighbors.push_back(cut_.corner_vertices[previous]);
    }
  }

  void compute_normals()
  {
    cut_.face_normals.resize(cut_.face_count());
    tbb::parallel_for(tbb::blocked_range<Index>(0, cut_.face_count()), [this](const tbb::blocked_range<Index>& range) {
      for (Index f = range.begin(); f < range.end(); ++f)
        cut_.face_normals[f] = face_normal(cut_.corners_of_face(f), cut_.points);
    });
    cut_.normals.resize(cut_.points.size());
    tbb::parallel_for(tbb::blocked_range<Index>(0, cut_.vertex_count()),
                      [this](const tbb::blocked_range<Index>& range) {
                        for (Index v = range.begin(); v < range.end(); ++v)
                          cut_.normals[v] = vertex_normal(v);
                      });
  }

  Point vertex_normal(Index vertex) const
  {
    const Index original = cut_.original_vertices[vertex];
    if (!uncut_.normals.empty() && !uncut_.is_critical(original))
      return uncut_.normals[original];
    Point sum = {0, 0, 0};
    for (const Index corner : cut_.corners_of_vertex(vertex))
    {
      const Point& apex = cut_.points[vertex];
      const Point a = subtract(cut_.points[cut_.corner_vertices[cut_.next_corner(corner)]], apex);
      const Point b = subtract(cut_.points[cut_.corner_vertices[cut_.previous_corner(corner)]], apex);
      const double angle = std::atan2(length(cross(a, b)), dot(a, b));
      sum = add(sum, scaled(angle, cut_.face_normals[cut_.corner_faces[corner]]));
    }
    return normalized(sum);
  }

  const Uncut_surface& uncut_;
  Neighbor_rule rule_;
  Surface_arrays cut_;
};

template <class Graph, class NamedParameters>
Surface_arrays gather_surface(const Graph& g, const NamedParameters& params,
                              Neighbor_rule rule = Neighbor_rule::along_curves)
{
  const Uncut_surface uncut = Graph_reader<Graph, NamedParameters>(g, params).read();
  return Surface_cutter(uncut, rule).cut();
}

} // namespace recurve::internal::surface

#endif
