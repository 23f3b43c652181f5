#ifndef RECURVE_RUN_CURVING_REPORT_H
#define RECURVE_RUN_CURVING_REPORT_H

#include <recurve/features/feature_report.h>
#include <recurve/run/certification.h>
#include <recurve/run/curving_options.h>
#include <recurve/run/deformation_summary.h>
#include <recurve/run/jacobian_history.h>
#include <recurve/run/mesh_summary.h>
#include <recurve/run/stages.h>
#include <recurve/surface/reconstruction_report.h>

#include <cstdint>
#include <string>
#include <vector>

namespace recurve {

/// The farthest way of a node from its straight-sided to its curved position.
struct Largest_displacement
{
  double length = 0;   ///< in the unit of the mesh
  double relative = 0; ///< over the length of the node's edge, or of the longest edge of its face
  Point at = {};       ///< straight-sided position of the node
  std::string zone, patch;
};

/// A face whose fit has not the degree that was asked for.
struct Lowered_face
{
  std::string zone, patch;
  Index face = no_index; ///< of the zone
  Point center = {};
  int degree = 0; ///< of the fit it got; 0: the face stayed straight
  Lowering_reason reason = Lowering_reason::not_finite;
};

/// The curved patches as one surface. Edges and vertices that several edges and vertices of the surface stand on
/// (where it is no manifold) count once.
struct Surface_summary
{
  Index faces = 0, edges = 0;
  Index components = 0;        ///< connected parts
  Index closed_components = 0; ///< those without border
  Index border_edges = 0;      ///< edges of one face
  Index non_manifold_edges = 0, non_manifold_vertices = 0;
  Index repeated_faces = 0;  ///< faces left out, as another one is the same or its other side
  Index collapsed_faces = 0; ///< faces left out, as corners of theirs are one vertex
  Index turned_faces = 0;    ///< faces inside the volume that took their other side to fit their neighbours
  Index shared_edges = 0;    ///< edges that stand for several of the surface; they took the mean of what those ask for
  std::vector<std::string> notes; ///< the first few places where the surface is no manifold
};

/// What a conversion did, from reading to writing.
struct Curving_report
{
  std::string version; ///< of recurve
  Curving_options options;
  std::string input, output;      ///< files; empty if the mesh came from or went to memory
  std::vector<std::string> notes; ///< what reading had to decide or leave out

  Mesh_summary mesh;
  std::vector<Index> curved_faces; ///< per patch of `mesh`

  Surface_summary surface;
  Feature_report features;
  Reconstruction_report fits;
  std::vector<Lowered_face> lowered_faces; ///< in the order of `fits.lowerings`

  Index moved_edge_nodes = 0, moved_face_nodes = 0;   ///< on the surface
  Index blended_nodes = 0;                            ///< inside faces and cells, moved after the surface
  Deformation_summary deformation;                    ///< how they were moved
  Largest_displacement largest_displacement;          ///< by its length
  Largest_displacement largest_relative_displacement; ///< by its relation to the edge

  Index cells = 0, straight_cells = 0;
  Certification certification; ///< whether the cells are certified to be valid
  Jacobian_history jacobians;  ///< if `Curving_options::record_jacobians`

  std::vector<Stage_time> stages;
  double seconds = 0;
  std::int64_t peak_memory_bytes = 0; ///< of the process so far
};

/// the report as a JSON object; its keys are documented in doc/report.md and do not change within a version.
std::string to_json(const Curving_report& report);

/// largest memory that this process has held, in bytes.
std::int64_t peak_memory_bytes();

} // namespace recurve

#endif
