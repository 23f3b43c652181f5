#ifndef RECURVE_DATA_GENERATE_SPHERE_IN_BOX_H
#define RECURVE_DATA_GENERATE_SPHERE_IN_BOX_H

#include <recurve/mesh/volume_mesh.h>

namespace recurve::generate {

enum class Sphere_cells
{
  tetrahedra, ///< by TetGen, around a subdivided icosahedron
  hexahedra,  ///< shells of a cubed sphere; the other types split these cells
  prisms,
  pyramids,
  mixed ///< hexahedra along x, prisms along y, pyramids along z, these as two tetrahedra each where their base is in a
        ///< patch
};

struct Sphere_mesh_options
{
  Sphere_cells cells = Sphere_cells::hexahedra;
  double radius = 0.5;
  double half_side = 2;   ///< of the box
  int segments = 6;       ///< along each edge of the six blocks of the cubed sphere, and of the box
  int layers = 6;         ///< of cells between sphere and box; not for tetrahedra
  double growth = 1.3;    ///< of the thickness from a layer to the next; not for tetrahedra
  double first_layer = 0; ///< height of the cells at the sphere, above the middles of the blocks; the others grow
                          ///< geometrically, whatever `growth` says. 0: by `growth`
  int subdivisions = 2;   ///< of the icosahedron: 20 * 4^subdivisions triangles; only for tetrahedra
  double radius_edge_ratio = 1.6; ///< see fill_with_tetrahedra()
};

/// the space between the sphere of radius `radius` around the origin and the box |x|, |y|, |z| <= half_side. Patches
/// sphere, box. Points of the patch sphere have |x| = radius to round-off, points of the box are on it exactly.
Volume_mesh sphere_in_box(const Sphere_mesh_options& options = {});

} // namespace recurve::generate

#endif
