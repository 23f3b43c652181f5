#ifndef RECURVE_RUN_LIST_FEATURES_H
#define RECURVE_RUN_LIST_FEATURES_H

#include <recurve/core/progress.h>
#include <recurve/features/feature_report.h>
#include <recurve/mesh/volume_mesh.h>
#include <recurve/run/curving_options.h>
#include <recurve/run/feature_file.h>

#include <filesystem>
#include <string>
#include <vector>

namespace recurve {

/// A feature curve as positions.
struct Listed_curve
{
  std::vector<Point> points; ///< in their order; a closed curve does not repeat the first
  bool is_closed = false;
  std::vector<std::string> patches; ///< names of the patches beside it, in alphabetical order
};

/// The features of a mesh as curve_mesh() would see them.
struct Feature_listing
{
  Feature_report report;
  std::vector<Listed_curve> curves; ///< in the order of `report.curves`
  std::vector<Point> sharp_points;  ///< of the sharp vertices, in their order
  Feature_file file;                ///< edits that give the same features, to the bit, without detection
};

/// finds the features of `mesh` with the fields `curve`, `keep`, `features`, `feature_edits` and `join` of `options`.
/// \throws Input_error as curve_mesh(); Cancelled. \par Complexity  O(n log n) in the cells.
Feature_listing list_features(Volume_mesh mesh, const Curving_options& options = {},
                              const Progress_callback& progress = {});

/// a table "x1,y1,z1,x2,y2,z2,curve" with one critical edge a line, by curves, coordinates with 17 digits. An edge on
/// which several of the surface stand is listed once.
std::string to_csv(const Feature_listing& listing);

/// `report` as JSON, the same object as the key "features" of the report of a conversion, with `patches` for each
/// curve.
std::string to_json(const Feature_listing& listing);

/// VTK XML poly data: sharp vertices as vertices, curves as lines; cell data `curve` (-1 for vertices) and `is_closed`.
std::string to_vtp(const Feature_listing& listing);

/// writes `listing` by the extension of `file`: .toml (`Feature_listing::file`), .csv or .vtp.
/// \throws Input_error for another extension; Format_error if writing fails, an older file then stays as it was.
void write_features(const Feature_listing& listing, const std::filesystem::path& file);

/// \throws Input_error if `file` has an extension that write_features() does not know.
void check_feature_extension(const std::filesystem::path& file);

} // namespace recurve

#endif
