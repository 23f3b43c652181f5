#ifndef RECURVE_SRC_RUN_SURFACE_PASSES_H
#define RECURVE_SRC_RUN_SURFACE_PASSES_H

#include "node_placement.h"

#include <recurve/core/progress.h>
#include <recurve/mesh/boundary_surface.h>
#include <recurve/run/curving_report.h>

namespace recurve {

// The passes over the surface, for the one graph type of the program. They are templates that take long to compile;
// here they are compiled once.

/// stage "detect features": fills `edge_is_critical` and `vertex_is_sharp` of `surface`, and the report.
void find_features(Boundary_surface& surface, const Curving_options& options, Curving_report& report,
                   const Progress_callback& progress);

/// stages "reconstruct surface" and "curve surface": fits polynomials and puts the nodes, and fills the report.
void place_surface_nodes(const Boundary_surface& surface, const Curving_options& options, Node_placement& placement,
                         Curving_report& report, const Progress_callback& progress);

} // namespace recurve

#endif
