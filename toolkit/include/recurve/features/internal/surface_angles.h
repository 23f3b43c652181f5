#ifndef RECURVE_FEATURES_INTERNAL_SURFACE_ANGLES_H
#define RECURVE_FEATURES_INTERNAL_SURFACE_ANGLES_H

#include <recurve/features/internal/flat_surface.h>
#include <recurve/features/internal/vector_3.h>

#include <vector>

namespace recurve::internal::features {

/// The angles of a surface in degrees, and which of its edges are pinned.
struct Surface_angles
{
  std::vector<char> is_pinned;        ///< per edge: border or constrained
  std::vector<char> is_told_smooth;   ///< per edge: no feature, whatever its angle; empty: none
  std::vector<char> is_border_vertex; ///< per vertex: on a border edge
  std::vector<char> is_pinned_vertex; ///< per vertex: on a pinned edge
  std::vector<Vector> normal;         ///< per face, of length 1; zero for a face without area
  std::vector<double> dihedral;       ///< per edge, in [0, 180]; 180 on a border
  std::vector<double> corner;         ///< per half-edge: the angle of its face at its source; 0 on a border
  std::vector<double> defect;         ///< per vertex: 360 less the sum of its corners
};

/// the unit normal of the face `f` by Newell's method, about its first corner so that a far origin costs no digits.
inline Vector newell_normal(const Flat_surface& s, Index f)
{
  const Index first = s.face_halfedge[f];
  const Point& origin = s.points[s.source_of(first)];
  Vector sum{};
  for (Index h = s.next[first]; h != first; h = s.next[h])
    sum = sum + cross(s.points[s.source_of(h)] - origin, s.points[s.target[h]] - origin);
  return normalized(sum);
}

/// the direction of the half-edge `h`, of length 1.
inline Vector direction(const Flat_surface& s, Index h)
{
  return normalized(s.points[s.target[h]] - s.points[s.source_of(h)]);
}

/// computes all angles of `s`; edges in `constrained` (per edge, may be empty) are pinned besides the borders.
inline Surface_angles measure_angles(const Flat_surface& s, const std::vector<char>& constrained)
{
  Surface_angles a;
  const Index nv = s.number_of_vertices(), ne = s.number_of_edges(), nf = s.number_of_faces();
  a.normal.resize(nf);
  a.corner.assign(2 * ne, 0);
  a.defect.assign(nv, 360);
  for (Index f = 0; f < nf; ++f)
  {
    a.normal[f] = newell_normal(s, f);
    Index h = s.face_halfedge[f];
    do
    {
      const Index following = s.next[h];
      const Point& p = s.points[s.target[h]];
      a.corner[following] = angle_between(s.points[s.source_of(h)] - p, s.points[s.target[following]] - p);
      a.defect[s.target[h]] -= a.corner[following];
      h = following;
    } while (h != s.face_halfedge[f]);
  }
  a.is_pinned.assign(ne, 0);
  a.is_border_vertex.assign(nv, 0);
  a.is_pinned_vertex.assign(nv, 0);
  a.dihedral.resize(ne);
  for (Index e = 0; e < ne; ++e)
  {
    const bool is_border = s.is_border_edge(e);
    a.is_pinned[e] = is_border || (!constrained.empty() && constrained[e]);
    a.dihedral[e] = is_border ? 180 : angle_between(a.normal[s.face[2 * e]], a.normal[s.face[2 * e + 1]]);
    for (const Index v : {s.target[2 * e], s.target[2 * e + 1]})
    {
      a.is_border_vertex[v] |= static_cast<char>(is_border);
      a.is_pinned_vertex[v] |= a.is_pinned[e];
    }
  }
  return a;
}

} // namespace recurve::internal::features

#endif
