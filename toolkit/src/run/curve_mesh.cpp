#include <recurve/run/curve_mesh.h>

#include "certify.h"
#include "deform_mesh.h"
#include "node_placement.h"
#include "periodic_motion.h"
#include "record_jacobians.h"
#include "surface_passes.h"

#include <recurve/core/exceptions.h>
#include <recurve/mesh/boundary_surface.h>
#include <recurve/run/mesh_structure.h>
#include <recurve/run/select_patches.h>
#include <recurve/volume/blend_interior.h>
#include <recurve/volume/deform_interior.h>

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <optional>
#include <set>
#include <utility>

namespace recurve {

namespace {

void check_range(std::string_view name, int value, int least, int most)
{
  if (value < least || value > most)
    throw Input_error(fmt::format("{}: expected {} to {}, found {}", name, least, most, value));
}

void check(const Deformation_options& options)
{
  // Whatever the mesh, so that a typing error does not wait for one that is curved. A length of 0 is taken from it.
  const double length = options.length == 0 ? 1 : options.length;
  const Inverse_distance_powers influence(length, options.alpha, options.a, options.b);
  const Interior_deformer deformer(std::vector<Point>{}, influence, options.summation);
}

/// One conversion: its steps share the mesh and the report.
class Conversion
{
public:
  Conversion(Volume_mesh mesh, const Curving_options& options, const Progress_callback& progress)
    : linear_(std::move(mesh)), options_(options), progress_(progress)
  {
    report_.version = RECURVE_VERSION;
    report_.options = options;
  }

  Curved_mesh run()
  {
    structure_ = find_structure(linear_, options_.join, report_.stages, progress_);
    report_.mesh = summarize(linear_, structure_);
    make_surface();
    find_features(surface_, linear_, structure_.joined, options_, report_, progress_);
    raise_degree();
    if (options_.record_jacobians)
      run_stage("bound Jacobians", report_.stages, progress_, [&] { recorder_.record_straight(curved_); });
    if (options_.degree > 1)
    {
      place_nodes();
      if (options_.record_jacobians && options_.deform)
        record_undeformed();
      if (options_.deform)
        deform();
      else
        blend();
      if (options_.record_jacobians)
        record(curved_.nodes, states_, options_.deform ? "deformed" : "curved");
    }
    else
      find_source_faces();
    if (options_.certify)
      certify();
    if (options_.certify && options_.record_jacobians && options_.degree > 1)
      record(curved_.nodes, states_, "certified");
    states_ = {};
    count_straight_cells();
    return std::move(curved_);
  }

  Curving_report& report() { return report_; }

private:
  void make_surface()
  {
    run_stage("make surface", report_.stages, progress_, [&] {
      selection_ = select_patches(linear_, structure_.boundary, options_.curve, options_.keep);
      surface_ = make_boundary_surface(linear_, structure_.joined, structure_.boundary, selection_);
    });
    summarize_surface();
    count_curved_faces();
  }

  void summarize_surface()
  {
    const Boundary_surface_report& found = surface_.report;
    Surface_summary& surface = report_.surface;
    surface.faces = static_cast<Index>(surface_.mesh.number_of_faces());
    surface.edges = static_cast<Index>(surface_.mesh.number_of_edges());
    surface.components = found.components;
    surface.closed_components = found.closed_components;
    surface.border_edges = found.border_edges;
    surface.non_manifold_edges = found.non_manifold_edges;
    surface.non_manifold_vertices = found.non_manifold_vertices;
    surface.repeated_faces = found.repeated_faces;
    surface.collapsed_faces = found.collapsed_faces;
    surface.turned_faces = found.turned_faces;
    surface.notes = found.notes;
  }

  /// per patch of the summary, which lists the patches zone by zone. A face inside the mesh is curved with its other
  /// side, whichever patch named it.
  void count_curved_faces()
  {
    const auto key = [&](std::size_t z, Index face) {
      const Face_owners& owners = structure_.boundary.owners[z][static_cast<std::size_t>(face)];
      return std::min(owners.first, owners.second.cell == no_index ? owners.first : owners.second);
    };
    std::set<Cell_face> curved_inside;
    for (Boundary_surface::Face face : surface_.mesh.faces())
    {
      const Patch_face& listed = surface_.face_patch[face];
      const auto z = static_cast<std::size_t>(listed.zone);
      if (place_of(structure_.boundary.owners[z][static_cast<std::size_t>(listed.face)]) != Face_place::boundary)
        curved_inside.insert(key(z, listed.face));
    }
    for (std::size_t z = 0; z < linear_.zones.size(); ++z)
      for (const Patch& patch : linear_.zones[z].patches)
        report_.curved_faces.push_back(std::count_if(patch.faces.begin(), patch.faces.end(), [&](Index face) {
          return selection_[z][static_cast<std::size_t>(face)] != 0 || curved_inside.count(key(z, face)) > 0;
        }));
  }

  void raise_degree()
  {
    curved_ = run_stage("raise degree", report_.stages, progress_,
                        [&] { return elevate(std::move(linear_), structure_.joined, options_.degree); });
    structure_.joined = {};
  }

  void place_nodes()
  {
    std::vector<Cell_face> owners;
    owners.reserve(surface_.mesh.number_of_faces());
    for (Boundary_surface::Face face : surface_.mesh.faces())
      owners.push_back(surface_.face_owner[face]);
    Node_placement placement(curved_, std::move(owners));
    find_source_faces();
    structure_.boundary.owners = {};
    place_surface_nodes(surface_, options_, placement, report_, progress_);
    take_report(placement);
    states_ = std::move(placement.states());
    surface_ = {};
  }

