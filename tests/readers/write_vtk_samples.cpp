// Writes one curved cell of each type and degree as VTU, VTP and PLY into the folder given: what vtk_reader_test.py
// reads back.
#include "io/single_cell_mesh.h"

#include <recurve/io/surface_files.h>
#include <recurve/io/vtk.h>

#include <exception>
#include <filesystem>
#include <iostream>
#include <string>

int main(int argc, char** argv)
try
{
  using namespace recurve;
  if (argc != 2)
    return 1;
  const std::filesystem::path folder = argv[1];
  std::filesystem::create_directories(folder);
  for (Element_type type : all_element_types)
    for (int degree = 1; degree <= max_degree && reference_element(type).dimension == 3; ++degree)
    {
      const Curved_mesh mesh = test::single_cell_mesh(type, degree);
      const std::string name = std::string(element_name(type)) + "_" + std::to_string(degree);
      write_vtu(mesh, folder / (name + ".vtu"), {{"seven", {7.0}}});
      write_vtp(mesh, folder / (name + ".vtp"));
      write_ply(mesh, folder / (name + ".ply"));
    }
}
catch (const std::exception& error)
{
  std::cerr << error.what() << '\n';
  return 1;
}
