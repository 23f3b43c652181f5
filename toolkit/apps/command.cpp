#include "command.h"

#include "interruption.h"

#include <cerrno>
#include <cstring>
#include <fstream>

namespace recurve {

namespace fs = std::filesystem;

Progress_callback callback_of(Progress_bar& bar)
{
  return [&bar](std::string_view stage, double fraction) {
    bar.show(stage, fraction);
    return !is_interrupted();
  };
}

CLI::Option* add_negation(CLI::App& command, const char* name, bool& value, const char* meaning)
{
  return command.add_flag_callback(
    name, [&value] { value = false; }, meaning);
}

bool is_same_file(const fs::path& a, const fs::path& b)
{
  std::error_code ignored;
  return fs::equivalent(a, b, ignored) || fs::weakly_canonical(a, ignored) == fs::weakly_canonical(b, ignored);
}

bool is_stream(const fs::path& path)
{
  std::error_code ignored;
  return fs::exists(path, ignored) && !fs::is_regular_file(path, ignored) && !fs::is_directory(path, ignored);
}

void check_is_not_input(const fs::path& output, const fs::path& input)
{
  if (is_same_file(input, output))
    throw Usage_error(
      fmt::format("{}: output and input are the same file; the input is never overwritten", output.string()));
}

void write_text(const std::string& text, const fs::path& path, const fs::path& name)
{
  std::ofstream stream(path, std::ios::binary);
  stream << text;
  stream.close();
  if (!stream)
    throw Format_error(fmt::format("{}: cannot be written: {}", name.string(), std::strerror(errno)));
}

} // namespace recurve
