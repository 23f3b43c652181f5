#include "describe.h"
#include "describe_validity.h"
#include "wording.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <map>

namespace recurve {

namespace {

template <class CountOf>
std::string cells_by_type(CountOf count_of)
{
  std::vector<std::string> parts;
  for (Element_type type :
       {Element_type::tetrahedron, Element_type::pyramid, Element_type::prism, Element_type::hexahedron})
    if (const Index count = count_of(type); count > 0)
      parts.push_back(counted(count, element_name(type), plural_name(type)));
  return parts.empty() ? "no cells" : fmt::format("{}", fmt::join(parts, ", "));
}

std::string describe_zones(const Mesh_summary& summary)
{
  std::vector<std::vector<std::string>> rows = {{"zone", "points", "cells", "family"}};
  for (const Zone_summary& zone : summary.zones)
    rows.push_back({zone.name, grouped(zone.points),
                    cells_by_type([&](Element_type type) { return zone.cells[static_cast<std::size_t>(type)]; }),
                    zone.family});
  return table(rows);
}

std::string describe_patches(const Mesh_summary& summary)
{
  if (summary.patches.empty())
    return "no patches\n";
  std::vector<std::vector<std::string>> rows = {
    {"patch", "zone", "triangles", "quadrangles", "kind", "family", "place"}};
  for (const Patch_summary& patch : summary.patches)
    rows.push_back({patch.name, patch.zone, grouped(patch.triangles), grouped(patch.quadrangles), patch.kind,
                    patch.family, std::string(to_string(patch.place))});
  return table(rows);
}

std::string describe_interfaces(const Mesh_summary& summary)
{
  std::vector<std::vector<std::string>> rows = {{"interface", "zone", "donor zone", "pairs", "kind"}};
  for (const Interface_summary& interface : summary.interfaces)
    rows.push_back({interface.name, interface.zone, interface.donor_zone, grouped(interface.points),
                    interface.is_periodic              ? "periodic"
                    : interface.is_abutting_one_to_one ? "one-to-one"
                                                       : "not one-to-one: kept as a name"});
  std::string text = summary.interfaces.empty() ? "" : table(rows);
  for (const Joined_pair& pair : summary.joined_zones)
    text += fmt::format("  zones {} and {} share {} ({} by connectivity, {} by position)\n", pair.zone_a, pair.zone_b,
                        counted(pair.points_by_connectivity + pair.points_by_geometry, "point", "points"),
                        grouped(pair.points_by_connectivity), grouped(pair.points_by_geometry));
  return text;
}

std::string describe_faults(const Mesh_summary& summary)
{
  std::string text;
  const auto say = [&](Index count, std::string_view what) {
    if (count > 0)
      text += fmt::format("  {} {}\n", grouped(count), what);
  };
  say(summary.orientation.mirrored_cells, "cells are inside out and are turned");
  say(static_cast<Index>(summary.orientation.invalid_cells.size()),
      "cells are folded (corner Jacobians of both signs)");
  say(static_cast<Index>(summary.orientation.collapsed_cells.size()),
      "cells are collapsed (a corner Jacobian of zero)");
  say(summary.boundary.unassigned_faces, "boundary faces are in no patch; they became the patch \"unassigned\"");
  say(summary.boundary.faces_without_cell, "faces belong to no cell");
  say(summary.boundary.duplicate_faces, "faces are listed more than once");
  say(summary.boundary.crowded_faces, "faces have more than two cells: cells overlap");
  return text;
}

/// the names of the patches with, or without, curved faces; each once.
std::vector<std::string> patch_names(const Curving_report& report, bool is_curved)
{
  std::vector<std::string> names;
  for (std::size_t p = 0; p < report.mesh.patches.size(); ++p)
    if ((report.curved_faces[p] > 0) == is_curved &&
        std::find(names.begin(), names.end(), report.mesh.patches[p].name) == names.end())
      names.push_back(report.mesh.patches[p].name);
  return names;
}

std::string describe_names(const std::vector<std::string>& names)
{
  // A line or two; the report lists them all.
  constexpr std::size_t listed_names = 12;
  const auto count = static_cast<std::ptrdiff_t>(std::min(names.size(), listed_names));
  std::string text = fmt::format("{}", fmt::join(names.begin(), names.begin() + count, ", "));
  if (names.size() > listed_names)
    text += fmt::format(" and {} more", names.size() - listed_names);
  return names.empty() ? "none" : text;
}

std::string describe_lowerings(const Reconstruction_report& fits)
{
  std::map<std::string_view, Index> reasons;
  for (const Lowering& lowering : fits.lowerings)
    ++reasons[lowering_reason_name(lowering.reason)];
  std::vector<std::string> parts;
  parts.reserve(reasons.size());
  for (const auto& [reason, count] : reasons)
    parts.push_back(fmt::format("{} {}", reason, grouped(count)));
  return parts.empty() ? "none at a lower degree"
                       : fmt::format("{} at a lower degree ({})", grouped(fits.lowered_faces), fmt::join(parts, ", "));
}

std::string describe_displacement(const Curving_report& report)
{
  const Largest_displacement& largest = report.largest_displacement;
  if (largest.length == 0)
    return "no node moved: the mesh is exactly straight\n";
  const Largest_displacement& relative = report.largest_relative_displacement;
  return fmt::format("largest displacement {:.4g} at {} on {}; relative to the edge {:.3g} % at {} on {}\n",
                     largest.length, at_point(largest.at), largest.patch, 100 * relative.relative,
                     at_point(relative.at), relative.patch);
}

std::string describe_deformation(const Curving_report& report)
{
  const Deformation_summary& deformation = report.deformation;
  if (report.largest_displacement.length == 0 || report.options.degree == 1)
    return "";
  if (!report.options.deform)
    return "interior: only cells at the surface are bent\n";
  std::string text = fmt::format("interior: {} moved, at most {:.4g}",
                                 counted(deformation.moved_nodes, "node", "nodes"), deformation.largest_displacement);
  if (deformation.planar_patches > 0)
    text += fmt::format("; {} of them in {}", grouped(deformation.planar_nodes),
                        counted(deformation.planar_patches, "planar patch", "planar patches"));
  return text + "\n";
}

// What a terminal shows at a glance; files and --json have the rest.
constexpr std::size_t shown_curves = 100, shown_rejections = 10;

std::string describe_curves(const Feature_listing& listing)
{
  const Feature_report& report = listing.report;
  if (report.curves.empty())
    return "";
  const auto end_at = [](const Point& point, Curve_end end) {
    return at_point(point) + (end == Curve_end::terminus ? " fades out" : "");
  };
  std::vector<std::vector<std::string>> rows = {{"curve", "edges", "length", "largest angle", "from", "to", "beside"}};
  for (std::size_t i = 0; i < std::min(report.curves.size(), shown_curves); ++i)
  {
    const Feature_curve_summary& curve = report.curves[i];
    rows.push_back({std::to_string(i), grouped(curve.edges), fmt::format("{:.6g}", curve.length),
                    curve.is_pinned ? "border" : fmt::format("{:.1f}", curve.max_dihedral),
                    end_at(curve.first_point, curve.first_end),
                    curve.is_closed ? "closed" : end_at(curve.last_point, curve.last_end),
                    fmt::format("{}", fmt::join(listing.curves[i].patches, ", "))});
  }
  std::string text = "\n" + table(rows);
  if (report.curves.size() > shown_curves)
    text += fmt::format("  and {} more; --json and -o FILE have all\n",
                        grouped(static_cast<Index>(report.curves.size() - shown_curves)));
  return text;
}

std::string describe_edits(const Feature_listing& listing)
{
  if (listing.edits.empty())
    return "";
  std::vector<std::vector<std::string>> rows = {
    {"edit", "edges", "changed", "on the border", "length", "largest turn", "vertices sharpened", "smoothed"}};
  for (const Applied_edit& edit : listing.edits)
    if (rows.size() <= shown_curves)
      rows.push_back({edit.origin, grouped(edit.result.edges), grouped(edit.result.changed_edges),
                      grouped(edit.result.pinned_edges), fmt::format("{:.6g}", edit.result.length),
                      fmt::format("{:.1f}", edit.largest_turning()), grouped(edit.result.sharpened),
                      grouped(edit.result.smoothed)});
  return "\n" + table(rows);
}

std::string_view explain(Rejection reason)
{
  switch (reason)
  {
  case Rejection::dangling: return "dangling: fades out or ends in doubt, with few strong edges";
  case Rejection::doubtful: return "doubtful: both ends are, and it has few strong edges";
  case Rejection::overshadowed: return "overshadowed: weak, between stronger features";
  case Rejection::smooth: return "smooth: the surface bends as much beside it, or around its ends";
  case Rejection::rough: return "rough: one of a few, and the surface bends as much beside them, or back";
  }
  return "";
}

std::string describe_rejected(const Feature_report& report)
{
  if (report.rejected.empty())
    return "";
  std::vector<const Rejected_curve*> longest;
  Index edges = 0;
  for (const Rejected_curve& curve : report.rejected)
  {
    longest.push_back(&curve);
    edges += curve.edges;
  }
  std::stable_sort(longest.begin(), longest.end(),
                   [](const Rejected_curve* a, const Rejected_curve* b) { return a->length > b->length; });
  std::vector<std::vector<std::string>> rows = {{"edges", "length", "largest angle", "from", "to", "reason"}};
  for (const Rejected_curve* curve : longest)
    if (rows.size() <= shown_rejections)
      rows.push_back({grouped(curve->edges), fmt::format("{:.6g}", curve->length),
                      fmt::format("{:.1f}", curve->max_dihedral), at_point(curve->first_point),
                      curve->is_closed ? "closed" : at_point(curve->last_point), std::string(explain(curve->reason))});
  std::string text =
    fmt::format("\n{} not taken ({}), longest first\n\n",
                counted(static_cast<Index>(report.rejected.size()), "candidate curve was", "candidate curves were"),
                counted(edges, "edge", "edges"));
  text += table(rows);
  if (longest.size() > shown_rejections)
    text +=
      fmt::format("  and {} more; --json has them\n", grouped(static_cast<Index>(longest.size() - shown_rejections)));
  return text;
}

std::string describe_jacobians(const Jacobian_history& history)
{
  std::string text;
  for (const Jacobian_stage& stage : history.stages)
  {
    text += fmt::format("{}: {} inverted", stage.name, counted(stage.inverted, "cell", "cells"));
    if (stage.wrong_before > 0)
      text += fmt::format(" beyond {} that were wrong before", grouped(stage.wrong_before));
    text += fmt::format(", smallest scaled Jacobian {:.3g}\n", stage.bounds.least.scaled);
  }
  return text;
}

} // namespace

std::string describe(const Mesh_summary& summary, const std::vector<std::string>& notes)
{
  std::string text = fmt::format(
    "{} in {}: {}, {}\nbounding box {} to {}\n", counted(summary.cell_count(), "cell", "cells"),
    counted(static_cast<Index>(summary.zones.size()), "zone", "zones"),
    cells_by_type([&](Element_type type) { return summary.cell_count(type); }),
    counted(summary.point_count(), "point", "points"), at_point(summary.smallest), at_point(summary.largest));
  text += "\n" + describe_zones(summary) + "\n" + describe_patches(summary);
  for (const std::string& part : {describe_interfaces(summary), describe_faults(summary)})
    if (!part.empty())
      text += "\n" + part;
  if (!notes.empty())
    text += fmt::format("\nnotes\n  {}\n", fmt::join(notes, "\n  "));
  return text;
}

std::string describe(const Feature_listing& listing)
{
  const Feature_report& report = listing.report;
  return fmt::format("{}, {}, {}\n", counted(report.critical_edges, "critical edge", "critical edges"),
                     counted(static_cast<Index>(report.curves.size()), "curve", "curves"),
                     counted(report.sharp_vertices, "sharp vertex", "sharp vertices")) +
         describe_edits(listing) + describe_curves(listing) + describe_rejected(report);
}

std::string describe(const Curving_report& report)
{
  const Mesh_summary& mesh = report.mesh;
  std::string text =
    fmt::format("{}: {} in {}\n", report.input, cells_by_type([&](Element_type type) { return mesh.cell_count(type); }),
                counted(static_cast<Index>(mesh.zones.size()), "zone", "zones"));
  text += fmt::format("curved to degree {} with fits of degree {}: {}\n", report.options.degree,
                      report.options.effective_fit_degree(), describe_names(patch_names(report, true)));
  if (const auto kept = patch_names(report, false); !kept.empty())
    text += fmt::format("kept straight: {}\n", describe_names(kept));
  text +=
    fmt::format("features: {}, {}, {}\n", counted(report.features.critical_edges, "critical edge", "critical edges"),
                counted(static_cast<Index>(report.features.curves.size()), "curve", "curves"),
                counted(report.features.sharp_vertices, "sharp vertex", "sharp vertices"));
  text += fmt::format("fits: {}, {} planar, {}\n", counted(report.fits.faces, "face", "faces"),
                      grouped(report.fits.planar_faces), describe_lowerings(report.fits));
  text += describe_displacement(report);
  text += describe_deformation(report);
  text += fmt::format("{} of {} are exactly straight\n", grouped(report.straight_cells),
                      counted(report.cells, "cell", "cells"));
  text += describe_jacobians(report.jacobians);
  text += describe_faults(mesh);
  text += describe(report.certification);
  text += fmt::format("wrote {} in {:.1f} s with at most {:.0f} MiB\n", report.output, report.seconds,
                      static_cast<double>(report.peak_memory_bytes) / (1024.0 * 1024.0));
  return text;
}

} // namespace recurve
