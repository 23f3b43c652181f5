#ifndef RECURVE_SURFACE_INTERNAL_NUMBER_PAIR_H
#define RECURVE_SURFACE_INTERNAL_NUMBER_PAIR_H

#include <cstring>

namespace recurve::internal::surface {

/// Two numbers that the processor handles at a time.
using Number_pair [[gnu::vector_size(2 * sizeof(double))]] = double;

inline Number_pair load_pair(const double* values)
{
  Number_pair pair;
  std::memcpy(&pair, values, sizeof(pair));
  return pair;
}

inline void store_pair(const Number_pair& pair, double* values)
{
  std::memcpy(values, &pair, sizeof(pair));
}

} // namespace recurve::internal::surface

#endif
