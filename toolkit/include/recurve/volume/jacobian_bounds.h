#ifndef RECURVE_VOLUME_JACOBIAN_BOUNDS_H
#define RECURVE_VOLUME_JACOBIAN_BOUNDS_H

#include <recurve/core/types.h>
#include <recurve/elements/element.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <tuple>

namespace recurve {

/// What is proven about the determinant of an element's Jacobian matrix, det J.
enum class Validity : std::uint8_t
{
  valid,    ///< det J > 0 everywhere in the closed element
  invalid,  ///< det J <= 0 at some point of it
  undecided ///< neither was shown within the limits of `Jacobian_options`; whoever promises validity counts it as
            ///< invalid
};

/// How long `bound_jacobian()` tries.
struct Jacobian_options
{
  /// Bisections after which a part of an element is not divided further. 60 are 20 along each direction, so that a part
  /// is 1e-6 long and the bounds are 1e-12 apart.
  int max_depth = 60;

  /// Parts of one element that are examined before it is given up as undecided: in floating point, and in exact
  /// arithmetic, which costs a hundred times more.
  int max_parts = 20000;
  int max_exact_parts = 300;

  /// Subdivision stops when the verdict is known. If this is finite, it also goes on until `lower` is within this
  /// fraction of the largest |det J| from the smallest det J, or a limit is reached.
  double sharpness = std::numeric_limits<double>::infinity();
};

/// Certified bounds of det J of one element with respect to its reference element, in the third power of the unit of
/// the points; the reference elements have the volumes 1/6 (tetrahedron), 1/3 (pyramid), 1/2 (prism) and 1
/// (hexahedron). On a pyramid the values at the apex are the limits along straight lines.
struct Jacobian_bounds
{
  double lower = -std::numeric_limits<double>::infinity(); ///< det J is nowhere smaller
  double upper = std::numeric_limits<double>::infinity();  ///< det J is nowhere larger
  double reached =
    std::numeric_limits<double>::infinity(); ///< det J is at most this somewhere: smallest in [lower, reached]
  double scaled = -1; ///< lower / max(upper, -lower), in [-1, 1]. If positive, det J is nowhere smaller than this times
                      ///< its maximum
  Validity verdict = Validity::undecided;
  bool is_subdivided = false; ///< whether the coefficients of the whole element did not decide
  bool is_exact = false;      ///< whether exact arithmetic was needed
};

/// An element that stands out.
struct Extreme_element
{
  double scaled = std::numeric_limits<double>::infinity(); ///< its `Jacobian_bounds::scaled`; infinite: there is none
  Index block = no_index;                                  ///< number of its block in the call
  Index element = no_index;                                ///< its number in the block
  Point position = {};                                     ///< mean of its corners

  /// Which of two counts does not depend on the order of elements.
  bool operator<(const Extreme_element& other) const
  {
    return std::tie(scaled, block, element) < std::tie(other.scaled, other.block, other.element);
  }
};

/// What `bound_jacobians()` found.
struct Jacobian_report
{
  struct Verdicts
  {
    Index valid = 0;
    Index invalid = 0;
    Index undecided = 0;
  };

  static constexpr std::size_t bin_count = 20;

  std::array<Verdicts, all_element_types.size()> by_type = {}; ///< by number of the `Element_type`
  Index straight_elements = 0;                                 ///< that took the test of degree 1
  Index subdivided_elements = 0;
  Index exact_elements = 0;                    ///< that needed exact arithmetic
  std::array<Index, bin_count> histogram = {}; ///< of `scaled` of the valid elements, in equal bins from 0 to 1
  Extreme_element least_valid;                 ///< the valid element with the smallest certified scaled Jacobian
  Extreme_element least;                       ///< the same of all elements

  Verdicts& of(Element_type type) { return by_type[static_cast<std::size_t>(type)]; }
  const Verdicts& of(Element_type type) const { return by_type[static_cast<std::size_t>(type)]; }

  /// the sum over all types.
  Verdicts total() const
  {
    Verdicts sum;
    for (const Verdicts& v : by_type)
    {
      sum.valid += v.valid;
      sum.invalid += v.invalid;
      sum.undecided += v.undecided;
    }
    return sum;
  }

  Jacobian_report& operator+=(const Jacobian_report& other)
  {
    for (std::size_t t = 0; t < by_type.size(); ++t)
    {
      by_type[t].valid += other.by_type[t].valid;
      by_type[t].invalid += other.by_type[t].invalid;
      by_type[t].undecided += other.by_type[t].undecided;
    }
    straight_elements += other.straight_elements;
    subdivided_elements += other.subdivided_elements;
    exact_elements += other.exact_elements;
    for (std::size_t b = 0; b < bin_count; ++b)
      histogram[b] += other.histogram[b];
    least_valid = std::min(least_valid, other.least_valid);
    least = std::min(least, other.least);
    return *this;
  }
};

} // namespace recurve

#endif
