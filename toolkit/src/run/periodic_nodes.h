#ifndef RECURVE_SRC_RUN_PERIODIC_NODES_H
#define RECURVE_SRC_RUN_PERIODIC_NODES_H

#include <recurve/mesh/curved_mesh.h>

#include <array>
#include <vector>

namespace recurve {

/// pairs of nodes on the two sides of the periodic interfaces that the mesh states: corners that it pairs, and the
/// nodes inside edges and faces whose corners are paired. Nodes inside one edge (or face) are paired with those inside
/// its partner in some order.
std::vector<std::array<Index, 2>> periodic_nodes(const Curved_mesh& mesh);

} // namespace recurve

#endif
