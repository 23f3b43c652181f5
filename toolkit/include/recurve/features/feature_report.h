#ifndef RECURVE_FEATURES_FEATURE_REPORT_H
#define RECURVE_FEATURES_FEATURE_REPORT_H

#include <recurve/core/types.h>

#include <array>
#include <string_view>
#include <vector>

namespace recurve {

/// What stands at an end of a feature curve.
enum class Curve_end
{
  none,     ///< the curve is closed
  corner,   ///< a sharp vertex
  terminus, ///< the curve fades out in the surface
};

/// Why a candidate curve is not a feature.
enum class Rejection
{
  dangling,     ///< an end fades out or is doubtful in the surface, and the curve has too few strong edges
  doubtful,     ///< both ends are doubtful, and the curve has too few strong edges
  overshadowed, ///< a weak curve, doubtful at an end, between two sharp features: noise beside them
  smooth,       ///< the surface bends as much beside the curve, or around its ends: a coarse mesh of a smooth surface
  rough,        ///< one of a small network beside which the surface bends as along it, or back: a rough surface
};
inline constexpr int number_of_rejections = 5;

/// A feature curve in a `Feature_report`. Vertices count in the order of `vertices(g)`.
struct Feature_curve_summary
{
  Index first_vertex = no_index; ///< of a closed curve: the smallest of its vertices
  Index last_vertex = no_index;
  Point first_point{}, last_point{};
  Index edges = 0;
  double length = 0;       ///< sum of the edges' lengths, in the unit of the points
  double max_dihedral = 0; ///< largest dihedral angle, in degrees; 180 on a border
  bool is_closed = false;
  bool is_pinned = false; ///< consists of border or constrained edges
  Curve_end first_end = Curve_end::none, last_end = Curve_end::none;
};

/// A candidate curve that was rejected. Vertices count in the order of `vertices(g)`.
struct Rejected_curve
{
  Rejection reason{};
  bool is_closed = false;
  Index first_vertex = no_index, last_vertex = no_index;
  Point first_point{}, last_point{};
  Index edges = 0;
  double length = 0;       ///< in the unit of the points
  double max_dihedral = 0; ///< in degrees
};

/// What `detect_features()` found.
struct Feature_report
{
  Index edges = 0;
  Index pinned_edges = 0;    ///< border and constrained edges
  Index weak_edges = 0;      ///< with a dihedral angle above `Feature_options::weak_angle`, pinned ones not counted
  Index sharp_edges = 0;     ///< above `Feature_options::sharp_angle`, pinned ones not counted
  Index candidate_edges = 0; ///< strong enough in their surroundings, before curves were rejected
  Index critical_edges = 0;  ///< the result, pinned ones included
  Index sharp_vertices = 0;
  Index isolated_corners = 0; ///< sharp vertices without a critical edge, such as the tip of a cone
  Index sweeps = 0;           ///< of rejection, until nothing was rejected any more
  std::vector<Feature_curve_summary> curves;
  std::vector<Rejected_curve> rejected;
  std::array<Index, number_of_rejections> rejected_edges{}; ///< edges of `rejected`, by `Rejection`

  /// appends what was found on another part of a surface.
  Feature_report& operator+=(const Feature_report& other)
  {
    edges += other.edges;
    pinned_edges += other.pinned_edges;
    weak_edges += other.weak_edges;
    sharp_edges += other.sharp_edges;
    candidate_edges += other.candidate_edges;
    critical_edges += other.critical_edges;
    sharp_vertices += other.sharp_vertices;
    isolated_corners += other.isolated_corners;
    sweeps = sweeps > other.sweeps ? sweeps : other.sweeps;
    curves.insert(curves.end(), other.curves.begin(), other.curves.end());
    rejected.insert(rejected.end(), other.rejected.begin(), other.rejected.end());
    for (int i = 0; i < number_of_rejections; ++i)
      rejected_edges[i] += other.rejected_edges[i];
    return *this;
  }
};

/// the word of a report for `end`.
constexpr std::string_view to_string(Curve_end end)
{
  constexpr std::string_view words[] = {"none", "corner", "terminus"};
  return words[static_cast<int>(end)];
}

/// the word of a report for `reason`.
constexpr std::string_view to_string(Rejection reason)
{
  constexpr std::string_view words[] = {"dangling", "doubtful", "overshadowed", "smooth", "rough"};
  return words[static_cast<int>(reason)];
}

} // namespace recurve

#endif
