#ifndef RECURVE_RUN_CURVING_OPTIONS_H
#define RECURVE_RUN_CURVING_OPTIONS_H

#include <recurve/features/feature_options.h>
#include <recurve/mesh/join_zones.h>
#include <recurve/run/feature_file.h>
#include <recurve/volume/deformation_options.h>
#include <recurve/volume/restoration_report.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace recurve {

/// How the surface is reconstructed.
enum class Fit_preset
{
  standard, ///< "default": fits of vertices, blended (`fit_vertices()`), and feature curves of the same degree
  paper     ///< fits of faces as in Ims & Wang 2018 (`reconstruct_surface()`), and cubic splines
};

/// "default" or "paper", as in options and reports.
constexpr std::string_view fit_preset_name(Fit_preset preset)
{
  return preset == Fit_preset::paper ? "paper" : "default";
}

/// What a conversion may vary.
struct Curving_options
{
  int degree = 2; ///< degree p of the elements, 1 to 6; 1 leaves every cell as it is

  int fit_degree = 0; ///< degree d of the local polynomials, 1 to 6; 0: max(2, degree)

  Fit_preset fit_preset = Fit_preset::standard;

  /// a fit that moves its face farther than this is taken at a lower degree; in sizes of the face (largest distance of
  /// a corner from the centre). Half a size is the rise of an arc of more than 100 degrees over one face: beyond it the
  /// fit oscillates.
  double largest_displacement = 0.5;

  /// patches to curve, as `select_patches()` takes them; empty: all that bound the mesh. Patches inside the mesh
  /// (two-sided ones and zone interfaces) are curved only if named here.
  std::vector<std::string> curve = {};

  /// patches that stay straight, though `curve` names them.
  std::vector<std::string> keep = {};

  Feature_options features = {};
  std::optional<Feature_file> feature_edits = {}; ///< applied after detection, or instead
  Join_options join = {};

  /// pairs of patches that are a translation apart and have to stay so, by their names; with those that the mesh calls
  /// periodic itself.
  std::vector<std::array<std::string, 2>> periodic = {};

  /// whether nodes inside the mesh follow the curved surface through all layers (see doc/deform_interior.md); else only
  /// cells that touch it are bent.
  bool deform = true;

  /// the formula; `length` 0: the mean edge length of the curved faces. `summation.reach` is the influence radius.
  Deformation_options deformation = {};

  /// whether a node counts by the area that it stands for, so that a finely meshed wall has no more influence.
  bool area_weights = false;

  bool certify = true;                  ///< certify the result and give up curvature where that fails
  Restoration_options restoration = {}; ///< how

  /// whether to bound the Jacobians of all cells before and after each step, for `Curving_report::jacobians`. That
  /// needs time, and memory for a second copy of the nodes.
  bool record_jacobians = false;

  int threads = 0; ///< largest number of threads; 0: as many as there are. The result does not depend on it

  /// the degree of the fits that `fit_degree` means.
  int effective_fit_degree() const { return fit_degree > 0 ? fit_degree : std::max(2, degree); }
};

/// \throws Input_error if a field is out of its range, naming field and value.
void check(const Curving_options& options);

} // namespace recurve

#endif
