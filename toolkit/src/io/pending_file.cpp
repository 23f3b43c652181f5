#include <recurve/io/pending_file.h>

#include <recurve/core/exceptions.h>

#include <fmt/format.h>

#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <system_error>

namespace recurve {

namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& target, const std::string& what)
{
  throw Format_error(fmt::format("{}: {}", target.string(), what));
}

/// the file that `target` means, past symbolic links.
fs::path resolved(const fs::path& target)
{
  std::error_code error;
  const fs::path result = fs::weakly_canonical(target, error);
  return error ? target : result;
}

void check_target(const fs::path& target, const fs::path& file)
{
  std::error_code ignored;
  if (target.filename().empty() || fs::is_directory(file, ignored))
    fail(target, "is a directory, not a file to write");
  if (fs::exists(file, ignored) && !fs::is_regular_file(file, ignored))
    fail(target, "is not a regular file, so it cannot be replaced by the result");
  if (!fs::is_directory(file.parent_path().empty() ? fs::path(".") : file.parent_path(), ignored))
    fail(target, fmt::format("the directory {} does not exist", file.parent_path().string()));
}

/// creates an empty file beside `file` under a name that nobody else uses.
fs::path create_beside(const fs::path& target, const fs::path& file)
{
  static std::atomic<unsigned> counter = 0;
  for (;;)
  {
    fs::path candidate = file;
    candidate.replace_filename(fmt::format(".{}.{}-{}.part", file.filename().string(), getpid(), counter++));
    // Not mkstemp(), which would make the result unreadable for others whatever the umask says.
    const int descriptor = ::open(candidate.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0666);
    if (descriptor >= 0)
    {
      ::close(descriptor);
      return candidate;
    }
    if (errno != EEXIST)
      fail(target, fmt::format("cannot be created in the directory {}: {}",
                               file.parent_path().empty() ? "." : file.parent_path().string(), std::strerror(errno)));
  }
}

void bring_to_disk(const fs::path& target, const fs::path& file)
{
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0)
    fail(target, fmt::format("vanished while it was written: {}", std::strerror(errno)));
  const int status = ::fsync(descriptor);
  const int error = errno;
  ::close(descriptor);
  if (status != 0 && error != EINVAL)
    fail(target, fmt::format("cannot be brought to the disk: {}", std::strerror(error)));
}

} // namespace

Pending_file::Pending_file(const fs::path& target) : target_(target)
{
  const fs::path file = resolved(target);
  check_target(target, file);
  path_ = create_beside(target, file);
}

Pending_file::~Pending_file()
{
  std::error_code ignored;
  if (!is_committed_)
    fs::remove(path_, ignored);
}

void Pending_file::commit()
{
  bring_to_disk(target_, path_);
  std::error_code error;
  fs::rename(path_, resolved(target_), error);
  if (error)
    fail(target_, fmt::format("cannot be given its name: {}", error.message()));
  is_committed_ = true;
}

} // namespace recurve
