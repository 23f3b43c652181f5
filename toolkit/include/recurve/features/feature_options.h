#ifndef RECURVE_FEATURES_FEATURE_OPTIONS_H
#define RECURVE_FEATURES_FEATURE_OPTIONS_H

#include <recurve/core/exceptions.h>

#include <cstdio>
#include <limits>
#include <string>

namespace recurve {

/// How `detect_features()` decides.
enum class Feature_method
{
  classified, ///< edges and vertices ranked by several angles, assembled into curves, unlikely curves rejected
  none,       ///< only border and constrained edges
  dihedral    ///< every edge whose dihedral angle exceeds `Feature_options::dihedral_angle`, and nothing else
};

/// What a call to `detect_features()` may vary. All angles are in degrees. The dihedral angle of an edge is the angle
/// between the normals of its faces: 0 where they are coplanar. The letter in brackets is the one of the literature.
struct Feature_options
{
  Feature_method method = Feature_method::classified;

  /// [theta_f] edges with a dihedral angle up to this are never features. Raise it to 15 for noisy input.
  double weak_angle = 10;

  /// [theta_e] an edge that ends at a junction of curves supports its own curve from this dihedral angle on.
  double end_angle = 25;

  /// [theta_k] an edge with a larger dihedral angle counts as strong when a curve with a doubtful end is judged.
  double strong_angle = 50;

  /// [k] a curve with a doubtful end is kept only if it has more strong edges than this.
  int strong_edges = 5;

  /// [theta_F] an edge with a larger dihedral angle is sharp, whatever its surroundings.
  double sharp_angle = 65;

  /// an edge with a larger dihedral angle is acute: next to one, an edge that is not sharp is a doubtful end. A little
  /// above 90 so that round-off on a right angle does not decide.
  double acute_angle = 90.9;

  /// [theta_D] a vertex whose face angles miss 360 degrees by at least this (by excess or deficit) is a sharp corner.
  double corner_defect = 60;

  /// [theta_T] a curve that turns by more than this at a vertex is cut there.
  double turning_angle = 40;

  /// [theta_t] an edge continues the ridge through its vertex if it deviates from the ridge's direction by less.
  double ridge_deviation = 20;

  /// [rho] a vertex has a ridge direction if the smallest eigenvalue of its normal tensor is at most this part of the
  /// middle one. Without unit, in [0, 1].
  double ridge_ratio = 0.7;

  /// whether a weak curve may end at a border or a constrained edge that it meets as the ridge there. Without this a
  /// crease that runs from border to border is a feature only if it is sharp.
  bool border_ends = true;

  /// whether curves, and long parts of curves, are rejected along which the surface bends no more per length than
  /// beside them: the edges of a coarse mesh of a smooth surface. Also, whatever their angles, small networks of that
  /// kind and those beside which the surface bends back: a rough surface; folds between two rims that are round: a bore
  /// with few facets; and, up to `sharp_angle`, the nose of a profile with few points.
  bool reject_smooth = true;

  /// [theta_c] edges with a dihedral angle above this are safe from `reject_smooth`.
  double smooth_angle = 40;

  /// [rho_c] `reject_smooth` rejects a curve if at half of its edges the bending per length is less than this
  /// multiple of that beside it. Without unit.
  double smooth_contrast = 2;

  /// a curve with doubtful ends is kept if at two thirds of its edges the bending per length is more than this multiple
  /// of that beside it: a crease that fades out. One of up to `strong_edges` edges must lead from one sharp feature to
  /// another and bend so all along: the seam of a chamfered bar. Infinity: none is kept. Without unit.
  double crease_contrast = 3;

  /// the one threshold of `Feature_method::dihedral`.
  double dihedral_angle = 30;

  /// whether every edge between two patches is critical. By itself such an edge is none: the upper and the lower patch
  /// of a wing meet smoothly at its leading edge.
  bool patch_edges = false;

  /// whether patches are smooth inside, so that features lie only between them, as on a mesh with one patch for each
  /// face of a CAD model. What angles cannot tell is decided by it: a bore of six facets from a hexagonal hole.
  bool smooth_patches = false;
};

/// checks the ranges and the order of the fields:
/// 0 <= weak_angle <= end_angle and strong_angle <= sharp_angle <= acute_angle <= 180,
/// turning_angle >= 2 ridge_deviation, and the rest within their natural ranges.
/// \throws Input_error naming the fields and their values otherwise.
inline void check(const Feature_options& options)
{
  const auto written = [](double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.10g", value);
    return std::string(text);
  };
  const auto require = [&](bool holds, const std::string& rule, double found, double other) {
    if (!holds)
      throw Input_error("feature options: " + rule + ", but they are " + written(found) + " and " + written(other));
  };
  const auto in_range = [&](const char* name, double value, double least, double most) {
    if (!(value >= least && value <= most))
      throw Input_error(std::string("feature options: ") + name + " must be between " + written(least) + " and " +
                        written(most) + ", but is " + written(value));
  };
  const auto& o = options;
  in_range("dihedral_angle", o.dihedral_angle, 0, 180);
  in_range("weak_angle", o.weak_angle, 0, 180);
  in_range("acute_angle", o.acute_angle, 0, 180);
  require(o.weak_angle <= o.end_angle, "weak_angle must not exceed end_angle", o.weak_angle, o.end_angle);
  require(o.end_angle <= o.sharp_angle, "end_angle must not exceed sharp_angle", o.end_angle, o.sharp_angle);
  require(o.weak_angle <= o.strong_angle, "weak_angle must not exceed strong_angle", o.weak_angle, o.strong_angle);
  require(o.strong_angle <= o.sharp_angle, "strong_angle must not exceed sharp_angle", o.strong_angle, o.sharp_angle);
  require(o.sharp_angle <= o.acute_angle, "sharp_angle must not exceed acute_angle", o.sharp_angle, o.acute_angle);
  in_range("ridge_deviation", o.ridge_deviation, 0, 90);
  in_range("turning_angle", o.turning_angle, 0, 180);
  require(2 * o.ridge_deviation <= o.turning_angle, "turning_angle must be at least twice ridge_deviation",
          o.turning_angle, o.ridge_deviation);
  in_range("corner_defect", o.corner_defect, 0, 360);
  in_range("ridge_ratio", o.ridge_ratio, 0, 1);
  in_range("smooth_angle", o.smooth_angle, 0, 180);
  in_range("smooth_contrast", o.smooth_contrast, 0, 1e6);
  in_range("crease_contrast", o.crease_contrast, 0, std::numeric_limits<double>::infinity());
  in_range("strong_edges", o.strong_edges, 0, 1e9);
}

} // namespace recurve

#endif
