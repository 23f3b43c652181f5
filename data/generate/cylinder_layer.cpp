#include <generate/cylinder_layer.h>

#include <generate/mesh_builder.h>
#include <recurve/core/exceptions.h>

#include <array>
#include <cmath>
#include <numbers>

namespace recurve::generate {

namespace {

/// distance from the wall after `layer` of `layers` layers that grow by `growth` from `first`.
double height(double first, double growth, int layer)
{
  double sum = 0;
  for (int k = 0; k < layer; ++k)
    sum = growth * sum + first;
  return sum;
}

/// the growth with which the layers fill the whole height, by bisection.
double growth_of(const Cylinder_mesh_options& options)
{
  const double whole = options.far_radius - options.radius;
  if (options.first_layer * options.layers > whole)
    throw Input_error("the layers are too thick for the space around the cylinder");
  double low = 1, high = 10;
  for (int step = 0; step < 100; ++step)
  {
    const double middle = 0.5 * (low + high);
    (height(options.first_layer, middle, options.layers) < whole ? low : high) = middle;
  }
  return low;
}

} // namespace

Volume_mesh cylinder_layer(const Cylinder_mesh_options& options)
{
  const double growth = growth_of(options);
  Mesh_builder builder("cylinder");
  builder.set_patch_kind("cylinder", "BCWall");
  builder.set_patch_kind("farfield", "BCFarfield");
  builder.set_patch_kind("z_low", "BCSymmetryPlane");
  builder.set_patch_kind("z_high", "BCSymmetryPlane");
  for (int k = 0; k <= options.along; ++k)
    for (int layer = 0; layer <= options.layers; ++layer)
      for (int around = 0; around < options.around; ++around)
      {
        const double angle = 2 * std::numbers::pi * around / options.around;
        const double r =
          layer == options.layers ? options.far_radius : options.radius + height(options.first_layer, growth, layer);
        builder.add_point({r * std::cos(angle), r * std::sin(angle), options.length * k / options.along});
      }

  const auto number = [&](int around, int layer, int k) {
    return (Index(k) * (options.layers + 1) + layer) * options.around + around % options.around;
  };
  for (int k = 0; k < options.along; ++k)
    for (int layer = 0; layer < options.layers; ++layer)
      for (int a = 0; a < options.around; ++a)
      {
        const std::array<Index, 8> c = {number(a, layer, k),
                                        number(a, layer + 1, k),
                                        number(a + 1, layer + 1, k),
                                        number(a + 1, layer, k),
                                        number(a, layer, k + 1),
                                        number(a, layer + 1, k + 1),
                                        number(a + 1, layer + 1, k + 1),
                                        number(a + 1, layer, k + 1)};
        builder.add_cell(Element_type::hexahedron, c);
        if (layer == 0)
          builder.add_face("cylinder", std::array{c[0], c[3], c[7], c[4]});
        if (layer == options.layers - 1)
          builder.add_face("farfield", std::array{c[1], c[2], c[6], c[5]});
        if (k == 0)
          builder.add_face("z_low", std::array{c[0], c[1], c[2], c[3]});
        if (k == options.along - 1)
          builder.add_face("z_high", std::array{c[4], c[5], c[6], c[7]});
      }
  return builder.build();
}

} // namespace recurve::generate
