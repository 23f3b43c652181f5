#include "io/single_cell_mesh.h"

#include <recurve/core/exceptions.h>
#include <recurve/io/mesh_io.h>

#include <catch2/catch.hpp>

#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <fstream>

using namespace recurve;
namespace fs = std::filesystem;
using Catch::Matchers::Contains;

namespace {

fs::path empty_folder()
{
  fs::path folder = fs::temp_directory_path() / ("recurve_mesh_io_" + std::to_string(getpid()));
  fs::remove_all(folder);
  fs::create_directories(folder);
  return folder;
}

bool is_empty_folder(const fs::path& folder)
{
  return fs::directory_iterator(folder) == fs::directory_iterator();
}

/// Lets no file grow beyond a few bytes: what a full disk does to a writer.
class Full_disk
{
public:
  Full_disk()
  {
    std::signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &old_);
    rlimit limit = old_;
    limit.rlim_cur = 1000;
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~Full_disk() { setrlimit(RLIMIT_FSIZE, &old_); }

private:
  rlimit old_ = {};
};

} // namespace

TEST_CASE("formats are known by extension, in either case of letters")
{
  CHECK(mesh_format_of("a/wing.cgns").name == "CGNS");
  CHECK(mesh_format_of("WING.CGNS").name == "CGNS");
  CHECK(mesh_format_of("wing.v2.Vtu").name == "VTU");
  CHECK_THROWS_AS(mesh_format_of("wing.step"), Input_error);
  CHECK_THROWS_WITH(mesh_format_of("wing.step"), Contains("wing.step") && Contains(".cgns") && Contains(".vtu"));
  CHECK_THROWS_WITH(mesh_format_of("wing"), Contains("wing"));
}

TEST_CASE("degrees that a format does not hold are refused, with those that do")
{
  CHECK_NOTHROW(check_writable("a.cgns", 4));
  CHECK_NOTHROW(check_writable("a.vtu", 6));
  CHECK_THROWS_AS(check_writable("a.cgns", 5), Input_error);
  CHECK_THROWS_WITH(check_writable("a.cgns", 5), Contains("degree 5") && Contains("VTU"));
  const fs::path folder = empty_folder();
  CHECK_THROWS_AS(write_mesh(test::single_cell_mesh(Element_type::prism, 5), folder / "a.cgns"), Input_error);
  CHECK(is_empty_folder(folder));
}

TEST_CASE("what cannot be read is named")
{
  const fs::path folder = empty_folder();
  CHECK_THROWS_AS(read_mesh(folder / "none.cgns"), Format_error);
  CHECK_THROWS_WITH(read_mesh(folder / "none.cgns"), Contains("none.cgns") && Contains("No such file"));
  CHECK_THROWS_WITH(read_mesh(folder / "a.vtu"), Contains("a.vtu") && Contains("CGNS"));
  fs::create_directories(folder / "dir.cgns");
  CHECK_THROWS_WITH(read_mesh(folder / "dir.cgns"), Contains("directory"));
  std::ofstream(folder / "empty.cgns").close();
  CHECK_THROWS_WITH(read_mesh(folder / "empty.cgns"), Contains("empty.cgns: is empty"));
  std::ofstream(folder / "text.cgns") << "this is no mesh, only a line of text that is long enough to be looked at\n";
  CHECK_THROWS_AS(read_mesh(folder / "text.cgns"), Format_error);
  CHECK_THROWS_WITH(read_mesh(folder / "text.cgns"), Contains("text.cgns"));
}

TEST_CASE("a full disk leaves the old file and nothing else")
{
  const std::string extension = GENERATE(".vtu", ".cgns");
  CAPTURE(extension);
  const fs::path folder = empty_folder();
  const fs::path file = folder / ("mesh" + extension);
  const Curved_mesh mesh = test::single_cell_mesh(Element_type::hexahedron, 3);
  {
    const Full_disk full;
    CHECK_THROWS_AS(write_mesh(mesh, file), Format_error);
    CHECK(is_empty_folder(folder));
    std::ofstream(file) << "old";
    // The message names the file as the user knows it.
    CHECK_THROWS_WITH(write_mesh(mesh, file), Contains(file.string() + ": ") && !Contains(".part"));
  }
  CHECK(fs::file_size(file) == 3);
  CHECK(std::distance(fs::directory_iterator(folder), {}) == 1);
  write_mesh(mesh, file);
  CHECK(fs::file_size(file) > 1000);
}
