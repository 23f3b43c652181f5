// Makes the meshes of data/: recurve_generate_data DIRECTORY
#include <generate/cylinder_layer.h>
#include <generate/naca_wing.h>
#include <generate/sphere_in_box.h>
#include <recurve/io/cgns.h>
#include <recurve/mesh/curved_mesh.h>
#include <recurve/mesh/join_zones.h>

#include <exception>
#include <filesystem>
#include <iostream>

namespace {

using namespace recurve;

void write(const Volume_mesh& mesh, const std::filesystem::path& file)
{
  std::cout << file.filename().string() << ':';
  for (const Section& section : mesh.zones[0].cells)
    std::cout << ' ' << section.size() << ' ' << section.name;
  std::cout << "; " << mesh.zones[0].points.size() << " points;";
  for (const Patch& patch : mesh.zones[0].patches)
    std::cout << ' ' << patch.name << ' ' << patch.faces.size();
  std::cout << '\n';
  write_cgns(elevate(mesh, join_zones(mesh), 1), file);
}

void generate_all(const std::filesystem::path& directory)
{
  using generate::Sphere_cells;
  write(generate::naca_wing(), directory / "wing_tetrahedra.cgns");
  write(generate::sphere_in_box({.cells = Sphere_cells::tetrahedra}), directory / "sphere_tetrahedra.cgns");
  write(generate::sphere_in_box({.cells = Sphere_cells::hexahedra}), directory / "sphere_hexahedra.cgns");
  write(generate::sphere_in_box({.cells = Sphere_cells::prisms}), directory / "sphere_prisms.cgns");
  write(generate::sphere_in_box({.cells = Sphere_cells::pyramids, .segments = 4, .layers = 4}),
        directory / "sphere_pyramids.cgns");
  write(generate::sphere_in_box({.cells = Sphere_cells::mixed, .segments = 4, .layers = 4}),
        directory / "sphere_mixed.cgns");
  write(generate::cylinder_layer(), directory / "cylinder_hexahedra.cgns");
}

} // namespace

int main(int argc, char** argv)
{
  if (argc != 2)
  {
    std::cerr << "usage: recurve_generate_data DIRECTORY\n";
    return 1;
  }
  try
  {
    generate_all(argv[1]);
  }
  catch (const std::exception& error)
  {
    std::cerr << error.what() << '\n';
    return 2;
  }
}
