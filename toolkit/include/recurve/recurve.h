#ifndef RECURVE_RECURVE_H
#define RECURVE_RECURVE_H

/// All passes at once, for the impatient. A single header compiles faster; `run/curve_mesh.h` has the whole conversion
/// compiled already.

#include <recurve/features/detect_features.h>
#include <recurve/features/edit_features.h>
#include <recurve/features/feature_curves.h>
#include <recurve/surface/curve_surface.h>
#include <recurve/surface/reconstruct_surface.h>
#include <recurve/volume/blend_interior.h>
#include <recurve/volume/bound_jacobian.h>
#include <recurve/volume/deform_interior.h>
#include <recurve/volume/restore_validity.h>

#endif
