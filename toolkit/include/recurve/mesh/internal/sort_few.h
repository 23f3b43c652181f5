#ifndef RECURVE_MESH_INTERNAL_SORT_FEW_H
#define RECURVE_MESH_INTERNAL_SORT_FEW_H

#include <recurve/core/types.h>

#include <array>
#include <utility>

namespace recurve::internal {

/// sorts the first `count` of four numbers. Insertion, since general sorting is slow for so few (and makes GCC 12 warn
/// of indices that it will never use).
inline void sort_few(std::array<Index, 4>& values, int count)
{
  for (int i = 1; i < count && i < 4; ++i)
    for (int j = i; j > 0 && values[j] < values[j - 1]; --j)
      std::swap(values[j], values[j - 1]);
}

} // namespace recurve::internal

#endif
