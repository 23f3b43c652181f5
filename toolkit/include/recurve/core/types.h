#ifndef RECURVE_CORE_TYPES_H
#define RECURVE_CORE_TYPES_H

#include <array>
#include <cstdint>

namespace recurve {

/// Number of a node, vertex, face, cell, ...; always counted from 0. 64 bits, since meshes outgrow 2^31.
using Index = std::int64_t;

/// "none" as an Index.
inline constexpr Index no_index = -1;

/// Position or displacement in space, in the unit of the mesh. The passes take any CGAL point; meshes on disk and
/// in `Volume_mesh` are plain arrays of these.
using Point = std::array<double, 3>;

} // namespace recurve

#endif
