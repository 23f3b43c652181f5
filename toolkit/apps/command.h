#ifndef RECURVE_APPS_COMMAND_H
#define RECURVE_APPS_COMMAND_H

#include "progress_bar.h"

#include <recurve/core/exceptions.h>
#include <recurve/core/progress.h>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>

namespace recurve {

enum Exit_status
{
  exit_done = 0,
  exit_usage = 1,       // the command line itself is wrong
  exit_bad_input = 2,   // a file, a patch, the disk
  exit_uncertified = 3, // a cell is not certified valid
  exit_cancelled = 130  // what shells expect after Ctrl-C
};

/// A command line that asks for what cannot be, whatever the files hold.
class Usage_error : public std::invalid_argument
{
public:
  using std::invalid_argument::invalid_argument;
};

/// does what the command line asks for; gives the exit status.
using Command = std::function<int()>;

/// Each adds a subcommand with its options to `app` and gives what is to be run if it was chosen.
Command add_check_command(CLI::App& app);
Command add_convert_command(CLI::App& app);
Command add_curve_command(CLI::App& app);
Command add_features_command(CLI::App& app);
Command add_formats_command(CLI::App& app);
Command add_info_command(CLI::App& app);

/// shows progress in `bar` and ends the work when the user asks for that.
Progress_callback callback_of(Progress_bar& bar);

/// adds the flag `name` that makes `value` false. (What CLI11 has for this, `!name`, is written name{false} in the
/// help.)
CLI::Option* add_negation(CLI::App& command, const char* name, bool& value, const char* meaning);

bool is_same_file(const std::filesystem::path& a, const std::filesystem::path& b);

/// A stream or device such as /dev/stdout cannot be renamed into place; it is written directly.
bool is_stream(const std::filesystem::path& path);

/// refuses an output that is the input.
void check_is_not_input(const std::filesystem::path& output, const std::filesystem::path& input);

/// writes `text` to `path`; a failure is told with the name that the user knows, `name`.
void write_text(const std::string& text, const std::filesystem::path& path, const std::filesystem::path& name);

/// runs `work`; what it finds wrong with an argument is a fault of the command line.
template <class Work>
void check_usage(Work work)
{
  try
  {
    work();
  }
  catch (const Input_error& error)
  {
    throw Usage_error(error.what());
  }
}

/// runs `work` on the mesh of `file`, which knows nothing of files: faults of the mesh are told with the name of the
/// file.
template <class Work>
auto naming(const std::filesystem::path& file, Work work)
{
  try
  {
    return work();
  }
  catch (const Input_error& error)
  {
    throw Input_error(fmt::format("{}: {}", file.string(), error.what()));
  }
}

} // namespace recurve

#endif
