// Any bytes as a UGRID file; the first byte chooses the encoding.
#include "fuzz_target.h"

#include <recurve/io/ugrid.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

namespace recurve::test {

namespace {

constexpr std::array<const char*, 5> names = {"fuzz.b8.ugrid", "fuzz.lb8.ugrid", "fuzz.b4.ugrid", "fuzz.lb4.ugrid",
                                              "fuzz.ugrid"};

template <class Number>
void put(std::string& text, Number value, bool is_little)
{
  std::array<char, sizeof value> bytes;
  std::memcpy(bytes.data(), &value, sizeof value);
  if (is_little != (std::endian::native == std::endian::little))
    std::reverse(bytes.begin(), bytes.end());
  text.append(bytes.data(), bytes.size());
}

} // namespace

std::vector<std::string> fuzz_seeds()
{
  // A tetrahedron and a pyramid on a square, with one triangle and one quadrangle.
  const std::vector<std::int32_t> counts = {6, 1, 1, 1, 1, 0, 0};
  const std::vector<double> coordinates = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0.5, 0.5, 1, 0.5, -1, 0.5};
  const std::vector<std::int32_t> rest = {1, 2, 6, 1, 4, 3, 2, 1, 2, 1, 6, 2, 5, 2, 1, 5, 3, 4};
  std::vector<std::string> seeds;
  for (std::size_t encoding = 0; encoding < names.size(); ++encoding)
  {
    std::string text(1, static_cast<char>(encoding));
    const bool is_little = encoding % 2 == 1, is_single = encoding > 1, is_text = encoding == 4;
    for (const std::int32_t value : counts)
      is_text ? void(text += std::to_string(value) + " ") : put(text, value, is_little);
    for (const double value : coordinates)
      is_text     ? void(text += std::to_string(value) + "\n")
      : is_single ? put(text, static_cast<float>(value), is_little)
                  : put(text, value, is_little);
    for (const std::int32_t value : rest)
      is_text ? void(text += std::to_string(value) + " ") : put(text, value, is_little);
    seeds.push_back(text);
  }
  return seeds;
}

} // namespace recurve::test

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
  using namespace recurve;
  if (size == 0)
    return 0;
  const auto file = test::fuzz_file(test::names[data[0] % test::names.size()], data + 1, size - 1);
  test::must_read_or_refuse([&] { to_curved_mesh(read_ugrid(file)); });
  return 0;
}
