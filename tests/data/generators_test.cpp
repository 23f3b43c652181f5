#include "exact_geometry.h"

#include <recurve/core/exceptions.h>

#include <catch2/catch.hpp>

#include <numbers>

using namespace recurve;
using generate::Sphere_cells;

namespace {

void check_patches(const Zone& zone, const test::Exact_geometry& geometry, double size)
{
  REQUIRE(zone.patches.size() == geometry.size());
  Point sum = {};
  for (const Patch& patch : zone.patches)
  {
    CAPTURE(patch.name);
    CHECK(test::largest_residual(zone, patch, geometry) <= 4e-16 * size);
    const Point area = test::vector_area(zone, patch);
    for (int i = 0; i < 3; ++i)
      sum[i] += area[i];
  }
  // The faces of all patches close the mesh, all of them seen from outside.
  for (int i = 0; i < 3; ++i)
    CHECK(std::abs(sum[i]) <= 1e-12 * size * size);
}

} // namespace

TEST_CASE("sphere_in_box: every type of cell fills the space between sphere and box")
{
  const auto cells = GENERATE(Sphere_cells::tetrahedra, Sphere_cells::hexahedra, Sphere_cells::prisms,
                              Sphere_cells::pyramids, Sphere_cells::mixed);
  const generate::Sphere_mesh_options options{.cells = cells, .segments = 4, .layers = 3};
  CAPTURE(static_cast<int>(cells));
  const Volume_mesh mesh = generate::sphere_in_box(options);
  const Zone& zone = mesh.zones.at(0);
  check_patches(zone, test::sphere_geometry(options), 4);

  const auto [volume, smallest] = test::volumes(zone);
  CHECK(smallest > 0);
  // The polyhedron inside the sphere is a few per cent smaller than the sphere.
  const double exact = 64 - 4 * std::numbers::pi / 3 * std::pow(options.radius, 3);
  CHECK(volume > exact);
  CHECK(volume < exact + 0.15 * (64 - exact));
}

TEST_CASE("sphere_in_box: numbers of cells")
{
  const int n = 4, layers = 3, blocks = 6 * n * n * layers;
  const auto mesh_of = [&](Sphere_cells cells) {
    return generate::sphere_in_box({.cells = cells, .segments = n, .layers = layers});
  };
  CHECK(mesh_of(Sphere_cells::hexahedra).zones[0].cell_count() == blocks);
  CHECK(mesh_of(Sphere_cells::prisms).zones[0].cell_count() == 2 * blocks);
  CHECK(mesh_of(Sphere_cells::pyramids).zones[0].cell_count() == 6 * blocks);

  const Zone mixed = mesh_of(Sphere_cells::mixed).zones[0];
  std::map<Element_type, Index> count;
  for (const Section& section : mixed.cells)
    count[section.type] += section.size();
  const int on_patches = 2 * n * n * 2; // blocks of the two sides along z that have a face on sphere or box
  CHECK(count[Element_type::hexahedron] == blocks / 3);
  CHECK(count[Element_type::prism] == 2 * blocks / 3);
  CHECK(count[Element_type::pyramid] == 6 * blocks / 3 - on_patches);
  CHECK(count[Element_type::tetrahedron] == 2 * on_patches);
}

TEST_CASE("cylinder_layer: layers of hexahedra that grow from the wall")
{
  const generate::Cylinder_mesh_options options;
  const Zone zone = generate::cylinder_layer(options).zones.at(0);
  CHECK(zone.cell_count() == options.around * options.along * options.layers);
  check_patches(zone, test::cylinder_geometry(options), options.far_radius);

  const auto [volume, smallest] = test::volumes(zone);
  CHECK(smallest > 0);
  const double polygon = 0.5 * options.around * std::sin(2 * std::numbers::pi / options.around);
  const double exact = options.length * polygon * (std::pow(options.far_radius, 2) - std::pow(options.radius, 2));
  CHECK(volume == Approx(exact).epsilon(1e-12));

  double nearest = options.far_radius;
  for (const Point& p : zone.points)
    if (const double height = std::hypot(p[0], p[1]) - options.radius; height > 1e-12)
      nearest = std::min(nearest, height);
  CHECK(nearest == Approx(options.first_layer).epsilon(1e-12));
  // What the mesh is for: the wall bulges farther than the first cells are high.
  CHECK(options.radius * (1 - std::cos(std::numbers::pi / options.around)) > options.first_layer);
  CHECK_THROWS_AS(generate::cylinder_layer({.layers = 20, .first_layer = 1}), Input_error);
}

TEST_CASE("naca_wing: every point of the wing is on the NACA 0012 section of its span")
{
  // Coordinates of the section with the open trailing edge, from the tables of the NACA: 12 % thick at 30 % chord.
  CHECK(generate::naca0012_half_thickness(0.3) == Approx(0.06).epsilon(0.002));
  CHECK(generate::naca0012_half_thickness(0) == 0);
  CHECK(std::abs(generate::naca0012_half_thickness(1)) < 1e-16);

  const generate::Wing_mesh_options options;
  const Zone zone = generate::naca_wing(options).zones.at(0);
  check_patches(zone, test::wing_geometry(options.geometry), options.geometry.far_radius);

  const auto [volume, smallest] = test::volumes(zone);
  CHECK(smallest > 0);
  const double half_sphere = 2 * std::numbers::pi / 3 * std::pow(options.geometry.far_radius, 3);
  CHECK(volume < half_sphere);
  CHECK(volume > 0.97 * half_sphere);
}
