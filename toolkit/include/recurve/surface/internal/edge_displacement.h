#ifndef RECURVE_SURFACE_INTERNAL_EDGE_DISPLACEMENT_H
#define RECURVE_SURFACE_INTERNAL_EDGE_DISPLACEMENT_H

#include <recurve/surface/internal/surface_arrays.h>
#include <recurve/surface/internal/vector_3.h>
#include <recurve/surface/vertex_fit.h>

#include <algorithm>
#include <cmath>

namespace recurve::internal::surface {

/// how far `fit` moves the middle of the straight edge from its vertex to `end`, along its normal, when it is corrected
/// linearly so as to go through `end`.
inline double middle_displacement(const Vertex_fit& fit, const Point& end)
{
  const Point local = fit.local_coordinates(end);
  return fit.height(0.5 * local[0], 0.5 * local[1]) - 0.5 * fit.height(local[0], local[1]);
}

/// the same as the normals of the two vertices tell it: that of the cubic curve across both normals. It is crude (half
/// of it may be wrong) but it never oscillates, however few the points are.
inline double estimated_displacement(const Surface_arrays& surface, Index vertex, Index neighbor)
{
  const Point way = subtract(surface.points[neighbor], surface.points[vertex]);
  return 0.125 * dot(subtract(surface.normals[neighbor], surface.normals[vertex]), way);
}

/// What the normals tell of the surface around a vertex.
struct Estimated_bend
{
  double curvature = 0;    ///< the largest along an edge
  double longest_edge = 0; ///< length

  bool is_short(double edge_length) const
  {
    constexpr double short_edge = 0.2;
    return edge_length < short_edge * longest_edge;
  }

  /// displacement of the middle of an edge that means nothing: part of that of the same bend over the edge. An edge
  /// that is short shares the absolute errors of the long ones across it; there a small part of its length counts.
  double negligible_displacement(double edge_length) const
  {
    constexpr double part = 0.3;
    constexpr double part_of_short_edge = 0.05;
    constexpr double largest_turn = 1; // radians; a round tip may bend a short edge so much that a long one would coil
    const double of_bend = part * 0.125 * std::min(curvature * longest_edge, largest_turn) * edge_length;
    return is_short(edge_length) ? std::max(of_bend, part_of_short_edge * edge_length) : of_bend;
  }
};

inline Estimated_bend estimated_bend(const Surface_arrays& surface, Index vertex)
{
  Estimated_bend bend;
  for (const Index neighbor : surface.neighbors_of(vertex))
  {
    const double edge_length = length(subtract(surface.points[neighbor], surface.points[vertex]));
    if (!(edge_length > 0))
      continue;
    const double curvature =
      8 * std::abs(estimated_displacement(surface, vertex, neighbor)) / edge_length / edge_length;
    bend.curvature = std::max(bend.curvature, curvature);
    bend.longest_edge = std::max(bend.longest_edge, edge_length);
  }
  return bend;
}

} // namespace recurve::internal::surface

#endif
