#include <generate/cylinder_layer.h>

#include <generate/layers.h>
#include <generate/mesh_builder.h>

#include <array>
#include <cmath>
#include <numbers>

namespace recurve::generate {

Volume_mesh cylinder_layer(const Cylinder_mesh_options& options)
{
  const double growth = layer_growth(options.first_layer, options.far_radius - options.radius, options.layers);
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
        const double r = layer == options.layers ? options.far_radius
                                                 : options.radius + layer_height(options.first_layer, growth, layer);
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
        // A face of the cell, or the two triangles that prisms make of it. Prisms stand on the wall.
        const auto add_face = [&](const char* patch, std::array<int, 4> f, bool is_split) {
          if (!is_split)
            builder.add_face(patch, std::array{c[f[0]], c[f[1]], c[f[2]], c[f[3]]});
          else
            for (const auto& t : {std::array{f[0], f[1], f[2]}, std::array{f[0], f[2], f[3]}})
              builder.add_face(patch, std::array{c[t[0]], c[t[1]], c[t[2]]});
        };
        if (options.has_prisms)
        {
          builder.add_cell(Element_type::prism, std::array{c[0], c[3], c[7], c[1], c[2], c[6]});
          builder.add_cell(Element_type::prism, std::array{c[0], c[7], c[4], c[1], c[6], c[5]});
        }
        else
          builder.add_cell(Element_type::hexahedron, c);
        if (layer == 0)
          add_face("cylinder", {0, 3, 7, 4}, options.has_prisms);
        if (layer == options.layers - 1)
          add_face("farfield", {1, 2, 6, 5}, options.has_prisms);
        if (k == 0)
          add_face("z_low", {0, 1, 2, 3}, false);
        if (k == options.along - 1)
          add_face("z_high", {4, 5, 6, 7}, false);
      }
  return builder.build();
}

} // namespace recurve::generate
