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
#include <cmath>
#include <cstdint>
#include <memory>
#include <numeric>
#include <span>
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
  std::vector<std::int32_t> graph_corners; ///< see Surface_arrays
  std::vector<Index> corner_vertices;      ///< vertices of the graph
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
    surface_.points.reserve(num_vertices(g_));
    surface_.is_sharp.reserve(num_vertices(g_));
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
    surface_.face_first.reserve(num_faces(g_) + 1);
    surface_.graph_corners.reserve(num_faces(g_));
    surface_.corner_vertices.reserve(num_halfedges(g_));
    corner_halfedges_.reserve(num_halfedges(g_));
    surface_.face_first.push_back(0);
    std::vector<halfedge_descriptor> around;
    std::vector<Index> numbers;
    for (const auto f : faces(g_))
    {
      around.clear();
      numbers.clear();
      const halfedge_descriptor first = halfedge(f, g_);
      for (auto h = first; around.empty() || h != first; h = next(h, g_))
      {
        around.push_back(h);
        numbers.push_back(get(vertex_numbers_, source(h, g_)));
      }
      const std::size_t lowest =
        static_cast<std::size_t>(std::min_element(numbers.begin(), numbers.end()) - numbers.begin());
      surface_.graph_corners.push_back(static_cast<std::int32_t>(lowest == 0 ? 0 : around.size() - lowest));
      for (std::size_t i = 0; i < around.size(); ++i)
      {
        const std::size_t j = lowest + i < around.size() ? lowest + i : lowest + i - around.size();
        put(corner_of_, around[j], static_cast<Index>(corner_halfedges_.size()));
        corner_halfedges_.push_back(around[j]);
        surface_.corner_vertices.push_back(numbers[j]);
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
    if constexpr (has_parameter<NamedParameters, names::edge_is_constrained_map>)
      for (const auto e : edges(g_))
        if (is_critical(e))
        {
          ++surface_.critical_edge_counts[get(vertex_numbers_, source(halfedge(e, g_), g_))];
          ++surface_.critical_edge_counts[get(vertex_numbers_, target(halfedge(e, g_), g_))];
        }
    for (std::size_t v = 0; v < surface_.points.size(); ++v)
      if (surface_.critical_edge_counts[v] >= sharp_edge_count)
        surface_.is_sharp[v] = 1;
    surface_.is_critical_edge.reserve(corner_halfedges_.size());
    surface_.opposite_corners.reserve(corner_halfedges_.size());
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
  Surface_cutter(Uncut_surface&& uncut, Neighbor_rule rule) : uncut_(std::move(uncut)), rule_(rule) {}

  Surface_arrays cut()
  {
    cut_.face_first = std::move(uncut_.face_first);
    cut_.graph_corners = std::move(uncut_.graph_corners);
    cut_.is_critical_edge = std::move(uncut_.is_critical_edge);
    cut_.corner_faces.resize(uncut_.corner_vertices.size());
    tbb::parallel_for(tbb::blocked_range<Index>(0, cut_.face_count()), [this](const tbb::blocked_range<Index>& range) {
      for (Index f = range.begin(); f < range.end(); ++f)
        std::fill(cut_.corner_faces.begin() + cut_.face_first[f], cut_.corner_faces.begin() + cut_.face_first[f + 1],
                  f);
    });
    number_vertices();
    mark_rims();
    gather_neighbors();
    compute_normals();
    return std::move(cut_);
  }

private:
  /// Vertices of the cut surface in the order of the graph's, those of one vertex by their lowest corner.
  void number_vertices()
  {
    const std::vector<Index> corner_first = sort_corners();
    std::vector<Index> first(corner_first.size(), 0);
    cut_.corner_vertices.resize(uncut_.corner_vertices.size());
    const auto parents = std::make_unique_for_overwrite<Index[]>(uncut_.corner_vertices.size());
    const auto corners_of = [&](Index original) {
      return std::span<Index>(cut_.vertex_corners.data() + corner_first[original],
                              cut_.vertex_corners.data() + corner_first[original + 1]);
    };
    for_each_original([&](Index original) { first[original + 1] = group(corners_of(original), parents.get()); });
    std::partial_sum(first.begin(), first.end(), first.begin());
    const Index count = first.back();
    cut_.points.resize(count);
    cut_.original_vertices.resize(count);
    cut_.corner_first.assign(static_cast<std::size_t>(count) + 1, static_cast<Index>(cut_.vertex_corners.size()));
    for_each_original([&](Index original) {
      Index number = first[original] - 1;
      for (Index& corner : corners_of(original))
      {
        const Index in_group = first[original] + cut_.corner_vertices[corner];
        if (in_group > number)
        {
          number = in_group;
          cut_.corner_first[number] = &corner - cut_.vertex_corners.data();
          cut_.original_vertices[number] = original;
          cut_.points[number] = uncut_.points[original];
        }
        cut_.corner_vertices[corner] = number;
      }
    });
  }

  template <class Work>
  void for_each_original(const Work& work) const
  {
    const Index count = static_cast<Index>(uncut_.points.size());
    tbb::parallel_for(tbb::blocked_range<Index>(0, count, 256), [&](const tbb::blocked_range<Index>& range) {
      for (Index original = range.begin(); original < range.end(); ++original)
        work(original);
    });
  }

  /// sets cut_.vertex_corners, ascending for each vertex of the graph. \return where those of each start.
  std::vector<Index> sort_corners()
  {
    std::vector<Index> first(uncut_.points.size() + 1, 0);
    for (const Index original : uncut_.corner_vertices)
      ++first[original + 1];
    std::partial_sum(first.begin(), first.end(), first.begin());
    cut_.vertex_corners.resize(uncut_.corner_vertices.size());
    std::vector<Index> place(first.begin(), first.end() - 1);
    for (Index corner = 0; corner < static_cast<Index>(uncut_.corner_vertices.size()); ++corner)
      cut_.vertex_corners[place[uncut_.corner_vertices[corner]]++] = corner;
    return first;
  }

  /// Corners of one vertex belong together when one can turn from face to face between them without crossing a critical
  /// edge. Sorts all corners of a vertex of the graph by such groups, groups by their lowest corners, and sets
  /// cut_.corner_vertices to the number of the group. \param parents  room for an entry per corner of the surface.
  /// \return how many groups there are.
  Index group(std::span<Index> corners, Index* parents)
  {
    if (is_one_group(corners))
    {
      for (const Index corner : corners)
        cut_.corner_vertices[corner] = 0;
      return 1;
    }
    for (const Index corner : corners)
      parents[corner] = corner;
    const auto root_of = [parents](Index corner) {
      while (parents[corner] != corner)
        corner = parents[corner] = parents[parents[corner]];
      return corner;
    };
    for (const Index corner : corners)
    {
      const Index opposite = uncut_.opposite_corners[corner];
      if (opposite == no_index || cut_.is_critical_edge[corner])
        continue;
      const Index a = root_of(corner);
      const Index b = root_of(cut_.next_corner(opposite));
      parents[std::max(a, b)] = std::min(a, b); // the lowest corner stands for the group, whatever the order
    }
    Index count = 0;
    const auto group_of = [this](Index corner) -> Index& { return cut_.corner_vertices[corner]; };
    for (const Index corner : corners)
      group_of(corner) = parents[corner] == corner ? count++ : group_of(root_of(corner));
    if (count > 1)
      std::sort(corners.begin(), corners.end(),
                [&](Index a, Index b) { return group_of(a) != group_of(b) ? group_of(a) < group_of(b) : a < b; });
    return count;
  }

  /// whether turning from face to face, one way, comes round to where it starts and past all corners.
  bool is_one_group(std::span<const Index> corners) const
  {
    Index corner = corners.empty() ? 0 : corners[0];
    for (std::size_t turns = 1; turns <= corners.size(); ++turns)
    {
      const Index opposite = uncut_.opposite_corners[corner];
      if (opposite == no_index || cut_.is_critical_edge[corner])
        return false;
      corner = cut_.next_corner(opposite);
      if (corner == corners[0])
        return turns == corners.size();
    }
    return false;
  }

  void mark_rims()
  {
    cut_.is_rim.assign(cut_.points.size(), 0);
    for (Index corner = 0; corner < static_cast<Index>(cut_.corner_vertices.size()); ++corner)
      if (cut_.is_critical_edge[corner] || uncut_.opposite_corners[corner] == no_index)
        cut_.is_rim[cut_.corner_vertices[corner]] = cut_.is_rim[cut_.corner_vertices[cut_.next_corner(corner)]] = 1;
    cut_.is_tip.assign(cut_.points.size(), 0);
    for (Index vertex = 0; vertex < cut_.vertex_count(); ++vertex)
      cut_.is_tip[vertex] = uncut_.is_sharp[cut_.original_vertices[vertex]] && !cut_.is_rim[vertex] ? 1 : 0;
  }

  /// Blocks of vertices at a time, each with a list of its own; then the lists become one.
  void gather_neighbors()
  {
    constexpr Index vertices_per_block = 4096;
    const Index block_count = (cut_.vertex_count() + vertices_per_block - 1) / vertices_per_block;
    std::vector<std::vector<Index>> blocks(static_cast<std::size_t>(block_count));
    cut_.neighbor_first.assign(cut_.points.size() + 1, 0);
    const auto for_blocks = [&](const auto& work) {
      tbb::parallel_for(Index(0), block_count, [&](Index block) {
        const Index first = block * vertices_per_block;
        work(blocks[static_cast<std::size_t>(block)], first, std::min(first + vertices_per_block, cut_.vertex_count()));
      });
    };
    for_blocks([this](std::vector<Index>& neighbors, Index begin, Index end) {
      for (Index vertex = begin; vertex < end; ++vertex)
      {
        const std::size_t first = neighbors.size();
        add_neighbors(vertex, neighbors);
        cut_.neighbor_first[vertex + 1] = static_cast<Index>(neighbors.size() - first);
      }
    });
    std::partial_sum(cut_.neighbor_first.begin(), cut_.neighbor_first.end(), cut_.neighbor_first.begin());
    cut_.neighbors.resize(static_cast<std::size_t>(cut_.neighbor_first.back()));
    for_blocks([this](std::vector<Index>& neighbors, Index begin, Index) {
      std::copy(neighbors.begin(), neighbors.end(), cut_.neighbors.begin() + cut_.neighbor_first[begin]);
      neighbors = {};
    });
  }

  /// appends those of `vertex`, ascending.
  void add_neighbors(Index vertex, std::vector<Index>& neighbors) const
  {
    const Index original = cut_.original_vertices[vertex];
    if (rule_ == Neighbor_rule::whole_region ? cut_.is_tip[vertex] : uncut_.is_sharp[original])
      return;
    const bool only_critical = rule_ == Neighbor_rule::along_curves && uncut_.is_critical(original);
    const std::size_t first = neighbors.size();
    for (const Index corner : cut_.corners_of_vertex(vertex))
    {
      const Index previous = cut_.previous_corner(corner);
      if (!only_critical || cut_.is_critical_edge[corner])
        neighbors.push_back(cut_.corner_vertices[cut_.next_corner(corner)]);
      if (!only_critical || cut_.is_critical_edge[previous])
        neighbors.push_back(cut_.corner_vertices[previous]);
    }
    const auto begin = neighbors.begin() + static_cast<std::ptrdiff_t>(first);
    std::sort(begin, neighbors.end());
    neighbors.erase(std::unique(begin, neighbors.end()), neighbors.end());
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

  Uncut_surface uncut_;
  Neighbor_rule rule_;
  Surface_arrays cut_;
};

template <class Graph, class NamedParameters>
Surface_arrays gather_surface(const Graph& g, const NamedParameters& params,
                              Neighbor_rule rule = Neighbor_rule::along_curves)
{
  return Surface_cutter(Graph_reader<Graph, NamedParameters>(g, params).read(), rule).cut();
}

} // namespace recurve::internal::surface

#endif
