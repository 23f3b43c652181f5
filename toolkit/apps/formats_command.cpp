#include "command.h"

#include <recurve/io/mesh_io.h>

namespace recurve {

Command add_formats_command(CLI::App& app)
{
  app.add_subcommand("formats", "list the file formats: what is read and written, and what is lost");
  return [] {
    fmt::print("{}", format_table());
    return exit_done;
  };
}

} // namespace recurve
