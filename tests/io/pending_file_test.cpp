#include <recurve/core/exceptions.h>
#include <recurve/io/pending_file.h>

#include <support/ordinary_user.h>

#include <catch2/catch.hpp>

#include <unistd.h>

#include <fstream>
#include <sstream>

using namespace recurve;
namespace fs = std::filesystem;

namespace {

/// A folder of its own for one test, gone afterwards.
struct Scratch_folder
{
  Scratch_folder() : path(fs::temp_directory_path() / ("recurve_pending_" + std::to_string(getpid())))
  {
    fs::create_directories(path);
  }
  ~Scratch_folder()
  {
    std::error_code ignored;
    fs::permissions(path, fs::perms::owner_all, ignored);
    fs::remove_all(path, ignored);
  }

  std::size_t file_count() const { return static_cast<std::size_t>(std::distance(fs::directory_iterator(path), {})); }

  fs::path path;
};

void write(const fs::path& file, const std::string& text)
{
  std::ofstream(file) << text;
}

std::string content(const fs::path& file)
{
  std::ostringstream stream;
  stream << std::ifstream(file).rdbuf();
  return stream.str();
}

} // namespace

TEST_CASE("a pending file appears when it is committed")
{
  const Scratch_folder folder;
  const fs::path target = folder.path / "mesh.vtu";
  Pending_file file(target);
  write(file.path(), "new");
  CHECK_FALSE(fs::exists(target));
  CHECK(file.path().parent_path() == fs::canonical(folder.path));
  file.commit();
  CHECK(content(target) == "new");
  CHECK(folder.file_count() == 1);
}

TEST_CASE("a pending file that is not committed leaves everything as it was")
{
  const Scratch_folder folder;
  const fs::path target = folder.path / "mesh.vtu";
  write(target, "old");
  {
    Pending_file file(target);
    write(file.path(), "half");
  }
  CHECK(content(target) == "old");
  CHECK(folder.file_count() == 1);
}

TEST_CASE("two pending files of one target do not meet")
{
  const Scratch_folder folder;
  Pending_file first(folder.path / "mesh.vtu"), second(folder.path / "mesh.vtu");
  CHECK(first.path() != second.path());
}

TEST_CASE("a symbolic link stays a link")
{
  const Scratch_folder folder;
  write(folder.path / "real.vtu", "old");
  fs::create_symlink("real.vtu", folder.path / "link.vtu");
  Pending_file file(folder.path / "link.vtu");
  write(file.path(), "new");
  file.commit();
  CHECK(fs::is_symlink(folder.path / "link.vtu"));
  CHECK(content(folder.path / "real.vtu") == "new");
}

TEST_CASE("what is no place for a file is refused with its name")
{
  const Scratch_folder folder;
  using Catch::Matchers::Contains;
  CHECK_THROWS_WITH(Pending_file(folder.path / "missing" / "mesh.vtu"), Contains("missing") && Contains("exist"));
  CHECK_THROWS_WITH(Pending_file(folder.path), Contains("directory"));
  CHECK_THROWS_WITH(Pending_file("/dev/full"), Contains("/dev/full") && Contains("regular file"));
  CHECK(fs::exists("/dev/full"));
}

TEST_CASE("a folder that is read-only takes no file, and keeps the old one")
{
  const Scratch_folder folder;
  write(folder.path / "mesh.vtu", "old");
  fs::permissions(folder.path,
                  fs::perms::owner_read | fs::perms::owner_exec | fs::perms::others_read | fs::perms::others_exec);
  {
    const test::Ordinary_user user;
    using Catch::Matchers::Contains;
    CHECK_THROWS_WITH(Pending_file(folder.path / "mesh.vtu"), Contains("mesh.vtu") && Contains("Permission denied"));
  }
  CHECK(content(folder.path / "mesh.vtu") == "old");
  CHECK(folder.file_count() == 1);
}
