// Any bytes as a Gmsh file.
#include "fuzz_target.h"
#include "io/single_cell_mesh.h"
#include "io/small_meshes.h"

#include <recurve/io/gmsh.h>
#include <recurve/mesh/join_zones.h>

#include <sstream>

namespace recurve::test {

std::vector<std::string> fuzz_seeds()
{
  std::vector<std::string> seeds;
  Volume_mesh linear = two_zones(true);
  const Joined_zones joined = join_zones(linear);
  make_periodic(linear);
  const std::vector<Curved_mesh> meshes = {elevate(std::move(linear), joined, 2),
                                           single_cell_mesh(Element_type::pyramid, 3),
                                           single_cell_mesh(Element_type::prism, 1)};
  const Temporary_file file("seed.msh");
  for (const Curved_mesh& mesh : meshes)
    for (const Msh_version version : {Msh_version::v2_2, Msh_version::v4_1})
      for (const bool is_ascii : {false, true})
      {
        write_msh(mesh, file.path(), {version, is_ascii});
        std::ostringstream text;
        text << std::ifstream(file.path(), std::ios::binary).rdbuf();
        seeds.push_back(text.str());
      }
  return seeds;
}

} // namespace recurve::test

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
  using namespace recurve;
  const auto file = test::fuzz_file("fuzz.msh", data, size);
  test::must_read_or_refuse([&] { to_curved_mesh(read_msh(file)); });
  return 0;
}
