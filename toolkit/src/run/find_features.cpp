#include "surface_passes.h"

#include <recurve/features/detect_features.h>

namespace recurve {

namespace {

/// Without features only the borders of the surface are critical.
Feature_report take_borders(Boundary_surface& surface)
{
  Feature_report report;
  for (Boundary_surface::Edge edge : surface.mesh.edges())
  {
    surface.edge_is_critical[edge] = surface.edge_is_pinned[edge];
    ++report.edges;
    report.critical_edges += surface.edge_is_pinned[edge];
  }
  report.pinned_edges = report.critical_edges;
  for (Boundary_surface::Vertex vertex : surface.mesh.vertices())
    surface.vertex_is_sharp[vertex] = 0;
  return report;
}

} // namespace

void find_features(Boundary_surface& surface, const Curving_options& options, Curving_report& report,
                   const Progress_callback& progress)
{
  report.features = run_stage("detect features", report.stages, progress, [&] {
    if (!options.detect_features)
      return take_borders(surface);
    return detect_features(surface.mesh, surface.edge_is_critical, surface.vertex_is_sharp, options.features,
                           CGAL::parameters::edge_is_constrained_map(surface.edge_is_pinned));
  });
}

} // namespace recurve
