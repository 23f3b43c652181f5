#include "planar_regions.h"

#include <recurve/elements/node_layout.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

namespace recurve {

namespace {

Point difference(const Point& a, const Point& b)
{
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

double dot(const Point& a, const Point& b)
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// An edge of a face, named by its ends.
struct Face_edge
{
  Index low, high, face;

  bool has_ends_of(const Face_edge& other) const { return low == other.low && high == other.high; }
  friend bool operator<(const Face_edge& a, const Face_edge& b)
  {
    return std::tie(a.low, a.high, a.face) < std::tie(b.low, b.high, b.face);
  }
};

std::vector<Face_edge> sorted_edges(std::span<const Boundary_element> faces, std::span<const Index> chosen)
{
  std::vector<Face_edge> edges;
  for (const Index f : chosen)
  {
    const Boundary_element& face = faces[static_cast<std::size_t>(f)];
    const int n = corner_count(face.type);
    for (int c = 0; c < n; ++c)
    {
      const Index a = face.nodes[static_cast<std::size_t>(c)], b = face.nodes[static_cast<std::size_t>((c + 1) % n)];
      edges.push_back({std::min(a, b), std::max(a, b), f});
    }
  }
  std::sort(edges.begin(), edges.end());
  return edges;
}

/// Grows regions face by face from the largest one.
class Region_search
{
public:
  Region_search(std::span<const Boundary_element> faces, std::span<const Point> points)
    : faces_(faces), points_(points), is_taken_(faces.size(), 0)
  {
    list_neighbors();
  }

  std::vector<Planar_region> regions()
  {
    std::vector<Point> normals;
    std::vector<double> areas;
    for (const Boundary_element& face : faces_)
    {
      normals.push_back(vector_area(face));
      areas.push_back(std::hypot(normals.back()[0], normals.back()[1], normals.back()[2]));
    }
    // The normal of a large face is the most exact.
    std::vector<Index> order(faces_.size());
    std::iota(order.begin(), order.end(), Index{0});
    std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) {
      return areas[static_cast<std::size_t>(a)] > areas[static_cast<std::size_t>(b)];
    });
    std::vector<Planar_region> result;
    for (const Index seed : order)
    {
      const auto s = static_cast<std::size_t>(seed);
      if (is_taken_[s] || areas[s] == 0)
        continue;
      const Point n = {normals[s][0] / areas[s], normals[s][1] / areas[s], normals[s][2] / areas[s]};
      if (is_in_plane(faces_[s], {{seed}, n, -1}))
        result.push_back(grow(seed, n));
    }
    return result;
  }

private:
  void list_neighbors()
  {
    std::vector<Index> all(faces_.size());
    std::iota(all.begin(), all.end(), Index{0});
    const std::vector<Face_edge> edges = sorted_edges(faces_, all);
    const auto for_each_pair = [&](const auto& visit) {
      for (std::size_t first = 0, last = 0; first < edges.size(); first = last)
      {
        while (last < edges.size() && edges[last].has_ends_of(edges[first]))
          ++last;
        for (std::size_t m = first + 1; m < last; ++m)
          visit(edges[m - 1].face, edges[m].face);
      }
    };
    first_neighbor_.assign(faces_.size() + 1, 0);
    for_each_pair([&](Index a, Index b) {
      ++first_neighbor_[static_cast<std::size_t>(a) + 1];
      ++first_neighbor_[static_cast<std::size_t>(b) + 1];
    });
    std::partial_sum(first_neighbor_.begin(), first_neighbor_.end(), first_neighbor_.begin());
    neighbors_.resize(static_cast<std::size_t>(first_neighbor_.back()));
    std::vector<Index> next(first_neighbor_.begin(), first_neighbor_.end() - 1);
    for_each_pair([&](Index a, Index b) {
      neighbors_[static_cast<std::size_t>(next[static_cast<std::size_t>(a)]++)] = b;
      neighbors_[static_cast<std::size_t>(next[static_cast<std::size_t>(b)]++)] = a;
    });
  }

  const Point& corner(const Boundary_element& face, int c) const
  {
    return points_[static_cast<std::size_t>(face.nodes[static_cast<std::size_t>(c)])];
  }

  /// half the cross product of the diagonals.
  Point vector_area(const Boundary_element& face) const
  {
    // A triangle is a quadrangle whose last two corners are one.
    const int last = corner_count(face.type) - 1;
    const Point u = difference(corner(face, 2), corner(face, 0)), v = difference(corner(face, last), corner(face, 1));
    return {(u[1] * v[2] - u[2] * v[1]) / 2, (u[2] * v[0] - u[0] * v[2]) / 2, (u[0] * v[1] - u[1] * v[0]) / 2};
  }

