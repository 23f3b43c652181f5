#ifndef RECURVE_IO_PENDING_FILE_H
#define RECURVE_IO_PENDING_FILE_H

#include <filesystem>

namespace recurve {

/// A file that appears under its name only when it is complete. It is written under a temporary name in the same
/// directory; commit() brings it to the disk and renames it, which replaces an older file in one step. Without
/// commit() the destructor removes the temporary file and an older file stays as it was.
///
/// Several files that belong together are committed one after the other once all of them are written.
class Pending_file
{
public:
  /// creates the temporary file, empty. A symbolic link is followed, so that it stays a link.
  /// \throws Format_error if the directory is missing or not writable, or if `target` names anything but a regular
  /// file.
  explicit Pending_file(const std::filesystem::path& target);
  ~Pending_file();
  Pending_file(const Pending_file&) = delete;
  Pending_file& operator=(const Pending_file&) = delete;

  const std::filesystem::path& target() const { return target_; }

  /// where to write.
  const std::filesystem::path& path() const { return path_; }

  /// \throws Format_error if the data cannot be brought to the disk or the file not be renamed.
  void commit();

private:
  std::filesystem::path target_, path_;
  bool is_committed_ = false;
};

} // namespace recurve

#endif
