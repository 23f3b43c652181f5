#ifndef RECURVE_MESH_CURVED_MESH_H
#define RECURVE_MESH_CURVED_MESH_H

#include <recurve/mesh/join_zones.h>
#include <recurve/mesh/volume_mesh.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace recurve {

/// Elements of one type and of the degree of their mesh.
struct Curved_section
{
  std::string name;
  Element_type type = Element_type::tetrahedron;
  std::vector<Index> nodes; ///< node_count(type, degree) per element, canonical order, numbers of nodes of the mesh
};

/// One zone of a curved mesh. Its sections stand in the order of the linear zone's, element by element.
struct Curved_zone
{
  std::vector<Index> nodes; ///< nodes of the mesh that the zone uses: first those of its linear points, in their order
                            ///< (also unused ones), then the others, ascending
  std::vector<Curved_section> cells;
  std::vector<Curved_section> faces;
  std::vector<Curved_section> bars;
  std::vector<std::uint8_t>
    is_straight; ///< per cell of the zone: every node where the straight cell has it, to the bit
};

/// High-order mesh: nodes that are unique across zones, and per zone the nodes of each element. What the linear mesh
/// says beyond points and elements (names, patches, families, interfaces, units) stays in `linear`, the mesh that was
/// curved.
struct Curved_mesh
{
  int degree = 1;
  std::vector<Point> nodes;
  std::vector<Curved_zone> zones; ///< parallel to linear.zones
  Volume_mesh linear;

  Index cell_count() const;
};

/// raises a linear mesh to degree `degree`: every node of every element is put where the straight-sided element has it
/// (interpolated from the corners). Nodes 0 .. vertex_count-1 are the joined vertices of `joined`; nodes on edges,
/// faces and in cells follow, each once, however many zones share it. An edge of a collapsed cell whose two corners are
/// one vertex has its nodes at that vertex too. The result is independent of the number of threads.
///
/// Pass the mesh by `std::move`: it is kept in the result, not copied.
/// \throws Input_error if `degree` is outside [1, max_degree] or `joined` does not belong to `linear`.
/// \par Complexity  O(n log n) in the cells; memory beyond the result and the mesh: 8 bytes for each edge of each cell.
Curved_mesh elevate(Volume_mesh linear, const Joined_zones& joined, int degree);

/// computes where the straight-sided element with the nodes `nodes` has them, with the very arithmetic of `elevate()`,
/// so that comparing bits tells whether an element is straight. \param nodes      node numbers of one element,
/// canonical order; the corners first. \param points     positions by node number; only those of the corners are read.
/// \param positions  result, one per node. \pre as many as `nodes`, node_count(type, degree)
void straight_nodes(Element_type type, int degree, std::span<const Index> nodes, std::span<const Point> points,
                    std::span<Point> positions);

/// finds anew which cells are straight (`Curved_zone::is_straight`), after nodes have moved. Returns how many are.
/// \par Complexity  linear in the nodes of cells, in parallel.
Index update_straight_cells(Curved_mesh& mesh);

} // namespace recurve

#endif
