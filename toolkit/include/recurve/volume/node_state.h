#ifndef RECURVE_VOLUME_NODE_STATE_H
#define RECURVE_VOLUME_NODE_STATE_H

#include <cstdint>

namespace recurve {

/// How a node came to stand where it stands. Whether a node has moved is decided by its state, never by subtracting
/// positions: rounding must not make a straight cell look curved.
enum class Node_state : std::uint8_t
{
  straight, ///< where the straight-sided element has it; may be moved
  fixed,    ///< there as well, and has to stay
  placed,   ///< has its final position on a curved edge or face
  blended   ///< was moved inside its face or cell after placed nodes
};

/// Whether the node has left its straight position.
constexpr bool is_displaced(Node_state state)
{
  return state == Node_state::placed || state == Node_state::blended;
}

} // namespace recurve

#endif
