#include "io/single_cell_mesh.h"

#include <recurve/core/exceptions.h>
#include <recurve/io/mesh_io.h>

#include <catch2/catch.hpp>

#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <sstream>

using namespace recurve;
namespace fs = std::filesystem;
using Catch::Matchers::Contains;
using Catch::Matchers::EndsWith;

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

TEST_CASE("the README shows the table of formats as the code has it")
{
  std::ostringstream readme;
  readme << std::ifstream(RECURVE_SOURCE_DIR "/README.md").rdbuf();
  CHECK_THAT(readme.str(), Contains(format_table()));
}

TEST_CASE("every format says what it loses, and only of what there is")
{
  Curved_mesh mesh = test::single_cell_mesh(Element_type::prism, 2);
  mesh.linear.zones[0].patches[0].kind = "BCTypeUserDefined";
  for (Patch& patch : mesh.linear.zones[0].patches)
    patch.kind = "BCTypeUserDefined";
  for (const Mesh_format& format : mesh_formats())
    if (format.read && format.write)
      CHECK(describe_loss(format, mesh).empty());
  CHECK(describe_loss(mesh_format_of("a.off"), mesh) == "OFF does not hold, and this mesh has: cells, patches");
  mesh.linear.zones[0].patches[0].kind = "BCWall";
  mesh.linear.units[1] = "Meter";
  CHECK(describe_loss(mesh_format_of("a.cgns"), mesh).empty());
  CHECK(describe_loss(mesh_format_of("a.msh"), mesh) ==
        "MSH does not hold, and this mesh has: kinds of boundary conditions, units");
  mesh.linear.zones[0].name = "in/out";
  mesh.linear.zones[0].patches[1].name = "a \"wall\" of " + std::string(200, 'x');
  CHECK(describe_loss(mesh_format_of("a.cgns"), mesh) ==
        "CGNS does not hold, and this mesh has: names beyond 32 bytes, / in names");
  CHECK_THAT(describe_loss(mesh_format_of("a.msh"), mesh), EndsWith("units, names beyond 127 bytes, \" in names"));
  CHECK_THAT(describe_loss(mesh_format_of("a.h5"), mesh), EndsWith("units"));
  for (const Mesh_content content : all_mesh_content)
    CHECK(has_content(mesh, content) == (content == Mesh_content::cells || content == Mesh_content::patches ||
                                         content == Mesh_content::kinds || content == Mesh_content::units));
}

TEST_CASE("each reader refuses what is not its format")
{
  const fs::path folder = empty_folder();
  for (const Mesh_format& format : mesh_formats())
    for (const std::string& text : {std::string("\0\1\2\3 no mesh\n", 13), std::string(3000, '\xff'), std::string("\n"),
                                    std::string("<?xml version=\"1.0\"?>\n")})
      for (const std::string& extension : format.extensions)
      {
        if (!format.read)
          continue;
        const fs::path file = folder / ("no_mesh" + extension);
        std::ofstream(file, std::ios::binary) << text;
        CAPTURE(file);
        CHECK_THROWS_AS(read_mesh(file), Format_error);
        CHECK_THROWS_WITH(read_curved_mesh(file), Contains("no_mesh" + extension));
      }
}

TEST_CASE("what cannot be read is named")
{
  const fs::path folder = empty_folder();
  CHECK_THROWS_AS(read_mesh(folder / "none.cgns"), Format_error);
  CHECK_THROWS_WITH(read_mesh(folder / "none.cgns"), Contains("none.cgns") && Contains("No such file"));
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
  const std::string extension = GENERATE(".vtu", ".cgns", ".msh", ".h5", ".vtp", ".ply", ".off");
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
