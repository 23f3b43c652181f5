#ifndef RECURVE_FEATURES_FEATURE_EDIT_H
#define RECURVE_FEATURES_FEATURE_EDIT_H

#include <recurve/core/exceptions.h>
#include <recurve/core/types.h>
#include <recurve/features/feature_report.h>

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace recurve {

/// How a `Feature_edit` finds what it changes.
enum class Feature_edit_kind
{
  edges,         ///< single edges, by their ends
  shortest_path, ///< the edges of the shortest way along edges from each way point to the next
  crease_path,   ///< the same for the way that keeps to creases and turns least
  chain,         ///< an edge and what continues it at both ends, until the dihedral angle drops
  box,           ///< the edges in a box
  patches,       ///< the edges between two patches
  vertices       ///< single vertices
};

/// A vertex of a surface as the user names it.
struct Vertex_name
{
  Point position{}; ///< of the vertex, to the last bit or to `Feature_edit_options::tolerance`; counts if `numbers` is
                    ///< empty
  Index copy = no_index; ///< which one, where several vertices have this position, in the order of `vertices(g)`;
                         ///< no_index: all of them
  std::vector<Index> numbers{}; ///< the vertices that are meant, in the order of `vertices(g)`
};

/// One change to the features of a surface.
struct Feature_edit
{
  Feature_edit_kind kind = Feature_edit_kind::edges;

  /// whether edges become critical (vertices sharp) or cease to be.
  bool is_added = true;

  /// `edges`: both ends of each, one edge after the other. Paths: the way points. `chain`: the ends of the edge that it
  /// grows from. `vertices`: themselves.
  std::vector<Vertex_name> vertices{};

  /// `box`: its corners; an edge is in it if both its ends are, or on its sides.
  Point smallest{}, largest{};

  /// `patches`: values of `face_patch_map`; twice the same: the edges inside this patch. no_index as the second one:
  /// any other patch, and the border.
  std::array<Index, 2> patches{no_index, no_index};

  /// in degrees. `chain`: it ends where the dihedral angle is smaller (default: `Feature_edit_options::chain_angle` for
  /// one that is added, 0 for one that is removed). `box` and `patches`: edges with a smaller dihedral angle are not
  /// added (default: `chain_angle` in a box, 0 between patches), edges with a larger one not removed (default: 180).
  std::optional<double> angle{};

  /// where the edit comes from, to be told in error messages: "wing.toml, line 12". Empty: its place in the list.
  std::string origin{};
};

/// What a call to `apply_feature_edits()` may vary. All angles are in degrees.
struct Feature_edit_options
{
  /// a vertex at which two critical edges meet becomes sharp if the curve turns there by more.
  double turning_angle = 40;

  /// a chain that is added ends where the dihedral angle drops below this.
  double chain_angle = 10;

  /// a sharp vertex that loses critical edges stays sharp, as an isolated corner, if its face angles miss 360 degrees
  /// by at least this.
  double corner_defect = 60;

  /// where no vertex is exactly at a position that an edit names, the one within this distance is meant, in the unit of
  /// the points: for positions that were typed. Two of them are an error.
  double tolerance = 0;
};

/// checks the ranges of the fields. \throws Input_error naming field and value.
inline void check(const Feature_edit_options& options)
{
  const auto in_range = [](const char* name, double value, double most) {
    if (!(value >= 0 && value <= most))
      throw Input_error(std::string("feature edits: ") + name + " must be between 0 and " +
                        std::to_string(static_cast<int>(most)) + " degrees, but is " + std::to_string(value));
  };
  in_range("turning_angle", options.turning_angle, 180);
  in_range("chain_angle", options.chain_angle, 180);
  in_range("corner_defect", options.corner_defect, 360);
  if (!(options.tolerance >= 0 && options.tolerance < std::numeric_limits<double>::infinity()))
    throw Input_error("feature edits: tolerance must be a length, but is " + std::to_string(options.tolerance));
}

/// A vertex on an edited curve at which exactly two critical edges meet.
struct Curve_turning
{
  Index vertex = no_index; ///< in the order of `vertices(g)`
  double angle = 0;        ///< by which the curve turns there, in degrees
  bool is_sharp = false;   ///< after the edit
};

/// What one edit did.
struct Feature_edit_result
{
  Index edges = 0;         ///< that it names
  Index changed_edges = 0; ///< of these: critical now and not before, or the reverse
  Index pinned_edges = 0;  ///< in an area or on a chain to be removed, but on the border or constrained: not removed
  Index sharpened = 0, smoothed = 0;     ///< vertices that became sharp, that ceased to be
  double length = 0;                     ///< of the edges, in the unit of the points
  std::vector<Curve_turning> turnings{}; ///< of edits that add edges, by vertex
};

/// What `apply_feature_edits()` did.
struct Feature_edit_report
{
  std::vector<Feature_edit_result> edits; ///< in their order
  Feature_report features;                ///< after the edits; only what the flags tell: no candidates and rejections

  /// appends what was done on another part of a surface.
  Feature_edit_report& operator+=(const Feature_edit_report& other)
  {
    edits.insert(edits.end(), other.edits.begin(), other.edits.end());
    features += other.features;
    return *this;
  }
};

} // namespace recurve

#endif
