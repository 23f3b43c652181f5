#ifndef RECURVE_RUN_MESH_SUMMARY_H
#define RECURVE_RUN_MESH_SUMMARY_H

#include <recurve/mesh/volume_mesh.h>
#include <recurve/run/mesh_structure.h>

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace recurve {

/// Where the faces of a patch lie.
enum class Patch_place : std::uint8_t
{
  boundary,  ///< on the boundary of the mesh: one cell behind each face
  internal,  ///< between two cells of one zone
  interface, ///< between cells of two zones
  mixed,     ///< some here, some there
  nowhere    ///< no face of the patch belongs to a cell
};

/// "boundary", "internal", ...
std::string_view to_string(Patch_place place);

/// One patch of one zone.
struct Patch_summary
{
  std::string zone, name;
  std::string kind;   ///< CGNS BCType name
  std::string family; ///< or empty
  Index triangles = 0, quadrangles = 0;
  Patch_place place = Patch_place::boundary;
};

/// One zone-to-zone connection as the file states it.
struct Interface_summary
{
  std::string zone, name, donor_zone;
  Index points = 0; ///< pairs of points or faces
  bool is_abutting_one_to_one = true;
  bool is_periodic = false;
};

/// One zone.
struct Zone_summary
{
  std::string name, family;
  Index points = 0;
  std::array<Index, all_element_types.size()> cells = {}; ///< by Element_type
};

/// What a mesh consists of: what `recurve info` prints and what every report starts with.
struct Mesh_summary
{
  std::string name;
  std::vector<Zone_summary> zones;
  std::vector<Patch_summary> patches;        ///< in the order of zones
  std::vector<Interface_summary> interfaces; ///< in the order of zones
  std::vector<Joined_pair> joined_zones;
  Orientation_report orientation; ///< of the cells as they came
  Boundary_report boundary;
  Point smallest = {}, largest = {}; ///< bounding box of all points

  Index point_count() const;
  Index cell_count() const;
  Index cell_count(Element_type type) const;
};

/// counts what is in `mesh`. \pre `structure` is what find_structure() gave for the mesh
Mesh_summary summarize(const Volume_mesh& mesh, const Mesh_structure& structure);

/// the summary as a JSON object, documented in doc/report.md.
std::string to_json(const Mesh_summary& summary);

} // namespace recurve

#endif
