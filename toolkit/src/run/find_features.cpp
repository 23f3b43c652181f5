#include "resolve_edits.h"
#include "surface_passes.h"

#include <recurve/features/detect_features.h>
#include <recurve/features/edit_features.h>
#include <recurve/features/feature_curves.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <utility>

namespace recurve {

namespace {

using Vertex_flags = Boundary_surface::Map<Boundary_surface::Vertex, char>;
using Edge_flags = Boundary_surface::Map<Boundary_surface::Edge, char>;

/// Numbers of patches by face.
struct Patch_map
{
  using key_type = Boundary_surface::Face;
  using value_type = Index;
  using reference = Index;
  using category = boost::readable_property_map_tag;

  friend Index get(const Patch_map& map, key_type face) { return (*map.numbers)[face.idx()]; }

  const std::vector<Index>* numbers;
};

Feature_report detect(const Boundary_surface& surface, Edge_flags edge_is_critical, Vertex_flags vertex_is_sharp,
                      const Feature_options& options, const std::vector<Index>& patches)
{
  return detect_features(
    surface.mesh, edge_is_critical, vertex_is_sharp, options,
    CGAL::parameters::edge_is_constrained_map(surface.edge_is_pinned).face_patch_map(Patch_map{&patches}));
}

Feature_edit_report edit(const Boundary_surface& surface, const std::vector<Feature_edit>& edits,
                         Edge_flags edge_is_critical, Vertex_flags vertex_is_sharp, const Feature_edit_options& options,
                         const std::vector<Index>& patches)
{
  return apply_feature_edits(
    surface.mesh, edits, edge_is_critical, vertex_is_sharp, options,
    CGAL::parameters::edge_is_constrained_map(surface.edge_is_pinned).face_patch_map(Patch_map{&patches}));
}

/// puts what the edits changed into the report of the detection.
void take_edited(Feature_report& report, Feature_report&& edited)
{
  report.critical_edges = edited.critical_edges;
  report.sharp_vertices = edited.sharp_vertices;
  report.isolated_corners = edited.isolated_corners;
  report.curves = std::move(edited.curves);
}

Point position(const Boundary_surface& surface, Boundary_surface::Vertex v)
{
  const auto& p = surface.mesh.point(v);
  return {p.x(), p.y(), p.z()};
}

/// Vertices by position, and where several have one, by their place among these.
class Vertex_namer
{
public:
  explicit Vertex_namer(const Boundary_surface& surface) : surface_(surface)
  {
    for (const auto v : surface.mesh.vertices())
      if (surface.vertex_is_critical[v] || surface.vertex_is_sharp[v])
        vertices_[position(surface, v)];
    for (const auto v : surface.mesh.vertices())
      if (const auto found = vertices_.find(position(surface, v)); found != vertices_.end())
        found->second.push_back(v);
  }

  Vertex_name operator()(Boundary_surface::Vertex v) const
  {
    const auto& here = vertices_.at(position(surface_, v));
    if (here.size() == 1)
      return {.position = position(surface_, v)};
    return {.position = position(surface_, v), .copy = std::find(here.begin(), here.end(), v) - here.begin()};
  }

private:
  const Boundary_surface& surface_;
  std::map<Point, std::vector<Boundary_surface::Vertex>> vertices_;
};

/// names of the patches on either side of `curve`.
std::vector<std::string> patches_beside(const Feature_curve<Boundary_surface::Mesh>& curve,
                                        const Boundary_surface& surface, const Volume_mesh& mesh)
{
  std::set<std::string> names;
  for (const auto h : curve.halfedges)
    for (const auto side : {h, surface.mesh.opposite(h)})
    {
      if (surface.mesh.is_border(side))
        continue;
      const Patch_face& listed = surface.face_patch[surface.mesh.face(side)];
      if (listed.patch != no_index)
        names.insert(
          mesh.zones[static_cast<std::size_t>(listed.zone)].patches[static_cast<std::size_t>(listed.patch)].name);
    }
  return {names.begin(), names.end()};
}

} // namespace

void find_features(Boundary_surface& surface, const Volume_mesh& mesh, const Joined_zones& joined,
                   const Curving_options& options, Curving_report& report, const Progress_callback& progress)
{
  const auto& edits = options.feature_edits;
  Feature_options detection = options.features;
  if (edits && !edits->starts_from_detection)
    detection.method = Feature_method::none;
  const std::vector<Index> patches = patch_numbers(mesh, surface);
  report.features = run_stage("detect features", report.stages, progress, [&] {
    return detect(surface, surface.edge_is_critical, surface.vertex_is_sharp, detection, patches);
  });
  if (!edits)
    return;
  Feature_edit_report edited = run_stage("edit features", report.stages, progress, [&] {
    return edit(surface, resolve_edits(*edits, mesh, joined, surface), surface.edge_is_critical,
                surface.vertex_is_sharp, edits->options, patches);
  });
  take_edited(report.features, std::move(edited.features));
}

void list_curves(Boundary_surface& surface, const Volume_mesh& mesh, const Feature_edit_options& options,
                 Feature_listing& listing)
{
  mark_critical_vertices(surface.mesh, surface.edge_is_critical, surface.vertex_is_sharp, surface.vertex_is_critical);
  const Vertex_namer name(surface);
  listing.file = {.starts_from_detection = false, .options = options};
  listing.file.options.tolerance = 0; // it names vertices to the last bit
  std::vector<Feature_edit> edits;
  for (const auto& curve : trace_feature_curves(surface.mesh, surface.edge_is_critical, surface.vertex_is_sharp))
  {
    Listed_curve& listed = listing.curves.emplace_back();
    Feature_edit& record = edits.emplace_back();
    listed.is_closed = curve.is_closed;
    for (const auto h : curve.halfedges)
    {
      listed.points.push_back(position(surface, surface.mesh.source(h)));
      record.vertices.push_back(name(surface.mesh.source(h)));
      record.vertices.push_back(name(surface.mesh.target(h)));
    }
    listed.patches = patches_beside(curve, surface, mesh);
    if (!curve.is_closed)
      listed.points.push_back(position(surface, surface.mesh.target(curve.halfedges.back())));
  }

  // Replayed, the edges make some vertices sharp by themselves; what differs is said by name.
  auto edge_flags = surface.mesh.add_property_map<Boundary_surface::Edge, char>("e:replayed", 0).first;
  auto vertex_flags = surface.mesh.add_property_map<Boundary_surface::Vertex, char>("v:replayed", 0).first;
  const std::vector<Index> no_patches(surface.mesh.number_of_faces(), 0);
  detect(surface, edge_flags, vertex_flags, {.method = Feature_method::none}, no_patches);
  edit(surface, edits, edge_flags, vertex_flags, options, no_patches);
  Feature_edit marks{.kind = Feature_edit_kind::vertices},
    unmarks{.kind = Feature_edit_kind::vertices, .is_added = false};
  for (const auto v : surface.mesh.vertices())
  {
    const bool is_sharp = surface.vertex_is_sharp[v] != 0;
    if (is_sharp)
      listing.sharp_points.push_back(position(surface, v));
    if (is_sharp != (vertex_flags[v] != 0))
      (is_sharp ? marks : unmarks).vertices.push_back(name(v));
  }
  for (Feature_edit* changes : {&marks, &unmarks})
    if (!changes->vertices.empty())
      edits.push_back(std::move(*changes));
  for (Feature_edit& record : edits)
    listing.file.edits.push_back({.edit = std::move(record)});
  surface.mesh.remove_property_map(edge_flags);
  surface.mesh.remove_property_map(vertex_flags);
}

} // namespace recurve
