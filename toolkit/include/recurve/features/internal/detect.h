#ifndef RECURVE_FEATURES_INTERNAL_DETECT_H
#define RECURVE_FEATURES_INTERNAL_DETECT_H

#include <recurve/features/feature_report.h>
#include <recurve/features/internal/edge_chains.h>
#include <recurve/features/internal/reject_curves.h>

#include <vector>

namespace recurve::internal::features {

/// What `detect_features()` writes.
struct Detected
{
  std::vector<char> edge_is_critical, vertex_is_sharp;
  Feature_report report;
};

/// the sharp vertices: sharp corners by their angle defect (unless nothing is to be detected), where more than two
/// critical edges meet, and where two meet at an angle.
inline std::vector<char> find_sharp_vertices(const Flat_surface& s, const Surface_angles& a,
                                             const std::vector<char>& edge_is_critical, const Feature_options& options)
{
  std::vector<char> is_sharp(s.points.size(), 0);
  if (options.method != Feature_method::none)
    is_sharp = find_sharp_corners(a, options);
  const Out_halfedges out(s, [&](Index e) { return edge_is_critical[e] != 0; });
  for (Index v = 0; v < s.number_of_vertices(); ++v)
  {
    const auto around = out[v];
    if (around.size() > 2)
      is_sharp[v] = true;
    else if (around.size() == 2)
    {
      const double angle = angle_between(direction(s, *around.begin()), direction(s, *(around.begin() + 1)));
      is_sharp[v] |= static_cast<char>(180 - angle > options.turning_angle + angle_tie);
    }
  }
  return is_sharp;
}

/// fills counts and curves of `d.report` from the flags.
inline void summarize(const Flat_surface& s, const Surface_angles& a, Detected& d)
{
  Feature_report& r = d.report;
  r.edges = s.number_of_edges();
  r.pinned_edges = std::count(a.is_pinned.begin(), a.is_pinned.end(), 1);
  r.critical_edges = std::count(d.edge_is_critical.begin(), d.edge_is_critical.end(), 1);
  r.sharp_vertices = std::count(d.vertex_is_sharp.begin(), d.vertex_is_sharp.end(), 1);
  std::vector<char> is_on_edge(s.points.size(), 0);
  for (const Edge_chain& chain : Chain_tracer(s, d.edge_is_critical, d.vertex_is_sharp).run())
  {
    Feature_curve_summary c;
    c.first_vertex = s.source_of(chain.halfedges.front());
    c.last_vertex = s.target[chain.halfedges.back()];
    c.first_point = s.points[c.first_vertex];
    c.last_point = s.points[c.last_vertex];
    c.edges = static_cast<Index>(chain.halfedges.size());
    c.is_closed = chain.is_closed;
    c.is_pinned = true;
    for (const Index h : chain.halfedges)
    {
      c.length += norm(s.points[s.target[h]] - s.points[s.source_of(h)]);
      c.max_dihedral = std::max(c.max_dihedral, a.dihedral[h / 2]);
      c.is_pinned = c.is_pinned && a.is_pinned[h / 2];
      is_on_edge[s.target[h]] = is_on_edge[s.source_of(h)] = 1;
    }
    const auto end = [&](Index v) { return d.vertex_is_sharp[v] ? Curve_end::corner : Curve_end::terminus; };
    if (!c.is_closed)
      c.first_end = end(c.first_vertex), c.last_end = end(c.last_vertex);
    r.curves.push_back(c);
  }
  for (std::size_t v = 0; v < s.points.size(); ++v)
    r.isolated_corners += d.vertex_is_sharp[v] && !is_on_edge[v];
}

/// per edge whether it is between two patches. `patch_of_face` is not empty; the border is no patch.
inline std::vector<char> find_patch_edges(const Flat_surface& s, const std::vector<Index>& patch_of_face)
{
  std::vector<char> is_between(s.number_of_edges(), 0);
  for (Index e = 0; e < s.number_of_edges(); ++e)
    is_between[e] = !s.is_border_edge(e) && patch_of_face[s.face[2 * e]] != patch_of_face[s.face[2 * e + 1]];
  return is_between;
}

/// the angles of `s`, and what `options` say of patches.
inline Surface_angles prepare(const Flat_surface& s, std::vector<char> constrained,
                              const std::vector<Index>& patch_of_face, const Feature_options& options)
{
  if (!options.patch_edges && !options.smooth_patches)
    return measure_angles(s, constrained);
  std::vector<char> is_between = find_patch_edges(s, patch_of_face);
  if (options.patch_edges)
  {
    constrained.resize(is_between.size(), 0);
    for (std::size_t e = 0; e < is_between.size(); ++e)
      constrained[e] |= is_between[e];
  }
  Surface_angles a = measure_angles(s, constrained);
  if (options.smooth_patches)
  {
    a.is_told_smooth = std::move(is_between);
    for (char& is_smooth : a.is_told_smooth)
      is_smooth = !is_smooth;
  }
  return a;
}

/// the whole detection on flat arrays; `constrained` is per edge or empty, `patch_of_face` per face, or empty if no
/// option asks for it.
inline Detected detect(const Flat_surface& s, const std::vector<char>& constrained,
                       const std::vector<Index>& patch_of_face, const Feature_options& options)
{
  Detected d;
  const Surface_angles a = prepare(s, constrained, patch_of_face, options);
  const Index ne = s.number_of_edges();
  d.edge_is_critical.assign(ne, 0);
  if (options.method == Feature_method::dihedral)
    for (Index e = 0; e < ne; ++e)
      d.edge_is_critical[e] =
        a.dihedral[e] > options.dihedral_angle && !(options.smooth_patches && a.is_told_smooth[e]);
  if (options.method == Feature_method::classified)
  {
    const Edge_classes classes = Edge_classifier(s, a, options).run();
    d.report.weak_edges = classes.weak_edges;
    d.report.sharp_edges = classes.sharp_edges;
    d.report.candidate_edges = std::count(classes.is_candidate.begin(), classes.is_candidate.end(), 1);
    d.edge_is_critical = Curve_rejector(s, a, classes, options).run(d.report);
  }
  for (Index e = 0; e < ne; ++e)
    d.edge_is_critical[e] |= a.is_pinned[e];
  d.vertex_is_sharp = find_sharp_vertices(s, a, d.edge_is_critical, options);
  summarize(s, a, d);
  return d;
}

} // namespace recurve::internal::features

#endif
