#ifndef RECURVE_SRC_RUN_RECORD_JACOBIANS_H
#define RECURVE_SRC_RUN_RECORD_JACOBIANS_H

#include <recurve/mesh/curved_mesh.h>
#include <recurve/run/jacobian_history.h>
#include <recurve/volume/node_state.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace recurve {

/// Bounds the Jacobians of a mesh again and again, and remembers which cells were wrong from the start.
class Jacobian_recorder
{
public:
  explicit Jacobian_recorder(Jacobian_history& history) : history_(history) {}

  /// records the straight-sided cells of `mesh`, whose corners are in place.
  void record_straight(const Curved_mesh& mesh);

  /// records the cells with their nodes at `nodes`. \param states  per node; a cell without a displaced node is
  /// straight
  void record(const Curved_mesh& mesh, std::span<const Point> nodes, std::span<const Node_state> states,
              std::string name);

private:
  template <class IsStraight>
  void add_stage(const Curved_mesh& mesh, std::span<const Point> nodes, std::string name,
                 const IsStraight& is_straight);

  Jacobian_history& history_;
  std::vector<std::uint8_t> is_wrong_; ///< per cell, whether its straight-sided self is not certified valid
};

} // namespace recurve

#endif
