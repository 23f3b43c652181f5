#ifndef RECURVE_SRC_RUN_SURFACE_PASSES_H
#define RECURVE_SRC_RUN_SURFACE_PASSES_H

#include "node_placement.h"

#include <recurve/core/progress.h>
#include <recurve/mesh/boundary_surface.h>
#include <recurve/mesh/join_zones.h>
#include <recurve/run/curving_report.h>
#include <recurve/run/list_features.h>

namespace recurve {

// The passes over the surface, for the one graph type of the program. They are templates that take long to compile;
// here they are compiled once.

/// stages "detect features" and, if there are any, "edit features": fills `edge_is_critical` and `vertex_is_sharp` of
/// `surface`, and the report.
void find_features(Boundary_surface& surface, const Volume_mesh& mesh, const Joined_zones& joined,
                   const Curving_options& options, Curving_report& report, const Progress_callback& progress);

/// fills curves, sharp points and file of `listing` from the flags of `surface`, and its `vertex_is_critical`.
void list_curves(Boundary_surface& surface, const Volume_mesh& mesh, const Feature_edit_options& options,
                 Feature_listing& listing);

/// stages "reconstruct surface" and "curve surface": fits polynomials and puts the nodes, and fills the report.
void place_surface_nodes(const Boundary_surface& surface, const Curving_options& options, Node_placement& placement,
                         Curving_report& report, const Progress_callback& progress);

} // namespace recurve

#endif
