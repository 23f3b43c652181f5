#ifndef RECURVE_SRC_RUN_EDIT_PASSES_H
#define RECURVE_SRC_RUN_EDIT_PASSES_H

#include "surface_passes.h"

#include <vector>

namespace recurve {

/// find_features(), which also tells in `applied` what each edit did.
void find_features(Boundary_surface& surface, const Volume_mesh& mesh, const Joined_zones& joined,
                   const Curving_options& options, Curving_report& report, std::vector<Applied_edit>& applied,
                   const Progress_callback& progress);

} // namespace recurve

#endif
