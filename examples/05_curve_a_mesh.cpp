// The whole conversion: a straight-sided mesh in, a curved one out, with a say in what is curved.
//
//   05_curve_a_mesh data/sphere_hexahedra.cgns curved.vtu

#include <recurve/io/mesh_io.h>
#include <recurve/run/curve_mesh.h>

#include <exception>
#include <iostream>

int main(int argc, char** argv)
try
{
  if (argc != 3)
  {
    std::cerr << "usage: 05_curve_a_mesh INPUT OUTPUT\n";
    return 1;
  }
  recurve::Curving_options options;
  options.degree = 3;
  options.curve = {"sphere"}; // patches, by name or wildcard

  recurve::Curving_report report;
  const recurve::Curved_mesh mesh = recurve::curve_mesh(recurve::read_mesh(argv[1]), options, &report);
  recurve::write_mesh(mesh, argv[2]);

  std::cout << report.straight_cells << " of " << report.cells << " cells stayed straight\n";
  std::cout << "largest displacement: " << report.largest_displacement.length << '\n';
}
catch (const std::exception& error)
{
  std::cerr << error.what() << '\n';
  return 2;
}
