#ifndef RECURVE_TESTS_IO_SMALL_MESHES_H
#define RECURVE_TESTS_IO_SMALL_MESHES_H

#include <recurve/mesh/curved_mesh.h>

#include <unistd.h>

#include <filesystem>
#include <string>
#include <vector>

namespace recurve::test {

/// A file name of this process's own, in the temporary folder; the file is removed at the end.
class Temporary_file
{
public:
  explicit Temporary_file(const std::string& name)
    : path_(std::filesystem::temp_directory_path() / ("recurve_" + std::to_string(getpid()) + "_" + name))
  {}
  ~Temporary_file()
  {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  Temporary_file(const Temporary_file&) = delete;
  Temporary_file& operator=(const Temporary_file&) = delete;

  const std::filesystem::path& path() const { return path_; }

private:
  std::filesystem::path path_;
};

/// positions of the nodes of every element, in their order: what a round trip has to keep to the bit.
inline std::vector<Point> element_positions(const Curved_mesh& mesh,
                                            std::vector<Curved_section> Curved_zone::*sections = &Curved_zone::cells)
{
  std::vector<Point> result;
  for (const Curved_zone& zone : mesh.zones)
    for (const Curved_section& section : zone.*sections)
      for (const Index node : section.nodes)
        result.push_back(mesh.nodes[static_cast<std::size_t>(node)]);
  return result;
}

/// two unit cubes side by side in x, each a zone of one hexahedron with a patch at its far end.
inline Volume_mesh two_zones(bool with_interface)
{
  Volume_mesh mesh;
  for (int z = 0; z < 2; ++z)
  {
    Zone zone;
    zone.name = z == 0 ? "left" : "right";
    const Reference_element& cube = reference_element(Element_type::hexahedron);
    for (int c = 0; c < 8; ++c)
    {
      const auto& corner = cube.corners[static_cast<std::size_t>(c)];
      zone.points.push_back({double(corner[0] + z), double(corner[1]), double(corner[2])});
    }
    zone.cells = {{"hexahedron", Element_type::hexahedron, {0, 1, 2, 3, 4, 5, 6, 7}}};
    zone.faces = {{z == 0 ? "inlet" : "outlet", Element_type::quadrangle, {}}};
    zone.faces[0].nodes = z == 0 ? std::vector<Index>{0, 4, 7, 3} : std::vector<Index>{1, 2, 6, 5};
    zone.patches = {{z == 0 ? "inlet" : "outlet", "BCTypeUserDefined", "", {0}}};
    mesh.zones.push_back(zone);
  }
  if (with_interface)
    mesh.zones[0].interfaces = {{.name = "to_right",
                                 .donor_zone = "right",
                                 .location = Zone_interface::Location::vertex,
                                 .is_abutting_one_to_one = true,
                                 .points = {1, 2, 5, 6},
                                 .donor_points = {0, 3, 4, 7},
                                 .periodicity = std::nullopt}};
  return mesh;
}

/// adds the connection that takes the patch "inlet" to "outlet" two units further, one to one.
inline void make_periodic(Volume_mesh& mesh)
{
  mesh.zones[0].interfaces.push_back({.name = "periodic_1",
                                      .donor_zone = "right",
                                      .location = Zone_interface::Location::vertex,
                                      .is_abutting_one_to_one = true,
                                      .points = {0, 3, 4, 7},
                                      .donor_points = {1, 2, 5, 6},
                                      .periodicity = Periodicity{{}, {}, {2, 0, 0}}});
}

/// moves every node by a smooth map.
inline void bend(Curved_mesh& mesh)
{
  for (Point& node : mesh.nodes)
    node = {node[0] + 0.1 * node[1] * node[2], node[1] + 0.05 * node[0] * (2 - node[0]),
            node[2] - 0.07 * node[0] * (2 - node[0]) * node[1]};
  update_straight_cells(mesh);
}

} // namespace recurve::test

#endif
