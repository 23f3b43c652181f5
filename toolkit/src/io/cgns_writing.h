#ifndef RECURVE_IO_CGNS_WRITING_H
#define RECURVE_IO_CGNS_WRITING_H

#include <recurve/core/progress.h>
#include <recurve/core/types.h>
#include <recurve/mesh/curved_mesh.h>

#include <filesystem>
#include <limits>
#include <vector>

namespace recurve::internal::cgns {

/// Limits of the file that a test may lower.
struct Cgns_write_limits
{
  Index section_entries =
    std::numeric_limits<std::int32_t>::max(); ///< node numbers in one section: 32-bit sizes of libcgns
  Index piece = Index(1) << 20;               ///< entries that are converted and written at a time
};

/// CGNS has complete element families up to quartic ones.
inline constexpr int largest_cgns_degree = 4;

Index element_count(const std::vector<Curved_section>& sections, int degree);

/// number of coordinates and node numbers that a file of `mesh` holds: the work of writing it.
Index entry_count(const Curved_mesh& mesh);

/// \throws Input_error for what CGNS cannot hold: its degree, or more nodes or elements in a zone than 32 bits count.
void check_writable(const Curved_mesh& mesh);

/// an upper bound of the size of a file of `mesh`.
Index largest_file_size(const Curved_mesh& mesh);

/// reads the tree of the finished file back: libcgns drops some of the errors that HDF5 reports while it closes arrays.
/// \throws Format_error if something is missing.
void check_written(const Curved_mesh& mesh, const std::filesystem::path& file);

/// what `write_cgns()` does.
void write_cgns_within(const Curved_mesh& mesh, const std::filesystem::path& file, const Progress_callback& progress,
                       const Cgns_write_limits& limits);

} // namespace recurve::internal::cgns

#endif
