#ifndef RECURVE_MESH_INTERNAL_STRAIGHT_ELEMENT_H
#define RECURVE_MESH_INTERNAL_STRAIGHT_ELEMENT_H

#include <recurve/core/types.h>
#include <recurve/elements/element.h>

#include <array>
#include <span>

namespace recurve::internal {

/// How a face is seen from its canonical side: corner c of the canonical face is corner (first + c) mod n, or
/// (first - c) mod n if reversed, of the face at hand. Every element that has the face finds the same canonical face.
struct Canonical_face
{
  int first = 0;
  bool is_reversed = false;

  int corner(int c, int corner_count) const
  {
    return (is_reversed ? first - c + corner_count : first + c) % corner_count;
  }
};

/// the way around a face that reads the smallest sequence of vertices.
inline Canonical_face canonical_face(const std::array<Index, 4>& vertices, int corner_count)
{
  Canonical_face best;
  const auto is_smaller = [&](const Canonical_face& a, const Canonical_face& b) {
    for (int c = 0; c < corner_count; ++c)
      if (const Index x = vertices[a.corner(c, corner_count)], y = vertices[b.corner(c, corner_count)]; x != y)
        return x < y;
    return false;
  };
  for (int first = 0; first < corner_count; ++first)
    for (const bool is_reversed : {false, true})
      if (const Canonical_face way{first, is_reversed}; is_smaller(way, best))
        best = way;
  return best;
}

/// node `k` (0 < k < degree) of the straight edge from a to b. Exactly symmetric: swapping the ends gives the same
/// bits; and a coordinate that both ends share is exactly theirs, so that planes along the axes stay planes.
inline Point straight_edge_node(const Point& a, const Point& b, int k, int degree)
{
  Point x;
  for (int axis = 0; axis < 3; ++axis)
    if (2 * k == degree)
      x[axis] = 0.5 * (a[axis] + b[axis]);
    else if (2 * k < degree)
      x[axis] = a[axis] + double(k) / degree * (b[axis] - a[axis]);
    else
      x[axis] = b[axis] + double(degree - k) / degree * (a[axis] - b[axis]);
  return x;
}

/// node at lattice position (i, j) of a face with canonical corners: the triangle is affine, the quadrangle bilinear.
inline Point straight_face_node(const std::array<Point, 4>& corners, int corner_count, int i, int j, int degree)
{
  const double u = double(i) / degree, v = double(j) / degree;
  const Point& a = corners[0];
  const Point& last = corners[corner_count - 1];
  Point x;
  for (int axis = 0; axis < 3; ++axis)
  {
    x[axis] = a[axis] + (u * (corners[1][axis] - a[axis]) + v * (last[axis] - a[axis]));
    if (corner_count == 4)
      x[axis] += u * v * ((corners[2][axis] - corners[1][axis]) - (last[axis] - a[axis]));
  }
  return x;
}

/// per node inside the cell, the weight of each corner.
std::span<const std::array<double, 8>> interior_weights(Element_type type, int degree);

/// the node that has the given weights. Written as a motion from corner 0, so that a coordinate that all corners share
/// is exactly theirs.
inline Point straight_interior_node(std::span<const Point> corners, const std::array<double, 8>& weights)
{
  Point x = corners[0];
  for (int axis = 0; axis < 3; ++axis)
  {
    double motion = 0;
    for (std::size_t c = 1; c < corners.size(); ++c)
      motion += weights[c] * (corners[c][axis] - corners[0][axis]);
    x[axis] += motion;
  }
  return x;
}

} // namespace recurve::internal

#endif
