#include "disk_space.h"

#include <recurve/core/exceptions.h>

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <unistd.h>

namespace recurve::internal {

void reserve_disk_space(const std::filesystem::path& file, Index bytes)
{
  const int descriptor = ::open(file.c_str(), O_CREAT | O_WRONLY | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor < 0)
    throw Format_error(fmt::format("{}: cannot be written: {}", file.string(), std::strerror(errno)));
  const int error = ::posix_fallocate(descriptor, 0, static_cast<off_t>(bytes));
  const bool is_empty_again = ::ftruncate(descriptor, 0) == 0;
  ::close(descriptor);
  // A file system that cannot reserve (EINVAL, EOPNOTSUPP) says nothing about its space.
  if (error != ENOSPC && error != EDQUOT && error != EFBIG && is_empty_again)
    return;
  std::error_code ignored;
  std::filesystem::remove(file, ignored);
  throw Format_error(
    fmt::format("{}: {} bytes cannot be written there: {}", file.string(), bytes, std::strerror(error)));
}

} // namespace recurve::internal
