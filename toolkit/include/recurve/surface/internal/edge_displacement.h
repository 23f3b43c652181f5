#ifndef RECURVE_SURFACE_INTERNAL_EDGE_DISPLACEMENT_H
#define RECURVE_SURFACE_INTERNAL_EDGE_DISPLACEMENT_H

#include <recurve/surface/internal/number_pair.h>
#include <recurve/surface/internal/surface_arrays.h>
#include <recurve/surface/internal/vector_3.h>
#include <recurve/surface/local_fit.h>
#include <recurve/surface/vertex_fit.h>

#include <algorithm>
#include <cmath>

namespace recurve::internal::surface {

/// Vertex_fit::height_in_rows() at two places at a time.
inline Number_pair heights_at(const Vertex_fit& fit, const Number_pair& s, const Number_pair& t)
{
  const double* const coefficients = fit.coefficients.data();
  Number_pair sum = {};
  for (int j = fit.degree; j >= 0; --j)
  {
    Number_pair row = {};
    // coefficient_number(j, k) - coefficient_number(j, k - 1) = j + k + 1
    for (int power = fit.degree, i = coefficient_number(j, fit.degree - j); power >= j; i -= power + 1, --power)
      row = row * t + coefficients[i];
    sum = sum * s + row;
  }
  return fit.size * sum;
}

/// how far `fit` moves the middle of the straight edge from its vertex to `end`, along the normal of its vertex, when
/// corrected linearly so as to go through `end`.
inline double middle_displacement(const Vertex_fit& fit, const Point& end)
{
  const Point local = fit.local_coordinates(end);
  const double factor = dot(fit.n, fit.vertex_normal);
  if (!fit.rows.are_straight())
    return factor * (fit.height(0.5 * local[0], 0.5 * local[1]) - 0.5 * fit.height(local[0], local[1]));
  const Number_pair heights =
    heights_at(fit, Number_pair{0.5 * local[0], local[0]}, Number_pair{0.5 * local[1], local[1]});
  return factor * (heights[0] - 0.5 * heights[1]);
}

/// the same as the normals of the two vertices tell it: that of the cubic curve across both normals. It is crude (half
/// of it may be wrong) but it never oscillates, however few the points are.
inline double estimated_displacement(const Surface_arrays& surface, Index vertex, Index neighbor)
{
  const Point way = subtract(surface.points[neighbor], surface.points[vertex]);
  return 0.125 * dot(subtract(surface.normals[neighbor], surface.normals[vertex]), way);
}

/// what the normals of the vertices across bent rows from `vertex` tell of the surface there: how far it falls per
/// square of the distance across, in the unit of `frame`.
inline double estimated_fall_across_rows(const Surface_arrays& surface, Index vertex, const Vertex_fit& frame)
{
  constexpr double straight_across = 0.3; // way along the row, over that across
  double sum = 0, weight = 0;
  for (const Index neighbor : surface.neighbors_of(vertex))
  {
    const Point place = frame.row_coordinates(surface.points[neighbor]);
    const double square = place[1] * place[1];
    if (place[0] * place[0] > straight_across * straight_across * square)
      continue;
    sum += 4 * square * estimated_displacement(surface, vertex, neighbor);
    weight += square * square;
  }
  return weight > 0 ? sum / weight : 0;
}

/// What the normals tell of the surface around a vertex.
struct Estimated_bend
{
  double largest = 0;           ///< displacement of the middle of an edge
  double length_of_largest = 0; ///< length of that edge
  double longest_edge = 0;      ///< length
  double fall_across_rows = 0;  ///< see above; 0 where rows are not bent

  /// of the middle of the edge from `vertex`, that of this estimate. Where rows bend, the middle of the edge lies
  /// beside its row, to which the cubic curve belongs, and the surface falls on the way there.
  double displacement(const Surface_arrays& surface, const Vertex_fit& frame, Index vertex, Index neighbor) const
  {
    const double of_row = estimated_displacement(surface, vertex, neighbor);
    if (frame.rows.are_straight())
      return of_row;
    const Point local = frame.local_coordinates(surface.points[neighbor]);
    const Point middle = {0.5 * local[0], 0.5 * local[1], 0.5 * local[2]};
    const double aside = frame.rows.place(middle)[1] - 0.5 * frame.rows.place(local)[1];
    return of_row - fall_across_rows * aside * aside;
  }

  bool is_short(double edge_length) const
  {
    constexpr double short_edge = 0.2;
    return edge_length < short_edge * longest_edge;
  }

  /// displacement of the middle of an edge that means nothing: part of the largest around, which a face at the vertex
  /// is likely to have too; on shorter edges as much less. An edge that is short shares the absolute errors of the long
  /// ones across it; there a small part of its length counts.
  double negligible_displacement(double edge_length) const
  {
    constexpr double part = 0.3;
    constexpr double part_of_short_edge = 0.05;
    const double of_bend = part * largest * (edge_length < length_of_largest ? edge_length / length_of_largest : 1);
    return is_short(edge_length) ? std::max(of_bend, part_of_short_edge * edge_length) : of_bend;
  }
};

/// \param frame  of a fit of `vertex`.
inline Estimated_bend estimated_bend(const Surface_arrays& surface, Index vertex, const Vertex_fit& frame)
{
  Estimated_bend bend;
  if (!frame.rows.are_straight())
    bend.fall_across_rows = estimated_fall_across_rows(surface, vertex, frame);
  for (const Index neighbor : surface.neighbors_of(vertex))
  {
    const double edge_length = length(subtract(surface.points[neighbor], surface.points[vertex]));
    const double displacement = std::abs(bend.displacement(surface, frame, vertex, neighbor));
    if (displacement > bend.largest)
    {
      bend.largest = displacement;
      bend.length_of_largest = edge_length;
    }
    bend.longest_edge = std::max(bend.longest_edge, edge_length);
  }
  return bend;
}

} // namespace recurve::internal::surface

#endif
