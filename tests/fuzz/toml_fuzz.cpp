// Any bytes as a TOML file of edits to feature curves.
#include "fuzz_target.h"

#include <recurve/run/feature_file.h>

namespace recurve::test {

std::vector<std::string> fuzz_seeds()
{
  return {"# only a comment\n",
          "start = \"none\"\nturning_angle = 40\nchain_angle = 10\ncorner_defect = 60\n[[edit]]\naction = \"add\"\n"
          "edges = [[[0, 0, 0], [1, 0, 0]], [{zone = \"wing\", node = 17}, {zone = \"wing\", node = 18}]]\n"
          "[[edit]]\naction = \"add\"\npath = [[0, 0, 0], [5, 0.5e-3, 0]]\n"
          "[[edit]]\naction = \"add\"\ncrease = [[0, 0, 0], [5, 0, 0]]\n",
          "[[edit]]\naction = \"add\"\nchain = [[0, 0, 0], [1, 0, 0]]\nangle = 20\n"
          "[[edit]]\naction = \"remove\"\nbox = [[0, 0, 0], [1, 1, 1]]\n"
          "[[edit]]\naction = \"add\"\npatches = [\"upper\", \"lower\"]\n"
          "[[edit]]\naction = \"mark\"\nvertices = [[0, 0, 0], {at = [1, 0, 0], copy = 1}]\n"};
}

} // namespace recurve::test

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
  using namespace recurve;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  test::must_read_or_refuse([&] { to_toml(parse_feature_file(text, "fuzz.toml")); }, true);
  return 0;
}
