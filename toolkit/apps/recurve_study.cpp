// recurve-study [study.csv [sizes = 3]]: the error analysis of the paper (section 4.1).
//
// Meshes of several sizes around a sphere (tetrahedra, hexahedra), a cylinder and a cone are curved with fits of degree
// 1 to 6, by the paper's method and by the default. The error E is the largest distance of the nodes of the curved
// patch from the exact surface. One line of the file per mesh, preset and degree: family, preset, d, faces, mean edge
// length h, E, and the order of convergence from the mesh before, log(E / E_ref) / log(h / h_ref), formula (7). The
// orders of the two densest meshes (Table 1) are printed. toolkit/doc/plot_study.py draws the file (Fig. 13).

#include <generate/cylinder_layer.h>
#include <generate/sphere_in_box.h>
#include <recurve/elements/node_layout.h>
#include <recurve/run/curve_mesh.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <fstream>
#include <functional>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using recurve::Index;
using recurve::Point;

/// Meshes of one shape, each of about half the edge length of the one before.
struct Mesh_family
{
  std::string name, patch;
  std::function<recurve::Volume_mesh(int size)> mesh;
  std::function<double(const Point&)> distance;
};

/// Of the faces of the patch.
struct Measured
{
  Index faces = 0;
  double edge_length = 0; ///< mean
  double error = 0;       ///< largest distance of a node from the exact surface
};

constexpr double radius = 0.5;
constexpr double taper = 0.5; ///< of the cone, from its lower to its upper rim
constexpr int element_degree = 3;
constexpr int highest_degree = 6; ///< of the fits

recurve::Volume_mesh cylinder(int size)
{
  return recurve::generate::cylinder_layer(
    {.radius = radius, .around = 24 << size, .along = 8 << size, .layers = 3, .first_layer = 0.2});
}

recurve::Volume_mesh cone(int size)
{
  recurve::Volume_mesh mesh = cylinder(size);
  for (Point& x : mesh.zones[0].points)
    for (std::size_t i = 0; i < 2; ++i)
      x[i] *= 1 - taper * x[2];
  return mesh;
}

double distance_to_sphere(const Point& x)
{
  return std::abs(std::hypot(x[0], x[1], x[2]) - radius);
}

double distance_to_cylinder(const Point& x)
{
  return std::abs(std::hypot(x[0], x[1]) - radius);
}

double distance_to_cone(const Point& x)
{
  return std::abs(std::hypot(x[0], x[1]) - radius * (1 - taper * x[2])) / std::hypot(1, radius * taper);
}

std::vector<Mesh_family> families()
{
  using namespace recurve::generate;
  const auto tetrahedra = [](int size) {
    return sphere_in_box({.cells = Sphere_cells::tetrahedra, .radius = radius, .subdivisions = 2 + size});
  };
  const auto hexahedra = [](int size) {
    return sphere_in_box({.radius = radius, .segments = 6 << size, .layers = 3, .growth = 2});
  };
  return {{"sphere, tetrahedra", "sphere", tetrahedra, distance_to_sphere},
          {"sphere, hexahedra", "sphere", hexahedra, distance_to_sphere},
          {"cylinder", "cylinder", cylinder, distance_to_cylinder},
          {"cone", "cylinder", cone, distance_to_cone}};
}

void add_face(const recurve::Curved_mesh& mesh, const recurve::Curved_section& section, Index element,
              const Mesh_family& family, Measured& sum)
{
  const int count = recurve::node_count(section.type, mesh.degree);
  const int corners = recurve::corner_count(section.type);
  const auto node = [&](int i) {
    return mesh.nodes[static_cast<std::size_t>(section.nodes[static_cast<std::size_t>(element * count + i)])];
  };
  for (int i = 0; i < count; ++i)
    sum.error = std::max(sum.error, family.distance(node(i)));
  for (int i = 0; i < corners; ++i)
  {
    const Point a = node(i), b = node((i + 1) % corners);
    sum.edge_length += std::hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]) / corners;
  }
  ++sum.faces;
}

