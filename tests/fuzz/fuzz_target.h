#ifndef RECURVE_TESTS_FUZZ_FUZZ_TARGET_H
#define RECURVE_TESTS_FUZZ_FUZZ_TARGET_H

#include <recurve/core/exceptions.h>
#include <recurve/io/zonal_mesh.h>

#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <string>
#include <string_view>
#include <vector>

// A fuzz target is one source file with these two functions. libFuzzer calls the first (preset "fuzz"); the mutation
// driver calls both, in any build.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace recurve::test {

/// small sound inputs to start from.
std::vector<std::string> fuzz_seeds();

/// where fuzz_file() puts its files.
inline std::filesystem::path& folder_to_remove()
{
  static std::filesystem::path folder;
  return folder;
}

/// a file of this process with the given name and content, kept in memory where the system allows; overwritten by the
/// next call.
inline std::filesystem::path fuzz_file(const std::string& name, const std::uint8_t* data, std::size_t size)
{
  static const std::filesystem::path folder = [] {
    std::filesystem::path base = std::filesystem::temp_directory_path();
    if (::access("/dev/shm", W_OK) == 0)
      base = "/dev/shm";
    base /= "recurve_fuzz_" + std::to_string(getpid());
    std::filesystem::create_directories(base);
    folder_to_remove() = base;
    std::atexit([] {
      std::error_code ignored;
      std::filesystem::remove_all(folder_to_remove(), ignored);
    });
    return base;
  }();
  std::filesystem::path file = folder / name;
  std::ofstream(file, std::ios::binary).write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  return file;
}

/// reads a damaged file: the only ways out are a result, or an error that says what is wrong with the file, in one line
/// unless it quotes the file.
template <class Read>
void must_read_or_refuse(const Read& read, bool may_quote = false)
{
  try
  {
    read();
  }
  catch (const Format_error& error)
  {
    // The inputs are small: who runs out of memory believed a number that he should not have believed.
    const std::string_view message = error.what();
    if (std::getenv("RECURVE_FUZZ_VERBOSE") != nullptr)
      std::cerr << message << '\n';
    const bool is_out_of_memory = message.find(": takes more memory than there is") == message.find(": ");
    if ((is_out_of_memory && message.find(": ") != std::string_view::npos) ||
        (!may_quote && message.find('\n') != std::string_view::npos))
    {
      std::cerr << message << '\n';
      std::abort();
    }
  }
  catch (const Input_error&)
  {}
}

} // namespace recurve::test

#endif