  /// the selection becomes that of all faces whose nodes move others: those on the boundary, and curved ones inside.
  void find_source_faces()
  {
    for (std::size_t z = 0; z < selection_.size(); ++z)
      for (std::size_t f = 0; f < selection_[z].size(); ++f)
        if (place_of(structure_.boundary.owners[z][f]) == Face_place::boundary)
          selection_[z][f] = 1;
  }

  void take_report(const Node_placement& placement)
  {
    report_.surface.shared_edges = placement.shared_edges();
    report_.moved_edge_nodes = placement.moved_edge_nodes();
    report_.moved_face_nodes = placement.moved_face_nodes();
    report_.largest_displacement = displacement(placement.longest_way());
    report_.largest_relative_displacement = displacement(placement.longest_relative_way());
    for (const Lowering& lowering : report_.fits.lowerings)
      report_.lowered_faces.push_back(lowered_face(lowering));
  }

  Largest_displacement displacement(const Way& way) const
  {
    if (way.face == no_index)
      return {};
    const Patch_face& listed = listed_face(way.face);
    return {way.length, way.relative, way.at, zone(listed).name, patch(listed).name};
  }

  Lowered_face lowered_face(const Lowering& lowering) const
  {
    const Patch_face& listed = listed_face(lowering.face);
    Point sum = {};
    double corners = 0;
    for (const auto vertex : surface_.mesh.vertices_around_face(surface_.mesh.halfedge(
           Boundary_surface::Face(static_cast<Boundary_surface::Face::size_type>(lowering.face)))))
    {
      const auto& point = surface_.mesh.point(vertex);
      sum = {sum[0] + point.x(), sum[1] + point.y(), sum[2] + point.z()};
      ++corners;
    }
    const Point center = {sum[0] / corners, sum[1] / corners, sum[2] / corners};
    return {zone(listed).name, patch(listed).name, listed.face, center, lowering.degree, lowering.reason};
  }

  const Patch_face& listed_face(Index face) const
  {
    return surface_.face_patch[Boundary_surface::Face(static_cast<Boundary_surface::Face::size_type>(face))];
  }
  const Zone& zone(const Patch_face& listed) const
  {
    return curved_.linear.zones[static_cast<std::size_t>(listed.zone)];
  }
  const Patch& patch(const Patch_face& listed) const
  {
    return zone(listed).patches[static_cast<std::size_t>(listed.patch)];
  }

  /// all zones at once: they share nodes. A face of a patch is a face of a cell, so the cells do.
  std::vector<Element_block> cell_blocks() const
  {
    std::vector<Element_block> blocks;
    for (const Curved_zone& zone : curved_.zones)
      for (const Curved_section& section : zone.cells)
        blocks.push_back({section.type, section.nodes});
    return blocks;
  }

  void blend()
  {
    const Blend_report blend = run_stage("blend interior", report_.stages, progress_, [&] {
      return blend_interior(curved_.nodes, states_, cell_blocks(), options_.degree);
    });
    report_.blended_nodes = blend.blended_nodes;
  }

  void certify()
  {
    report_.certification = run_stage("certify", report_.stages, progress_, [&] {
      const std::vector<Periodic_nodes> periodic = find_periodic_nodes(curved_, options_.periodic);
      return certify_and_restore(curved_, states_, selection_, periodic, options_.restoration, progress_);
    });
  }

  void record(std::span<const Point> nodes, std::span<const Node_state> states, std::string name)
  {
    run_stage("bound Jacobians", report_.stages, progress_,
              [&] { recorder_.record(curved_, nodes, states, std::move(name)); });
  }

  /// what the cells would be like without deformation.
  void record_undeformed()
  {
    std::vector<Point> nodes = curved_.nodes;
    std::vector<Node_state> states = states_;
    blend_interior(nodes, states, cell_blocks(), options_.degree);
    record(nodes, states, "curved");
  }

  void deform()
  {
    report_.deformation = run_stage("deform interior", report_.stages, progress_,
                                    [&] { return deform_mesh(curved_, states_, selection_, options_, progress_); });
    report_.blended_nodes = report_.deformation.moved_nodes + report_.deformation.blended_face_nodes;
  }

  void count_straight_cells()
  {
    report_.cells = curved_.cell_count();
    report_.straight_cells =
      run_stage("find straight cells", report_.stages, progress_, [&] { return update_straight_cells(curved_); });
  }

  Volume_mesh linear_;
  const Curving_options& options_;
  const Progress_callback& progress_;
  Curving_report report_;
  Mesh_structure structure_;
  Face_selection selection_;
  Boundary_surface surface_;
  Curved_mesh curved_;
  std::vector<Node_state> states_;
  Jacobian_recorder recorder_{report_.jacobians};
};

} // namespace

void check(const Curving_options& options)
{
  check_range("degree of the elements", options.degree, 1, max_degree);
  check_range("degree of the fits", options.fit_degree, 0, max_fit_degree);
  check_range("threads", options.threads, 0, 1 << 20);
  check(options.deformation);
  check(options.features);
  if (options.feature_edits)
    check(options.feature_edits->options);
}

Curved_mesh curve_mesh(Volume_mesh mesh, const Curving_options& options, Curving_report* report,
                       const Progress_callback& progress)
{
  check(options);
  std::optional<tbb::global_control> threads;
  if (options.threads > 0)
    threads.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(options.threads));

  const auto start = std::chrono::steady_clock::now();
  Conversion conversion(std::move(mesh), options, progress);
  Curved_mesh curved = conversion.run();
  if (report)
  {
    *report = std::move(conversion.report());
    report->seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    report->peak_memory_bytes = peak_memory_bytes();
  }
  return curved;
}

} // namespace recurve
