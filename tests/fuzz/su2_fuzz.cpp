// Any bytes as an SU2 file.
#include "fuzz_target.h"

#include <recurve/io/su2.h>

namespace recurve::test {

std::vector<std::string> fuzz_seeds()
{
  const std::string tetrahedron = "NDIME= 3\nNELEM= 1\n10 0 1 2 3 0\nNPOIN= 4\n0 0 0 0\n1 0 0 1\n0 1 0 2\n0 0 1 3\n"
                                  "NMARK= 2\nMARKER_TAG= wall\nMARKER_ELEMS= 2\n5 0 2 1\n5 0 1 3\n"
                                  "MARKER_TAG= far field\nMARKER_ELEMS= 1\n5 1 2 3\n";
  const std::string quadratic =
    "NDIME= 3 % a comment\nNPOIN= 10\n0 0 0\n.5 0 0\n1 0 0\n0 .5 0\n.5 .5 0\n0 1 0\n0 0 .5\n"
    ".5 0 .5\n0 .5 .5\n0 0 1\nNELEM= 1\n110 0 1 2 3 4 5 6 7 8 9 0\nNMARK= 1\n"
    "MARKER_TAG= SEND_RECEIVE\nMARKER_ELEMS= 1\nSEND_RECV= 1\n1 0 0\nNPERIODIC= 1\n";
  return {tetrahedron, quadratic, "NZONE= 2\nIZONE= 1\n" + tetrahedron + "IZONE= 2\n" + tetrahedron};
}

} // namespace recurve::test

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
  using namespace recurve;
  const auto file = test::fuzz_file("fuzz.su2", data, size);
  test::must_read_or_refuse([&] { to_curved_mesh(read_su2(file)); });
  return 0;
}
