#ifndef RECURVE_FEATURES_INTERNAL_CLASSIFY_EDGES_H
#define RECURVE_FEATURES_INTERNAL_CLASSIFY_EDGES_H

#include <recurve/features/feature_options.h>
#include <recurve/features/internal/surface_angles.h>
#include <recurve/features/internal/symmetric_eigen.h>

#include <cstdint>
#include <vector>

namespace recurve::internal::features {

/// Angles closer than this (in degrees) count as equal, so that round-off does not choose between equals: on the
/// edges of a regular mesh, and at round thresholds that regular shapes meet exactly (a nonagon turns by 40 degrees).
inline constexpr double angle_tie = 6e-6;

/// What the normals around a vertex look like.
enum class Vertex_shape : std::uint8_t
{
  none, ///< not looked at: no weak edge
  corner,
  flat,
  ridge,
  ambiguous
};

/// Bits of `Edge_classes::strength`.
enum Strength : std::uint8_t
{
  largest_dihedral = 1,  ///< no weak edge on the same side of the vertex has a larger dihedral angle
  along_ridge = 2,       ///< of all weak edges the one closest to the ridge direction, on either side
  attached = 4,          ///< may belong to a curve through the vertex
  strongly_attached = 8, ///< and gives the vertex its own right to be on a curve
};

/// The ranks of edges and vertices, before any curve is assembled.
struct Edge_classes
{
  std::vector<char> is_sharp_corner;      ///< per vertex, by its angle defect
  std::vector<char> has_sharp_edge;       ///< per vertex, pinned edges not counted
  std::vector<char> has_acute_edge;       ///< per vertex, pinned edges not counted
  std::vector<Vertex_shape> shape;        ///< per vertex
  std::vector<std::uint8_t> strength;     ///< per half-edge, at its source
  std::vector<std::int32_t> strong_count; ///< per vertex: its strongly attached half-edges
  std::vector<char> is_candidate;         ///< per edge
  Index weak_edges = 0, sharp_edges = 0;
};

/// the vertices with |angle defect| of at least the option; a border vertex has none: its defect measures the border.
inline std::vector<char> find_sharp_corners(const Surface_angles& a, const Feature_options& options)
{
  std::vector<char> is_corner(a.defect.size(), 0);
  for (std::size_t v = 0; v < is_corner.size(); ++v)
    is_corner[v] =
      !a.is_border_vertex[v] && a.defect[v] < 360 && std::abs(a.defect[v]) > options.corner_defect + angle_tie;
  return is_corner;
}

/// Ranks the weak half-edges around one vertex after the other.
class Edge_classifier
{
public:
  Edge_classifier(const Flat_surface& s, const Surface_angles& a, const Feature_options& options)
    : s_(s), a_(a), options_(options), weak_(s, [&](Index e) { return is_weak(e); })
  {}

  Edge_classes run()
  {
    rank_edges();
    accumulate_tensors();
    const Index nv = s_.number_of_vertices();
    result_.shape.assign(nv, Vertex_shape::none);
    result_.strength.assign(2 * s_.number_of_edges(), 0);
    result_.strong_count.assign(nv, 0);
    for (Index v = 0; v < nv; ++v)
      if (weak_[v].size() > 0)
        rank_vertex(v);
    select_candidates();
    return std::move(result_);
  }

private:
  /// "f-strong" in the literature: above the lowest threshold, so that it takes part at all.
  bool is_weak(Index e) const
  {
    return !a_.is_pinned[e] && a_.dihedral[e] > options_.weak_angle &&
           (a_.is_told_smooth.empty() || !a_.is_told_smooth[e]);
  }
  bool is_sharp(Index e) const { return !a_.is_pinned[e] && a_.dihedral[e] > options_.sharp_angle; }

  void rank_edges()
  {
    result_.is_sharp_corner = find_sharp_corners(a_, options_);
    result_.has_sharp_edge.assign(s_.number_of_vertices(), 0);
    result_.has_acute_edge.assign(s_.number_of_vertices(), 0);
    for (Index e = 0; e < s_.number_of_edges(); ++e)
    {
      if (!is_weak(e))
        continue;
      ++result_.weak_edges;
      result_.sharp_edges += is_sharp(e);
      for (const Index v : {s_.target[2 * e], s_.target[2 * e + 1]})
      {
        result_.has_sharp_edge[v] |= static_cast<char>(is_sharp(e));
        result_.has_acute_edge[v] |= static_cast<char>(a_.dihedral[e] > options_.acute_angle);
      }
    }
  }

  /// sums angle * normal * normal^T over the faces around each vertex with weak edges. Angle weights, not areas: the
  /// sum must not depend on how quadrangles are split.
  void accumulate_tensors()
  {
    tensor_of_.assign(s_.number_of_vertices(), no_index);
    Index n = 0;
    for (Index v = 0; v < s_.number_of_vertices(); ++v)
      if (weak_[v].size() > 0)
        tensor_of_[v] = n++;
    tensors_.assign(n, {});
    for (Index f = 0; f < s_.number_of_faces(); ++f)
    {
      const Vector& m = a_.normal[f];
      Index h = s_.face_halfedge[f];
      do
      {
        if (const Index i = tensor_of_[s_.source_of(h)]; i != no_index)
        {
          const double w = a_.corner[h];
          Symmetric_matrix& t = tensors_[i];
          t[0] += w * m[0] * m[0], t[1] += w * m[0] * m[1], t[2] += w * m[0] * m[2];
          t[3] += w * m[1] * m[1], t[4] += w * m[1] * m[2], t[5] += w * m[2] * m[2];
        }
        h = s_.next[h];
      } while (h != s_.face_halfedge[f]);
    }
  }

