#ifndef RECURVE_DATA_GENERATE_CYLINDER_LAYER_H
#define RECURVE_DATA_GENERATE_CYLINDER_LAYER_H

#include <recurve/mesh/volume_mesh.h>

namespace recurve::generate {

struct Cylinder_mesh_options
{
  double radius = 0.5;
  double far_radius = 5;
  double length = 1;          ///< along z, from z = 0
  int around = 24;            ///< cells around the cylinder
  int along = 3;              ///< cells along z
  int layers = 20;            ///< cells from the cylinder to the far field
  double first_layer = 0.004; ///< height of the cells at the cylinder; the others grow geometrically
  bool has_prisms = false;    ///< two prisms, which stand on the wall, instead of each hexahedron
};

/// hexahedra, or prisms, around a cylinder, in layers that are thin at its wall. Patches cylinder (x^2 + y^2 =
/// radius^2), farfield (x^2 + y^2 = far_radius^2), z_low (z = 0), z_high (z = length). The sagitta of the wall, radius
/// (1 - cos(pi / around)), is 0.0043 by default, more than the height of the first cells: curving the wall alone turns
/// them inside out.
Volume_mesh cylinder_layer(const Cylinder_mesh_options& options = {});

} // namespace recurve::generate

#endif
