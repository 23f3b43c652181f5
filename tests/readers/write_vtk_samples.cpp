// Writes one curved cell of each type and degree as VTU into the folder given: what vtk_reader_test.py reads back.
#include "io/single_cell_mesh.h"

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
      write_vtu(test::single_cell_mesh(type, degree),
                folder / (std::string(element_name(type)) + "_" + std::to_string(degree) + ".vtu"), {{"seven", {7.0}}});
}
catch (const std::exception& error)
{
  std::cerr << error.what() << '\n';
  return 1;
}
