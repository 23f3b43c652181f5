// Curves a surface mesh (OFF, OBJ, PLY, STL) and writes its faces as curved triangles and quads for VTK and ParaView.
//
//   10_curve_a_surface_file [surface.off [out.vtu]]; without an argument it makes a cylinder of 12 sides itself.

#include <recurve/io/vtk.h>
#include <recurve/run/curve_surface_mesh.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <numbers>

static std::filesystem::path make_cylinder()
{
  std::filesystem::path file = std::filesystem::temp_directory_path() / "recurve_example_cylinder.off";
  std::ofstream out(file);
  out.precision(17);
  constexpr int sides = 12, rings = 6;
  out << "OFF\n" << sides * (rings + 1) << ' ' << sides * rings << " 0\n";
  for (int j = 0; j <= rings; ++j)
    for (int i = 0; i < sides; ++i)
      out << std::cos(2 * std::numbers::pi * i / sides) << ' ' << std::sin(2 * std::numbers::pi * i / sides) << ' '
          << 0.5 * j << '\n';
  for (int j = 0; j < rings; ++j)
    for (int i = 0; i < sides; ++i)
      out << "4 " << i + j * sides << ' ' << (i + 1) % sides + j * sides << ' ' << (i + 1) % sides + (j + 1) * sides
          << ' ' << i + (j + 1) * sides << '\n';
  return file;
}

int main(int argc, char** argv)
{
  const std::filesystem::path input = argc > 1 ? argv[1] : make_cylinder();
  const std::filesystem::path output = argc > 2 ? std::string(argv[2]) : input.stem().string() + ".vtu";
  recurve::Surface_mesh_report report;
  const recurve::Curved_mesh curved =
    recurve::curve_surface_mesh(recurve::read_surface_mesh(input), {.degree = 3}, &report);
  recurve::write_vtu(curved, output);

  double error = 0;
  for (const recurve::Point& x : curved.nodes)
    error = std::max(error, std::abs(std::hypot(x[0], x[1]) - 1));
  std::cout << report.fits.faces << " faces, " << report.features.critical_edges << " critical edges, "
            << curved.nodes.size() << " nodes\n";
  if (argc == 1)
    std::cout << "largest distance from the cylinder: " << error << " (straight: 0.034)\n";
}
