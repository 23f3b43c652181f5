#ifndef RECURVE_IO_GROUPED_MESH_H
#define RECURVE_IO_GROUPED_MESH_H

#include <recurve/io/zonal_mesh.h>

#include <string>
#include <utility>
#include <vector>

namespace recurve::internal {

/// Elements of one type that belong to one zone or patch.
struct Element_group
{
  Index owner = no_index; ///< zone of cells; patch of faces, no_index: in none
  std::string name;       ///< of the section
  Element_type type = Element_type::tetrahedron;
  std::vector<Index> nodes; ///< node_count(type, degree) per element, canonical order
};

/// Pairs of nodes that a rigid map takes onto each other.
struct Periodic_nodes
{
  std::vector<std::pair<Index, Index>> pairs; ///< node, and where `map` takes it
  Periodicity map;
};

/// A mesh of a format with one list of nodes for everything: Gmsh, SU2, UGRID, VTU, HOPR.
struct Grouped_mesh
{
  int degree = 1;
  std::vector<Point> nodes;
  std::vector<std::string> zone_names;
  std::vector<Patch> patches; ///< names, kinds and families; faces stay empty
  std::vector<Element_group> cells, faces;
  std::vector<Periodic_nodes> periodic;
  std::vector<Family> families;
};

/// gives each zone its nodes and its faces: those of its cells; a face between two zones goes to the first. Zones that
/// share nodes get an interface that says so. Notes tell what is left out: faces of no cell, empty groups, nodes that
/// no element uses (where there are several zones).
Zonal_mesh to_zonal_mesh(Grouped_mesh mesh, std::vector<std::string>& notes);

} // namespace recurve::internal

#endif
