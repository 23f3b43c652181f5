#ifndef RECURVE_IO_CGNS_WRITING_H
#define RECURVE_IO_CGNS_WRITING_H

#include <recurve/core/progress.h>
#include <recurve/core/types.h>
#include <recurve/mesh/curved_mesh.h>

#include <filesystem>
#include <limits>

namespace recurve::internal {

/// Limits of the file that a test may lower.
struct Cgns_write_limits
{
  Index section_entries =
    std::numeric_limits<std::int32_t>::max(); ///< node numbers in one section: 32-bit sizes of libcgns
  Index piece = Index(1) << 20;               ///< entries that are converted and written at a time
};

/// what `write_cgns()` does.
void write_cgns_within(const Curved_mesh& mesh, const std::filesystem::path& file, const Progress_callback& progress,
                       const Cgns_write_limits& limits);

} // namespace recurve::internal

#endif
