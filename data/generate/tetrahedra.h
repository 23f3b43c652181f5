#ifndef RECURVE_DATA_GENERATE_TETRAHEDRA_H
#define RECURVE_DATA_GENERATE_TETRAHEDRA_H

#include <recurve/mesh/volume_mesh.h>

#include <array>
#include <string>
#include <vector>

namespace recurve::generate {

/// Name of a patch and what it is, by the name of a CGNS BCType.
struct Named_patch
{
  std::string name;
  std::string kind;
};

/// Closed surface of triangles in named patches, the boundary of what is to be filled with tetrahedra.
struct Triangulated_boundary
{
  std::vector<Point> points;
  std::vector<std::array<Index, 3>> triangles;
  std::vector<int> patch_of_triangle; ///< number in `patches`
  std::vector<Named_patch> patches;
  std::vector<Point> holes; ///< a point inside each cavity that stays empty

  void add_triangle(int patch, Index a, Index b, Index c);

  /// adds the quadrangle a, b, c, d as two triangles that share the diagonal a-c.
  void add_quadrangle(int patch, Index a, Index b, Index c, Index d);
};

/// fills a boundary with tetrahedra by TetGen. The boundary keeps its points and triangles; points are added inside
/// only. \param radius_edge_ratio  bound on circumradius / shortest edge where the boundary allows it, > 1 \throws
/// Input_error if TetGen fails, as it does on a boundary that intersects itself.
Volume_mesh fill_with_tetrahedra(const Triangulated_boundary& boundary, const std::string& zone_name,
                                 double radius_edge_ratio);

} // namespace recurve::generate

#endif
