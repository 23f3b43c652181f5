// Where boundary layers fold: families of layers around a sphere and a cylinder of radius 0.5, hexahedra and prisms,
// with a first cell of 1e-2 to 1e-6 of the radius and 8 to 64 faces around. Prints a Markdown table: cells that are
// certified valid when straight, and are not after curving without and with deformation of the layers; and what the
// certified mesh has kept. Exits with 1 if one of them is not certified.
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

/// whether the result is certified.
bool run(const Layer_family& family, int around, double relative_height, int degree)
{
  Curving_report report;
  const Volume_mesh mesh = make(family, around, relative_height * radius);
  curve_mesh(mesh, {.degree = degree, .record_jacobians = true}, &report);
  const auto& stages = report.jacobians.stages;
  const Certification& certification = report.certification;
  const auto count = [](Index n) { return static_cast<long long>(n); };
  std::printf("| %s | %d | %.0e | %d | %lld | %lld | %lld | %.3f | %.3f | %lld | %lld | %.2f | %.3g | %s | %.1f |\n",
              family.name, around, relative_height, degree, count(report.cells), count(stages[1].inverted),
              count(stages[2].inverted), stages[0].bounds.least.scaled, stages[2].bounds.least.scaled,
              count(report.straight_cells), count(certification.restoration.reduced_cells),
              100 * certification.full_share(), certification.restoration.restored.least.scaled,
              certification.is_certified() ? "certified" : "NOT CERTIFIED", report.seconds);
  std::fflush(stdout);
  return certification.is_certified();
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
    " least scaled, straight | least, deformed | exactly straight | reduced | area at full curvature, percent |"
    " least, certified | verdict | s |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  constexpr std::array families = {
    Layer_family{"sphere, hexahedra", true, false}, Layer_family{"sphere, prisms", true, true},
    Layer_family{"cylinder, hexahedra", false, false}, Layer_family{"cylinder, prisms", false, true}};
  bool is_certified = true;
  for (const int family : chosen)
    for (const int around : arounds)
      for (const double height : {1e-2, 1e-4, 1e-6})
        for (const int degree : degrees)
          is_certified = run(families.at(static_cast<std::size_t>(family)), around, height, degree) && is_certified;
  return is_certified ? 0 : 1;
}
