#include "json.h"

#include <algorithm>
#include <string>
#include <vector>

namespace recurve {

namespace {

// Noise is rejected by the thousand; the counts are complete.
constexpr std::size_t listed_rejections = 1000;

Json json_of_curve(const Feature_curve_summary& curve)
{
  return {{"edges", curve.edges},
          {"length", curve.length},
          {"max_dihedral", curve.max_dihedral},
          {"closed", curve.is_closed},
          {"pinned", curve.is_pinned},
          {"first_point", curve.first_point},
          {"last_point", curve.last_point},
          {"first_end", to_string(curve.first_end)},
          {"last_end", to_string(curve.last_end)}};
}

Json json_of_rejected(std::vector<Rejected_curve> rejected)
{
  std::stable_sort(rejected.begin(), rejected.end(),
                   [](const Rejected_curve& a, const Rejected_curve& b) { return a.length > b.length; });
  if (rejected.size() > listed_rejections)
    rejected.resize(listed_rejections);
  Json json = Json::array();
  for (const Rejected_curve& curve : rejected)
    json.push_back({{"reason", to_string(curve.reason)},
                    {"edges", curve.edges},
                    {"length", curve.length},
                    {"max_dihedral", curve.max_dihedral},
                    {"closed", curve.is_closed},
                    {"first_point", curve.first_point},
                    {"last_point", curve.last_point}});
  return json;
}

} // namespace

Json json_of(const Feature_options& options)
{
  constexpr const char* methods[] = {"classified", "none", "dihedral"};
  return {{"method", methods[static_cast<int>(options.method)]},
          {"weak_angle", options.weak_angle},
          {"end_angle", options.end_angle},
          {"strong_angle", options.strong_angle},
          {"strong_edges", options.strong_edges},
          {"sharp_angle", options.sharp_angle},
          {"acute_angle", options.acute_angle},
          {"corner_defect", options.corner_defect},
          {"turning_angle", options.turning_angle},
          {"ridge_deviation", options.ridge_deviation},
          {"ridge_ratio", options.ridge_ratio},
          {"border_ends", options.border_ends},
          {"reject_smooth", options.reject_smooth},
          {"smooth_angle", options.smooth_angle},
          {"smooth_contrast", options.smooth_contrast},
          {"crease_contrast", options.crease_contrast},
          {"dihedral_angle", options.dihedral_angle},
          {"patch_edges", options.patch_edges},
          {"smooth_patches", options.smooth_patches}};
}

Json json_of(const Feature_report& features)
{
  Json curves = Json::array(), rejected_edges = Json::object();
  for (const Feature_curve_summary& curve : features.curves)
    curves.push_back(json_of_curve(curve));
  for (int reason = 0; reason < number_of_rejections; ++reason)
    rejected_edges[std::string(to_string(static_cast<Rejection>(reason)))] =
      features.rejected_edges[static_cast<std::size_t>(reason)];
  return {{"critical_edges", features.critical_edges},
          {"border_edges", features.pinned_edges},
          {"weak_edges", features.weak_edges},
          {"sharp_edges", features.sharp_edges},
          {"candidate_edges", features.candidate_edges},
          {"sharp_vertices", features.sharp_vertices},
          {"isolated_corners", features.isolated_corners},
          {"curves", std::move(curves)},
          {"rejected_curves", features.rejected.size()},
          {"rejected_edges", std::move(rejected_edges)},
          {"longest_rejected_curves", json_of_rejected(features.rejected)}};
}

} // namespace recurve
