// Where boundary layers fold: families of layers around a sphere and a cylinder of radius 0.5, hexahedra and prisms,
// with a first cell of 1e-2 to 1e-6 of the radius and 8 to 64 faces around. Prints a Markdown table: cells that are
// certified valid when straight, and are not after curving without and with deformation of the layers.
//
//   boundary_layer_families [DEGREE ...] [-- AROUND ...] [-- FAMILY ...]
//
// FAMILY 0 and 1 are hexahedra and prisms around a sphere, 2 and 3 around a cylinder. Whatever is not named is all of
// it: degrees 2 to 4, 8 to 64 faces around, 0 to 3.
#include <generate/cylinder_layer.h>
#include <generate/sphere_in_box.h>
#include <recurve/run/curve_mesh.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

namespace {

using namespace recurve;
using namespace recurve::generate;

constexpr double radius = 0.5;

struct Layer_family
{
  const char* name;
  bool is_sphere, has_prisms;
};

Volume_mesh make(const Layer_family& family, int around, double first_layer)
{
  if (family.is_sphere)
    return sphere_in_box({.cells = family.has_prisms ? Sphere_cells::prisms : Sphere_cells::hexahedra,
                          .radius = radius,
                          .segments = around / 4,
                          .layers = 30,
                          .first_layer = first_layer});
  return cylinder_layer({.radius = radius,
                         .length = 0.5,
                         .around = around,
                         .along = 2,
                         .layers = 30,
                         .first_layer = first_layer,
                         .has_prisms = family.has_prisms});
}

void run(const Layer_family& family, int around, double relative_height, int degree)
{
  Curving_report report;
  const Volume_mesh mesh = make(family, around, relative_height * radius);
  curve_mesh(mesh, {.degree = degree, .certify = false, .record_jacobians = true}, &report);
  const auto& stages = report.jacobians.stages;
  std::printf("| %s | %d | %.0e | %d | %lld | %lld | %lld | %.3f | %.3f | %lld |\n", family.name, around,
              relative_height, degree, static_cast<long long>(report.cells), static_cast<long long>(stages[1].inverted),
              static_cast<long long>(stages[2].inverted), stages[0].bounds.least.scaled, stages[2].bounds.least.scaled,
              static_cast<long long>(report.straight_cells));
  std::fflush(stdout);
}

/// the numbers of one group of arguments, which "--" ends; `otherwise` if there are none.
std::vector<int> next_group(char**& argument, const std::vector<int>& otherwise)
{
  std::vector<int> numbers;
  for (; *argument && std::strcmp(*argument, "--") != 0; ++argument)
    numbers.push_back(std::atoi(*argument));
  if (*argument)
    ++argument;
  return numbers.empty() ? otherwise : numbers;
}

} // namespace

int main(int, char** argv)
{
  char** argument = argv + 1;
  const std::vector<int> degrees = next_group(argument, {2, 3, 4}), arounds = next_group(argument, {8, 16, 32, 64}),
                         chosen = next_group(argument, {0, 1, 2, 3});
  std::printf(
    "| family | around | first cell / radius | p | cells | inverted, surface curved | inverted, deformed |"
    " least scaled, straight | least, deformed | exactly straight |\n|---|---|---|---|---|---|---|---|---|---|\n");
  constexpr std::array families = {
    Layer_family{"sphere, hexahedra", true, false}, Layer_family{"sphere, prisms", true, true},
    Layer_family{"cylinder, hexahedra", false, false}, Layer_family{"cylinder, prisms", false, true}};
  for (const int family : chosen)
    for (const int around : arounds)
      for (const double height : {1e-2, 1e-4, 1e-6})
        for (const int degree : degrees)
          run(families.at(static_cast<std::size_t>(family)), around, height, degree);
  return 0;
}