  Vertex_shape shape_of(Index v, const Symmetric_eigen& e) const
  {
    // on a straight ridge of dihedral angle theta the ratio of the two large eigenvalues is tan^2(theta / 2)
    const double tangent = std::tan(options_.weak_angle / 2 / degrees_per_radian);
    if (result_.is_sharp_corner[v])
      return Vertex_shape::corner;
    if (e.values[1] < tangent * tangent * e.values[0])
      return Vertex_shape::flat;
    return e.values[2] <= options_.ridge_ratio * e.values[1] ? Vertex_shape::ridge : Vertex_shape::ambiguous;
  }

  void rank_vertex(Index v)
  {
    const Symmetric_eigen e = eigen(tensors_[tensor_of_[v]]);
    result_.shape[v] = shape_of(v, e);
    mark_local_strength(v, e.smallest);
    const bool is_free = result_.is_sharp_corner[v] || result_.shape[v] == Vertex_shape::ambiguous;
    for (const Index h : weak_[v])
    {
      std::uint8_t& strength = result_.strength[h];
      const bool is_largest = strength & largest_dihedral, is_along = strength & along_ridge;
      if (is_largest || is_along || result_.has_sharp_edge[v] || is_free)
        strength |= attached;
      if ((is_largest && is_along) || is_sharp(h / 2) || is_free)
      {
        strength |= strongly_attached;
        ++result_.strong_count[v];
      }
    }
  }

  /// compares the weak half-edges at `v` with each other: their dihedral angles among those on the same side of the
  /// plane across the ridge, and their deviation from the ridge. The sign of `ridge` does not matter.
  void mark_local_strength(Index v, const Vector& ridge)
  {
    // an edge in the plane across the ridge is on both sides, lest round-off put it on one
    constexpr double in_between = 1e-7;
    double largest[2] = {0, 0};
    double least_deviation = 180, most_deviation = 0;
    deviation_.clear();
    for (const Index h : weak_[v])
    {
      const double deviation = angle_between(direction(s_, h), ridge);
      deviation_.push_back(deviation);
      least_deviation = std::min(least_deviation, deviation);
      most_deviation = std::max(most_deviation, deviation);
      const double dihedral = a_.dihedral[h / 2];
      if (deviation < 90 + in_between)
        largest[0] = std::max(largest[0], dihedral);
      if (deviation > 90 - in_between)
        largest[1] = std::max(largest[1], dihedral);
    }
    for (Index i = 0; const Index h : weak_[v])
    {
      const double deviation = deviation_[i++], dihedral = a_.dihedral[h / 2] + angle_tie;
      const bool is_largest = (deviation >= 90 + in_between || dihedral >= largest[0]) &&
                              (deviation <= 90 - in_between || dihedral >= largest[1]);
      const bool is_along = (deviation <= least_deviation + angle_tie && deviation < options_.ridge_deviation) ||
                            (deviation >= most_deviation - angle_tie && deviation > 180 - options_.ridge_deviation);
      result_.strength[h] =
        static_cast<std::uint8_t>((is_largest ? largest_dihedral : 0) | (is_along ? along_ridge : 0));
    }
  }

  /// a half-edge is quasi-strong if it is attached and both its vertices have a right of their own to be on a curve, or
  /// if it is the stem of a T whose bar runs through its source.
  bool is_quasi_strong(Index h) const
  {
    const Index v = s_.source_of(h), w = s_.target[h];
    if ((result_.strength[h] & attached) && result_.strong_count[v] > 0 && result_.strong_count[w] > 0)
      return true;
    constexpr std::uint8_t both = largest_dihedral | along_ridge;
    return result_.strong_count[v] == 2 && result_.strong_count[w] == 2 && (result_.strength[h ^ 1] & both) == both;
  }

  /// needs both half-edges: if each is missed with probability p and false with q, an edge is missed with about p^2
  /// and false with about q^4.
  void select_candidates()
  {
    result_.is_candidate.assign(s_.number_of_edges(), 0);
    for (Index e = 0; e < s_.number_of_edges(); ++e)
      result_.is_candidate[e] = is_weak(e) && is_quasi_strong(2 * e) && is_quasi_strong(2 * e + 1);
  }

  const Flat_surface& s_;
  const Surface_angles& a_;
  const Feature_options& options_;
  Out_halfedges weak_;
  std::vector<Index> tensor_of_;
  std::vector<Symmetric_matrix> tensors_;
  std::vector<double> deviation_;
  Edge_classes result_;
};

} // namespace recurve::internal::features

#endif
