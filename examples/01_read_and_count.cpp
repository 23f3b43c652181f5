// Reads a mesh, by its extension, and counts what is in it.
//
//   01_read_and_count data/sphere_mixed.cgns

#include <recurve/io/mesh_io.h>

#include <exception>
#include <iostream>

int main(int argc, char** argv)
try
{
  if (argc != 2)
  {
    std::cerr << "usage: 01_read_and_count MESH\n";
    return 1;
  }
  const recurve::Volume_mesh mesh = recurve::read_mesh(argv[1]);

  for (const recurve::Zone& zone : mesh.zones)
  {
    std::cout << "zone " << zone.name << ": " << zone.points.size() << " points\n";
    for (const recurve::Section& section : zone.cells)
      std::cout << "  " << section.size() << " cells of type " << recurve::element_name(section.type) << '\n';
    for (const recurve::Patch& patch : zone.patches)
      std::cout << "  patch " << patch.name << ": " << patch.faces.size() << " faces\n";
  }
}
catch (const std::exception& error)
{
  std::cerr << error.what() << '\n';
  return 2;
}
