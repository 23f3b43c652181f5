// Calls a fuzz target with damaged copies of its seeds: the short run that every build can do. libFuzzer (preset
// "fuzz") looks longer and more cleverly.
//
// usage: TARGET_mutations [COUNT [SEED]], or: TARGET_mutations --write-seeds FOLDER
#include "fuzz_target.h"

#include <csignal>
#include <cstring>
#include <random>

namespace {

using Generator = std::mt19937_64;

std::size_t below(Generator& generator, std::size_t count)
{
  return count == 0 ? 0 : static_cast<std::size_t>(generator() % count);
}

/// numbers that readers trip over, as text.
constexpr const char* words[] = {
  "0",          "-1",          "1",          "2147483647",           "2147483648",
  "4294967295", "-2147483648", "4294967296", "9223372036854775807",  "18446744073709551615",
  "1e308",      "nan",         "-inf",       "99999999999999999999", "1e-320"};

void replace_word(std::string& text, Generator& generator)
{
  std::size_t first = below(generator, text.size());
  while (first > 0 && std::strchr(" \n\t=,[]", text[first - 1]) == nullptr)
    --first;
  std::size_t last = first;
  while (last < text.size() && std::strchr(" \n\t=,[]", text[last]) == nullptr)
    ++last;
  text.replace(first, last - first, words[below(generator, std::size(words))]);
}

void replace_binary_number(std::string& text, Generator& generator)
{
  constexpr std::uint64_t numbers[] = {
    0, 1, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, ~std::uint64_t{0}, std::uint64_t{1} << 40};
  const std::uint64_t number = numbers[below(generator, std::size(numbers))];
  const std::size_t width = below(generator, 2) == 0 ? 4 : 8;
  if (text.size() < width)
    return;
  std::memcpy(text.data() + below(generator, text.size() - width + 1), &number, width);
}

void mutate(std::string& text, const std::vector<std::string>& seeds, Generator& generator)
{
  const std::size_t at = below(generator, text.size() + 1), length = below(generator, 40);
  switch (below(generator, 8))
  {
  case 0:
    if (!text.empty())
      text[below(generator, text.size())] ^= static_cast<char>(1U << below(generator, 8));
    break;
  case 1: text.erase(at, length); break;
  case 2: text.insert(at, text.substr(below(generator, text.size() + 1), length)); break;
  case 3: text.insert(at, std::string(length, static_cast<char>(generator()))); break;
  case 4: replace_word(text, generator); break;
  case 5: replace_binary_number(text, generator); break;
  case 6: text.resize(at); break;
  default:
  {
    const std::string& other = seeds[below(generator, seeds.size())];
    text = text.substr(0, at) + other.substr(below(generator, other.size() + 1));
  }
  }
}

int write_seeds(const std::filesystem::path& folder)
{
  std::filesystem::create_directories(folder);
  int number = 0;
  for (const std::string& seed : recurve::test::fuzz_seeds())
    std::ofstream(folder / ("seed_" + std::to_string(number++)), std::ios::binary) << seed;
  return 0;
}

const std::string* running = nullptr;

/// leaves the input that a target did not survive.
void keep_input(int signal)
{
  if (running != nullptr)
    std::ofstream("crash_input", std::ios::binary) << *running;
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

} // namespace

int main(int argc, char** argv)
{
  if (argc == 3 && std::string_view(argv[1]) == "--write-seeds")
    return write_seeds(argv[2]);
  const long count = argc > 1 ? std::atol(argv[1]) : 2000;
  const auto seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : std::uint64_t{20240609};
  std::cout << count << " mutations, seed " << seed << std::endl;
  for (const int signal : {SIGABRT, SIGSEGV, SIGALRM})
    std::signal(signal, keep_input);
  const std::vector<std::string> seeds = recurve::test::fuzz_seeds();
  Generator generator(seed);
  for (long m = 0; m < count; ++m)
  {
    std::string text = seeds[static_cast<std::size_t>(m) % seeds.size()];
    if (m >= static_cast<long>(seeds.size()))
      for (std::size_t times = 1 + below(generator, 4); times > 0; --times)
        mutate(text, seeds, generator);
    running = &text;
    alarm(30); // who takes that long for so little never ends
    LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
    running = nullptr;
  }
  alarm(0);
}