  bool is_in_plane(const Boundary_element& face, const Planar_region& region) const
  {
    // An angle far below that of any facet of a curved surface, and far above what rounding does to a plane.
    constexpr double tolerance = 1e-7;
    constexpr double rounding = 8 * std::numeric_limits<double>::epsilon();

    const Point& origin = corner(faces_[static_cast<std::size_t>(region.faces.front())], 0);
    for (int c = 0; c < corner_count(face.type); ++c)
    {
      const Point& point = corner(face, c);
      const Point way = difference(point, origin);
      const double size = std::max({std::abs(point[0]), std::abs(point[1]), std::abs(point[2])});
      if (std::abs(dot(way, region.normal)) > tolerance * std::hypot(way[0], way[1], way[2]) + rounding * size)
        return false;
    }
    return true;
  }

  Planar_region grow(Index seed, const Point& normal)
  {
    Planar_region region{{seed}, normal, -1};
    is_taken_[static_cast<std::size_t>(seed)] = 1;
    for (std::size_t m = 0; m < region.faces.size(); ++m)
    {
      const auto f = static_cast<std::size_t>(region.faces[m]);
      for (Index n = first_neighbor_[f]; n < first_neighbor_[f + 1]; ++n)
      {
        const auto neighbor = static_cast<std::size_t>(neighbors_[static_cast<std::size_t>(n)]);
        if (is_taken_[neighbor] || !is_in_plane(faces_[neighbor], region))
          continue;
        is_taken_[neighbor] = 1;
        region.faces.push_back(static_cast<Index>(neighbor));
      }
    }
    find_axis(region);
    std::sort(region.faces.begin(), region.faces.end());
    return region;
  }

  void find_axis(Planar_region& region) const
  {
    const Point& origin = corner(faces_[static_cast<std::size_t>(region.faces.front())], 0);
    std::array<bool, 3> is_shared = {true, true, true};
    for (const Index f : region.faces)
      for (int c = 0; c < corner_count(faces_[static_cast<std::size_t>(f)].type); ++c)
        for (std::size_t d = 0; d < 3; ++d)
          is_shared[d] = is_shared[d] && corner(faces_[static_cast<std::size_t>(f)], c)[d] == origin[d];
    for (int d = 0; d < 3; ++d)
      if (is_shared[static_cast<std::size_t>(d)])
        region.axis = d;
  }

  std::span<const Boundary_element> faces_;
  std::span<const Point> points_;
  std::vector<char> is_taken_;
  std::vector<Index> first_neighbor_, neighbors_; ///< of face f: neighbors_[first_neighbor_[f] ..]
};

} // namespace

std::vector<Planar_region> find_planar_regions(std::span<const Boundary_element> faces, std::span<const Point> points)
{
  return Region_search(faces, points).regions();
}

Point along_plane(const Planar_region& region, const Point& vector)
{
  const double out = dot(vector, region.normal);
  Point result;
  for (std::size_t d = 0; d < 3; ++d)
    result[d] = vector[d] - out * region.normal[d];
  if (region.axis >= 0)
  {
    result = vector;
    result[static_cast<std::size_t>(region.axis)] = 0;
  }
  return result;
}

Region_nodes nodes_of(const Planar_region& region, std::span<const Boundary_element> faces, int degree)
{
  Region_nodes nodes;
  std::vector<Index> all;
  for (const Index f : region.faces)
  {
    const auto& face = faces[static_cast<std::size_t>(f)].nodes;
    all.insert(all.end(), face.begin(), face.end());
  }
  const std::vector<Face_edge> edges = sorted_edges(faces, region.faces);
  for (std::size_t first = 0, last = 0; first < edges.size(); first = last)
  {
    while (last < edges.size() && edges[last].has_ends_of(edges[first]))
      ++last;
    if (last - first > 1)
      continue;
    const Boundary_element& face = faces[static_cast<std::size_t>(edges[first].face)];
    const Reference_element& reference = reference_element(face.type);
    for (int e = 0; e < reference.edge_count; ++e)
    {
      const auto& ends = reference.edges[static_cast<std::size_t>(e)];
      const Index a = face.nodes[static_cast<std::size_t>(ends[0])], b = face.nodes[static_cast<std::size_t>(ends[1])];
      if (std::min(a, b) == edges[first].low && std::max(a, b) == edges[first].high)
        for (const int m : edge_nodes(face.type, degree, e))
          nodes.rim.push_back(face.nodes[static_cast<std::size_t>(m)]);
    }
  }
  for (std::vector<Index>* list : {&all, &nodes.rim})
  {
    std::sort(list->begin(), list->end());
    list->erase(std::unique(list->begin(), list->end()), list->end());
  }
  std::set_difference(all.begin(), all.end(), nodes.rim.begin(), nodes.rim.end(), std::back_inserter(nodes.inside));
  return nodes;
}

} // namespace recurve
