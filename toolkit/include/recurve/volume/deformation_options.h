#ifndef RECURVE_VOLUME_DEFORMATION_OPTIONS_H
#define RECURVE_VOLUME_DEFORMATION_OPTIONS_H

#include <recurve/core/progress.h>
#include <recurve/core/types.h>

#include <algorithm>
#include <cstdint>

namespace recurve {

/// How the sums over the sources are computed.
enum class Summation : std::uint8_t
{
  automatic, ///< whichever is estimated to be faster
  plain,     ///< every source for every target, in double precision: no error but rounding
  fast       ///< by a tree, with an error up to `Summation_options::error_bound`
};

/// What an `Interior_deformer` may vary.
struct Summation_options
{
  Summation method = Summation::automatic;

  /// Largest error of a displacement, relative to the largest displacement of a source. Guaranteed, whatever the field;
  /// what happens is usually a tenth to a hundredth of it. Between 1e-9 and 1; smaller: `plain`.
  double error_bound = 1e-4;

  /// Distance from the nearest moving source beyond which a target stays exactly where it is, in the unit of the
  /// points; from half of it on, the motion fades. 0: no limit.
  double reach = 0;

  Progress_callback progress = {}; ///< stage "deform": the part of the targets that is done
};

/// What `deform_interior()` may vary: the paper's formula w = (L/r)^a + (alpha L/r)^b, and how it is summed.
struct Deformation_options
{
  double length = 0;  ///< L, in the unit of the points: the mean edge length of the active surface; has to be positive
  double alpha = 0.9; ///< weight of the near part
  double a = 3;       ///< exponent of the far part
  double b = 5;       ///< exponent of the near part
  Summation_options summation = {};
};

/// What a deformation did.
struct Deformation_report
{
  Index sources = 0;
  Index moving_sources = 0; ///< those with a displacement other than zero
  Index targets = 0;
  Index moved_targets = 0;         ///< those whose displacement is not exactly zero
  double largest_displacement = 0; ///< of a target, in the unit of the points
  double largest_given = 0;        ///< of a source
  double error_bound = 0;          ///< guaranteed for this field and these points, relative to `largest_given`
  bool is_fast = false;            ///< whether the tree was used
  Index pairs = 0;                 ///< of a source and a target that were summed directly
  Index translations = 0;          ///< expansions of a cell of sources in a cell of targets, or at a single one

  Deformation_report& operator+=(const Deformation_report& other)
  {
    sources = std::max(sources, other.sources);
    moving_sources = std::max(moving_sources, other.moving_sources);
    targets += other.targets;
    moved_targets += other.moved_targets;
    largest_displacement = std::max(largest_displacement, other.largest_displacement);
    largest_given = std::max(largest_given, other.largest_given);
    error_bound = std::max(error_bound, other.error_bound);
    is_fast = is_fast || other.is_fast;
    pairs += other.pairs;
    translations += other.translations;
    return *this;
  }
};

} // namespace recurve

#endif
