// Writes the CGNS meshes that command_line_test.py and convert_test.py feed to the program into the folder given.
#include "io/small_meshes.h"
#include "support/sphere_shell.h"

#include <recurve/io/cgns.h>
#include <recurve/mesh/curved_mesh.h>
#include <recurve/mesh/join_zones.h>

#include <exception>
#include <filesystem>
#include <iostream>

int main(int argc, char** argv)
try
{
  using namespace recurve;
  if (argc != 2)
    return 1;
  const std::filesystem::path folder = argv[1];
  std::filesystem::create_directories(folder);
  const auto write = [&](const test::Shell_options& options, const char* name) {
    Volume_mesh mesh = test::sphere_shell(options);
    const Joined_zones joined = join_zones(mesh);
    write_cgns(elevate(std::move(mesh), joined, 1), folder / name);
  };
  Volume_mesh rich = test::two_zones(true);
  const Joined_zones joined = join_zones(rich);
  test::make_periodic(rich);
  rich.families = {{"flow", ""}};
  rich.units = {"Kilogram", "Meter", "Second", "Kelvin", "Radian"};
  rich.descriptors = {{"author", "nobody"}};
  rich.zones[0].patches[0].kind = "BCInflow";
  Curved_mesh curved = elevate(std::move(rich), joined, 3);
  test::bend(curved);
  write_cgns(curved, folder / "curved_zones.cgns");
  write({4, 2, Element_type::hexahedron, test::Outer_shape::box}, "shell.cgns");
  write({24, 10, Element_type::tetrahedron, test::Outer_shape::sphere}, "large.cgns");
}
catch (const std::exception& error)
{
  std::cerr << error.what() << '\n';
  return 1;
}
