#ifndef RECURVE_TESTS_SUPPORT_SHARED_DATA_H
#define RECURVE_TESTS_SUPPORT_SHARED_DATA_H

#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <optional>
#include <string_view>

namespace recurve::test {

/// finds a mesh that did not come from this project, or says on standard output that the test goes without it. Such
/// meshes are no part of the repository: they are looked for in the folder that the environment variable
/// RECURVE_SHARED_DATA names, then in ../shared/data beside the source tree.
inline std::optional<std::filesystem::path> shared_data(std::string_view relative)
{
  const char* const variable = std::getenv("RECURVE_SHARED_DATA");
  const std::filesystem::path folder =
    variable != nullptr ? std::filesystem::path(variable) : RECURVE_SOURCE_DIR "/../shared/data";
  const std::filesystem::path file = folder / relative;
  if (std::filesystem::exists(file))
    return file;
  std::cout << "skipped: there is no " << file.string() << '\n';
  return std::nullopt;
}

} // namespace recurve::test

#endif
