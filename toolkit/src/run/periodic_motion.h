#ifndef RECURVE_SRC_RUN_PERIODIC_MOTION_H
#define RECURVE_SRC_RUN_PERIODIC_MOTION_H

#include <recurve/mesh/curved_mesh.h>

#include <array>
#include <string>
#include <vector>

namespace recurve {

/// A rigid map: x -> rotation (x - center) + center + translation. A map without rotation leaves a displacement as it
/// is, to the bit.
struct Period
{
  bool is_translation = true;
  std::array<Point, 3> rotation = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}; ///< rows
  Point center = {};
  Point translation = {};

  Point image(const Point& position) const;
  Point image_of_displacement(const Point& displacement) const;
};

/// where the image of a node belongs that is displaced to `position`: its displacement is the image of the node's; and
/// where the straight-sided mesh is periodic to the bit, so is the curved one.
Point periodic_position(const Period& period, const Point& straight, const Point& straight_image,
                        const Point& position);

/// The nodes of two patches that a period maps to each other.
struct Periodic_nodes
{
  Period period;
  std::vector<std::array<Index, 2>> pairs; ///< node, its image
};

/// pairs the nodes of periodic patches: of the interfaces that the mesh calls periodic, and of the patches in `named`,
/// which are a translation apart.
/// \pre the corners of `mesh` are where the linear mesh has them.
/// \throws Input_error if a name of `named` is no patch, or its patches are no translation apart.
/// \par Complexity  O(n log n) in the faces of those patches.
std::vector<Periodic_nodes> find_periodic_nodes(const Curved_mesh& mesh,
                                                const std::vector<std::array<std::string, 2>>& named);

} // namespace recurve

#endif
