#ifndef RECURVE_RUN_JACOBIAN_HISTORY_H
#define RECURVE_RUN_JACOBIAN_HISTORY_H

#include <recurve/core/types.h>
#include <recurve/volume/jacobian_bounds.h>

#include <cstdint>
#include <string>
#include <vector>

namespace recurve {

/// The certified Jacobians of all cells at one point of a conversion.
struct Jacobian_stage
{
  std::string name; ///< "straight", "curved" (without deformation), "deformed", "certified"
  Jacobian_report bounds;
  Index inverted = 0;     ///< cells that are not certified valid, though the straight-sided cell is
  Index wrong_before = 0; ///< cells that are not certified valid and were not when straight
};

/// How the cells fared.
struct Jacobian_history
{
  std::vector<Jacobian_stage> stages; ///< in the order of the conversion; empty: nobody asked
};

enum class Picture_format : std::uint8_t
{
  svg,
  png
};

/// draws the histograms of the scaled Jacobian, all stages side by side, counts on a logarithmic scale. \return the
/// bytes of the picture's file. \throws Input_error if there are no stages.
std::string draw_histogram(const Jacobian_history& history, Picture_format format);

} // namespace recurve

#endif
