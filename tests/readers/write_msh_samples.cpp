// Writes one curved cell of each type and degree as MSH, in both versions, binary and text, and one mesh of two zones
// with a periodic link, into the folder given: what gmsh_reader_test.py reads back. With more files on the command
// line, reads each and writes it again as MSH beside them.
//
// usage: recurve_write_msh_samples FOLDER [MESH ...]
#include "io/single_cell_mesh.h"
#include "io/small_meshes.h"

#include <recurve/io/mesh_io.h>
#include <recurve/mesh/join_zones.h>

#include <exception>
#include <filesystem>
#include <iostream>
#include <string>

namespace {

using namespace recurve;

void write_all(const Curved_mesh& mesh, const std::filesystem::path& folder, const std::string& name)
{
  for (const bool is_ascii : {false, true})
  {
    const std::string suffix = is_ascii ? "_ascii.msh" : ".msh";
    write_msh(mesh, folder / (name + "_v22").append(suffix), {Msh_version::v2_2, is_ascii});
    write_msh(mesh, folder / (name + "_v41").append(suffix), {Msh_version::v4_1, is_ascii});
  }
}

} // namespace

int main(int argc, char** argv)
try
{
  if (argc < 2)
    return 1;
  const std::filesystem::path folder = argv[1];
  std::filesystem::create_directories(folder);
  for (const Element_type type : all_element_types)
    for (int degree = 1; degree <= max_degree && reference_element(type).dimension == 3; ++degree)
      write_all(test::single_cell_mesh(type, degree), folder,
                std::string(element_name(type)) + "_" + std::to_string(degree));
  Volume_mesh linear = test::two_zones(true);
  const Joined_zones joined = join_zones(linear);
  test::make_periodic(linear);
  write_all(elevate(std::move(linear), joined, 3), folder, "two_zones");
  for (int m = 2; m < argc; ++m)
  {
    const std::filesystem::path input = argv[m];
    write_msh(read_curved_mesh(input), folder / ("again_" + input.stem().string() + ".msh"),
              {input.string().find("v22") != std::string::npos ? Msh_version::v2_2 : Msh_version::v4_1, false});
  }
}
catch (const std::exception& error)
{
  std::cerr << error.what() << '\n';
  return 1;
}
