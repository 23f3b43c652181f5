#ifndef RECURVE_RUN_CURVE_SURFACE_MESH_H
#define RECURVE_RUN_CURVE_SURFACE_MESH_H

#include <recurve/core/progress.h>
#include <recurve/features/feature_report.h>
#include <recurve/mesh/boundary_surface.h>
#include <recurve/mesh/curved_mesh.h>
#include <recurve/run/curving_options.h>
#include <recurve/surface/curving_surface_report.h>
#include <recurve/surface/reconstruction_report.h>

#include <filesystem>

namespace recurve {

/// What a conversion of a surface mesh did.
struct Surface_mesh_report
{
  Feature_report features;
  Reconstruction_report fits;
  Curving_surface_report curving;
};

/// whether the extension of `file` is that of a surface mesh: off, obj, ply or stl.
bool is_surface_file(const std::filesystem::path& file);

/// reads a surface of triangles and quadrangles. \throws Format_error if the file cannot be read or its faces do not
/// form a manifold; Input_error if a face has five or more corners.
Boundary_surface::Mesh read_surface_mesh(const std::filesystem::path& file);

/// curves a surface without a volume: detects its features, fits it and places nodes of degree `options.degree`. Of the
/// options those of degrees, fits, features and threads count.
///
/// The result has one zone without cells, whose faces (first triangles, then quadrangles, each in the order of `mesh`)
/// are in the patch "surface"; borders are feature curves. `write_mesh()` writes it as VTU.
/// \throws Input_error if a field of `options` is out of its range; Cancelled if the progress callback asks to stop.
/// \par Complexity  linear in the nodes.
Curved_mesh curve_surface_mesh(const Boundary_surface::Mesh& mesh, const Curving_options& options = {},
                               Surface_mesh_report* report = nullptr, const Progress_callback& progress = {});

} // namespace recurve

#endif
