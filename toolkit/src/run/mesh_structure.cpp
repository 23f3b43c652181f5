#include <recurve/run/mesh_structure.h>

#include <recurve/mesh/check_mesh.h>

namespace recurve {

Mesh_structure find_structure(Volume_mesh& mesh, const Join_options& options, std::vector<Stage_time>& times,
                              const Progress_callback& progress)
{
  Mesh_structure structure;
  structure.orientation = run_stage("check cells", times, progress, [&] {
    check_mesh(mesh);
    return orient_cells(mesh);
  });
  structure.joined = run_stage("join zones", times, progress, [&] { return join_zones(mesh, options); });
  structure.boundary =
    run_stage("find boundary", times, progress, [&] { return find_boundary_faces(mesh, structure.joined); });
  return structure;
}

} // namespace recurve
