// Writes HOPR files for hopr_reader_test.py into the folder given: one curved cell of each type and degree, two zones
// with a periodic connection, and each mesh named on the command line, read and (if it is linear) raised to degree 2.
//
// usage: recurve_write_hopr_samples FOLDER [MESH ...]
#include "io/single_cell_mesh.h"
#include "io/small_meshes.h"

#include <recurve/io/mesh_io.h>
#include <recurve/mesh/boundary_faces.h>
#include <recurve/mesh/join_zones.h>
#include <recurve/mesh/orient_cells.h>

#include <exception>
#include <filesystem>
#include <iostream>
#include <string>

namespace {

using namespace recurve;

Curved_mesh read(const std::filesystem::path& file)
{
  Curved_mesh mesh = read_curved_mesh(file);
  if (mesh.degree > 1)
    return mesh;
  orient_cells(mesh.linear);
  const Joined_zones joined = join_zones(mesh.linear);
  find_boundary_faces(mesh.linear, joined);
  return elevate(std::move(mesh.linear), joined, 2);
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
      write_hopr(test::single_cell_mesh(type, degree),
                 folder / (std::string(element_name(type)) + "_" + std::to_string(degree) + ".h5"));
  for (int degree = 1; degree <= 3; ++degree)
  {
    Volume_mesh linear = test::two_zones(true);
    const Joined_zones joined = join_zones(linear);
    test::make_periodic(linear);
    Curved_mesh mesh = elevate(std::move(linear), joined, degree);
    test::bend(mesh);
    write_hopr(mesh, folder / ("two_zones_" + std::to_string(degree) + ".h5"));
  }
  for (int m = 2; m < argc; ++m)
  {
    const std::filesystem::path input = argv[m];
    write_hopr(read(input), folder / ("mesh_" + input.stem().string() + ".h5"));
  }
}
catch (const std::exception& error)
{
  std::cerr << error.what() << '\n';
  return 1;
}
