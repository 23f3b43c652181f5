#ifndef RECURVE_VOLUME_INTERNAL_UNTANGLE_H
#define RECURVE_VOLUME_INTERNAL_UNTANGLE_H

#include <recurve/volume/internal/repair_component.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace recurve::internal {

/// minimises with less and less regularisation until `is_done()`, or until it gets no better. Returns whether it is.
/// \param enough  smallest determinant, relative to the straight cells, that calls for no further improvement.
template <class IsDone>
bool untangle(Repair_component& repair, const IsDone& is_done, double enough = std::numeric_limits<double>::infinity())
{
  constexpr int stages = 10, steps = 20;
  constexpr double smallest = 1e-6; // of the regularisation, in units of det F of a rigid motion
  constexpr double share = 0.2;     // of the worst negative determinant, as in the source
  constexpr double hopeless = -10;  // turned over ten times: to be reduced first
  int idle = 0;
  double least = repair.least_determinant();
  if (!(least > hopeless))
    return false;
  for (int stage = 0; stage < stages && idle < 2; ++stage)
  {
    const double negative = share * std::min(least, 0.0);
    const double reached = repair.minimise(std::sqrt(smallest * smallest + negative * negative), steps);
    if (reached > 0 && is_done())
    {
      if (reached >= enough)
        return true;
      // They may be valid by a hair: the objective as it is meant carries them further from the edge.
      const std::vector<Point> valid = repair.displacements();
      if (!(repair.minimise(smallest, steps) >= reached && is_done()))
        repair.displace(valid);
      return true;
    }
    idle = reached > least + 0.02 * std::abs(least) ? 0 : idle + 1;
    least = reached;
  }
  return false;
}

} // namespace recurve::internal

#endif