Measured measure(const recurve::Curved_mesh& mesh, const Mesh_family& family)
{
  Measured result;
  const recurve::Zone& zone = mesh.linear.zones[0];
  for (const recurve::Patch& patch : zone.patches)
    if (patch.name == family.patch)
      for (const Index face : patch.faces)
      {
        const recurve::Section_entry place = recurve::find_element(zone.faces, face);
        add_face(mesh, mesh.zones[0].faces[static_cast<std::size_t>(place.section)], place.element, family, result);
      }
  result.edge_length /= static_cast<double>(result.faces);
  return result;
}

double order(const Measured& fine, const Measured& coarse)
{
  return std::log(fine.error / coarse.error) / std::log(fine.edge_length / coarse.edge_length);
}

/// writes the lines of one family, preset and degree. \return the order of the two densest meshes.
double study(const Mesh_family& family, const std::vector<recurve::Volume_mesh>& meshes, recurve::Fit_preset preset,
             int degree, std::ostream& csv)
{
  std::vector<Measured> found;
  for (const recurve::Volume_mesh& mesh : meshes)
  {
    found.push_back(measure(recurve::curve_mesh(mesh, {.degree = element_degree,
                                                       .fit_degree = degree,
                                                       .fit_preset = preset,
                                                       .curve = {family.patch},
                                                       .deform = false,
                                                       .certify = false}),
                            family));
    csv << '"' << family.name << "\"," << recurve::fit_preset_name(preset) << ',' << degree << ',' << found.back().faces
        << ',' << found.back().edge_length << ',' << found.back().error << ',';
    if (found.size() > 1)
      csv << order(found.back(), found[found.size() - 2]);
    csv << '\n';
  }
  return order(found.back(), found[found.size() - 2]);
}

void run(const std::string& file, int sizes)
{
  std::ofstream csv(file);
  if (!csv)
    throw std::runtime_error("cannot write " + file); // before minutes of work
  csv << "family,preset,d,faces,h,error,order\n";
  std::printf("orders of convergence between the two densest meshes\n%-20s %-8s", "", "");
  for (int d = 1; d <= highest_degree; ++d)
    std::printf(" d = %d ", d);
  for (const Mesh_family& family : families())
  {
    std::vector<recurve::Volume_mesh> meshes;
    meshes.reserve(static_cast<std::size_t>(sizes));
    for (int size = 0; size < sizes; ++size)
      meshes.push_back(family.mesh(size));
    for (const recurve::Fit_preset preset : {recurve::Fit_preset::paper, recurve::Fit_preset::standard})
    {
      std::printf("\n%-20s %-8s", family.name.c_str(), std::string(recurve::fit_preset_name(preset)).c_str());
      for (int d = 1; d <= highest_degree; ++d)
        std::printf(" %5.2f ", study(family, meshes, preset, d, csv));
    }
  }
  std::printf("\n");
  if (!csv.flush())
    throw std::runtime_error("cannot write " + file);
}

} // namespace

int main(int argc, char** argv)
try
{
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  const std::string usage =
    "recurve-study [study.csv [sizes]]: repeats the paper's error study with so many sizes of mesh, "
    "2 to 9, or else 3, and writes a table\n";
  if (arguments.size() == 1 && arguments[0] == "--help")
  {
    std::cout << usage;
    return 0;
  }
  const std::string sizes = arguments.size() > 1 ? arguments[1] : "3";
  if (arguments.size() > 2 || sizes.size() != 1 || sizes[0] < '2' || sizes[0] > '9' ||
      (!arguments.empty() && arguments[0].starts_with('-')))
  {
    std::cerr << usage;
    return 2;
  }
  run(arguments.empty() ? "study.csv" : arguments[0], sizes[0] - '0');
}
catch (const std::exception& error)
{
  std::cerr << "recurve-study: " << error.what() << '\n';
  return 1;
}
