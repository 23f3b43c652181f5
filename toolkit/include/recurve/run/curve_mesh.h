#ifndef RECURVE_RUN_CURVE_MESH_H
#define RECURVE_RUN_CURVE_MESH_H

#include <recurve/core/progress.h>
#include <recurve/mesh/curved_mesh.h>
#include <recurve/run/curving_options.h>
#include <recurve/run/curving_report.h>

namespace recurve {

/// gives a straight-sided mesh its curves back: the whole conversion, from a linear mesh in memory to a curved one.
///
/// The zones are joined where they touch, the selected patches of all zones become one surface, its features are found,
/// polynomials fitted and the nodes of degree `options.degree` placed on edges and faces; planar
/// patches follow their rim in their plane and all layers of cells the surface (`options.deform`; without it, only
/// cells at the surface are bent). Corners never move, and a cell none of whose nodes moved is marked straight and has
/// each node where the straight-sided cell has it, to the bit. The rim of a curved patch is a feature curve, also where
/// a patch that is kept begins: the first faces of that one follow the rim, a planar one within its plane. An edge
/// where more than two curved faces meet takes the mean of what the faces ask for.
///
/// Nothing depends on the unit or the place of the mesh. The result is the same, bit by bit, for any number of threads.
///
/// \param mesh      linear mesh, as read_mesh() gives it; kept in `Curved_mesh::linear`, with its faces completed and
///                  oriented as find_boundary_faces() does. Cells with inverted corner order are turned.
/// \param report    what happened; mesh, patches, features, fits, displacements, seconds per stage.
/// \param progress  called with the stages in the order of `Curving_report::stages`.
/// \throws Input_error if an option is out of range, a patch unknown or the mesh broken; Cancelled.
/// \par Complexity  O(n log n) in the cells.
/// \par Source      Ims & Wang 2018.
Curved_mesh curve_mesh(Volume_mesh mesh, const Curving_options& options = {}, Curving_report* report = nullptr,
                       const Progress_callback& progress = {});

} // namespace recurve

#endif
