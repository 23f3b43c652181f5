#include "binary_output.h"

#include <recurve/core/exceptions.h>

#include <fmt/format.h>

#include <unistd.h>

#include <cerrno>

namespace recurve {

namespace {

// Large enough that the disk sees few, long writes.
constexpr std::size_t buffer_bytes = std::size_t{1} << 20;

} // namespace

Binary_output::Binary_output(const std::filesystem::path& path) : path_(path), file_(std::fopen(path.c_str(), "wb"))
{
  if (!file_)
    fail("cannot be created");
  std::setvbuf(file_, nullptr, _IONBF, 0);
  buffer_.reserve(buffer_bytes);
}

Binary_output::~Binary_output()
{
  if (!file_)
    return;
  std::fclose(file_);
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
}

void Binary_output::close()
{
  flush();
  // Some file systems report a full disk or quota only when asked to bring the data to the disk.
  if (std::fflush(file_) != 0 || (fsync(fileno(file_)) != 0 && errno != EINVAL))
    fail("cannot be written");
  if (std::fclose(file_) != 0)
  {
    file_ = nullptr;
    const int error = errno;
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
    errno = error;
    fail("cannot be written");
  }
  file_ = nullptr;
}

void Binary_output::flush()
{
  write(buffer_.data(), buffer_.size());
  buffer_.clear();
  if (after_write_)
    after_write_();
}

void Binary_output::write(const std::byte* bytes, std::size_t count)
{
  if (std::fwrite(bytes, 1, count, file_) != count)
    fail("cannot be written");
}

void Binary_output::fail(std::string_view what) const
{
  throw Format_error(fmt::format("{}: {}: {}", path_.string(), what, std::strerror(errno)));
}

} // namespace recurve
