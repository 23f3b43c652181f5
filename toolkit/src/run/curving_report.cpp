#include <recurve/run/curving_report.h>

#include "validity_json.h"

#include <sys/resource.h>

#include <algorithm>

namespace recurve {

namespace {

// Reports stay readable; the totals are complete.
constexpr std::size_t listed_faces = 1000;

Json json_of(const Curving_options& options)
{
  return {{"degree", options.degree},
          {"fit_degree", options.effective_fit_degree()},
          {"fit_preset", fit_preset_name(options.fit_preset)},
          {"largest_displacement", options.largest_displacement},
          {"curve", options.curve},
          {"keep", options.keep},
          {"features", json_of(options.features)},
          {"feature_edits", options.feature_edits ? Json(options.feature_edits->edits.size()) : Json()},
          {"join",
           {{"use_connectivity", options.join.use_connectivity},
            {"use_geometry", options.join.use_geometry},
            {"tolerance", options.join.tolerance}}},
          {"periodic", options.periodic},
          {"record_jacobians", options.record_jacobians},
          {"deform", options.deform},
          {"deformation",
           {{"length", options.deformation.length},
            {"alpha", options.deformation.alpha},
            {"a", options.deformation.a},
            {"b", options.deformation.b},
            {"area_weights", options.area_weights},
            {"influence_radius", options.deformation.summation.reach},
            {"error_bound", options.deformation.summation.error_bound}}},
          {"threads", options.threads}};
}

/// the patches of the mesh, each with how many of its faces were curved.
Json json_of_selection(const Curving_report& report)
{
  Json json = Json::array();
  for (std::size_t p = 0; p < report.mesh.patches.size(); ++p)
  {
    const Patch_summary& patch = report.mesh.patches[p];
    const Index curved = p < report.curved_faces.size() ? report.curved_faces[p] : 0;
    json.push_back({{"zone", patch.zone},
                    {"name", patch.name},
                    {"place", to_string(patch.place)},
                    {"faces", patch.triangles + patch.quadrangles},
                    {"curved_faces", curved}});
  }
  return json;
}

Json json_of(const Surface_summary& surface)
{
  return {{"faces", surface.faces},
          {"edges", surface.edges},
          {"components", surface.components},
          {"closed_components", surface.closed_components},
          {"border_edges", surface.border_edges},
          {"non_manifold_edges", surface.non_manifold_edges},
          {"non_manifold_vertices", surface.non_manifold_vertices},
          {"repeated_faces", surface.repeated_faces},
          {"collapsed_faces", surface.collapsed_faces},
          {"turned_faces", surface.turned_faces},
          {"shared_edges", surface.shared_edges},
          {"notes", surface.notes}};
}

Json json_of(const Lowered_face& lowered)
{
  return {{"zone", lowered.zone},     {"patch", lowered.patch},   {"face", lowered.face},
          {"center", lowered.center}, {"degree", lowered.degree}, {"reason", lowering_reason_name(lowered.reason)}};
}

Json json_of_fits(const Curving_report& report)
{
  Json faces_of_degree = Json::object(), reasons = Json::object(), listed = Json::array();
  for (std::size_t degree = 0; degree < report.fits.faces_of_degree.size(); ++degree)
    faces_of_degree[std::to_string(degree)] = report.fits.faces_of_degree[degree];
  // A reason without a name is past the last one.
  for (int number = 0; !lowering_reason_name(static_cast<Lowering_reason>(number)).empty(); ++number)
  {
    const auto reason = static_cast<Lowering_reason>(number);
    reasons[std::string(lowering_reason_name(reason))] =
      std::count_if(report.fits.lowerings.begin(), report.fits.lowerings.end(),
                    [reason](const Lowering& lowering) { return lowering.reason == reason; });
  }
  for (std::size_t f = 0; f < std::min(report.lowered_faces.size(), listed_faces); ++f)
    listed.push_back(json_of(report.lowered_faces[f]));
  return {{"faces", report.fits.faces},
          {"faces_of_degree", std::move(faces_of_degree)},
          {"planar_faces", report.fits.planar_faces},
          {"poor_stencils", report.fits.poor_stencils},
          {"fits", report.fits.fits},
          {"reduced_fits", report.fits.reduced_fits},
          {"stencil_vertices", report.fits.stencil_vertices},
          {"lowered_faces", report.fits.lowered_faces},
          {"lowered_by_reason", std::move(reasons)},
          {"first_lowered_faces", std::move(listed)}};
}

Json json_of(const Largest_displacement& displacement)
{
  return {{"length", displacement.length},
          {"relative", displacement.relative},
          {"at", displacement.at},
          {"zone", displacement.zone},
          {"patch", displacement.patch}};
}

Json json_of(const Deformation_summary& deformation)
{
  const Deformation_report& field = deformation.field;
  return {{"length", deformation.length},
          {"planar_patches", deformation.planar_patches},
          {"planar_nodes", deformation.planar_nodes},
          {"periodic_pairs", deformation.periodic_pairs},
          {"blended_face_nodes", deformation.blended_face_nodes},
          {"sources", field.sources},
          {"moving_sources", field.moving_sources},
          {"targets", field.targets},
          {"method", field.is_fast ? "fast" : "plain"},
          {"error_bound", field.error_bound},
          {"pairs", field.pairs},
          {"translations", field.translations},
          {"moved_nodes", deformation.moved_nodes},
          {"negligible_nodes", deformation.negligible_nodes},
          {"largest_displacement", deformation.largest_displacement}};
}

Json json_of(const Jacobian_history& history)
{
  Json json = Json::array();
  for (const Jacobian_stage& stage : history.stages)
  {
    const Jacobian_report::Verdicts verdicts = stage.bounds.total();
    json.push_back({{"stage", stage.name},
                    {"valid", verdicts.valid},
                    {"invalid", verdicts.invalid},
                    {"undecided", verdicts.undecided},
                    {"inverted", stage.inverted},
                    {"wrong_before", stage.wrong_before},
                    {"least_scaled", stage.bounds.least.scaled},
                    {"least_at", stage.bounds.least.position},
                    {"histogram", stage.bounds.histogram}});
  }
  return json;
}

Json json_of(const std::vector<Stage_time>& stages)
{
  Json json = Json::array();
  for (const Stage_time& stage : stages)
    json.push_back({{"stage", stage.stage}, {"seconds", stage.seconds}});
  return json;
}

} // namespace

std::string to_json(const Curving_report& report)
{
  const Json json = {
    {"program", "recurve"},
    {"version", report.version},
    {"input", report.input},
    {"output", report.output},
    {"options", json_of(report.options)},
    {"notes", report.notes},
    {"mesh", json_of(report.mesh)},
    {"patches", json_of_selection(report)},
    {"surface", json_of(report.surface)},
    {"features", json_of(report.features)},
    {"fits", json_of_fits(report)},
    {"nodes",
     {{"moved_on_edges", report.moved_edge_nodes},
      {"moved_on_faces", report.moved_face_nodes},
      {"blended", report.blended_nodes}}},
    {"deformation", report.options.deform ? json_of(report.deformation) : Json()},
    {"displacement",
     {{"largest", json_of(report.largest_displacement)},
      {"largest_relative", json_of(report.largest_relative_displacement)}}},
    {"cells",
     {{"total", report.cells}, {"straight", report.straight_cells}, {"curved", report.cells - report.straight_cells}}},
    {"jacobians", json_of(report.jacobians)},
    {"validity", json_of(report.certification)},
    {"seconds", report.seconds},
    {"stages", json_of(report.stages)},
    {"peak_memory_bytes", report.peak_memory_bytes}};
  return json_text(json);
}

std::int64_t peak_memory_bytes()
{
  rusage usage = {};
  getrusage(RUSAGE_SELF, &usage);
  return std::int64_t{usage.ru_maxrss} * 1024; // Linux counts in KiB
}

} // namespace recurve
