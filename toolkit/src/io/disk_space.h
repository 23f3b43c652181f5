#ifndef RECURVE_IO_DISK_SPACE_H
#define RECURVE_IO_DISK_SPACE_H

#include <recurve/core/types.h>

#include <filesystem>

namespace recurve::internal {

/// checks that a file of `bytes` bytes can be written at `file`, by reserving them; there is an empty file afterwards.
///
/// HDF5 1.10 does not survive a disk that is full: errors at the close of an array get lost, and after a failed close
/// of a file the process crashes when it ends. So what can be known is found out before.
/// \throws Format_error with the reason of the operating system.
void reserve_disk_space(const std::filesystem::path& file, Index bytes);

} // namespace recurve::internal

#endif
