// recurve: the program. Everything it does is a call of the library; here are only the command line, messages and exit
// status, one file a command.
#include "command.h"
#include "interruption.h"

#include <algorithm>
#include <new>
#include <string>
#include <utility>
#include <vector>

namespace recurve {

namespace {

constexpr const char* description =
  "recurve gives a straight-sided mesh its curves back: it reads a linear CFD mesh, reconstructs the smooth surface "
  "behind its boundary patches without CAD, and writes a mesh of curved high-order cells.";

constexpr const char* examples =
  "Examples:\n"
  "  recurve info wing.cgns                          zones, cells and patches of a mesh\n"
  "  recurve curve wing.cgns curved.cgns             quadratic cells, every boundary patch curved\n"
  "  recurve curve wing.cgns curved.vtu -p 4         degree 4, to look at in ParaView\n"
  "  recurve curve wing.cgns curved.cgns --curve 'wing*,fuselage' --report report.json\n"
  "                                                  only these patches; what happened goes to a file\n"
  "  recurve curve wing.cgns curved.cgns --keep farfield,symmetry\n"
  "                                                  all but these\n"
  "  recurve features wing.cgns -o edges.toml        its sharp edges: as text to edit, .csv or .vtp\n"
  "  recurve curve wing.cgns curved.cgns --features edges.toml\n"
  "                                                  with the edges that the file says\n"
  "  recurve check curved.cgns                       proves that no cell of a mesh is folded\n"
  "  recurve convert curved.cgns curved.msh --msh-version 2.2\n"
  "                                                  the same mesh in another format\n"
  "\n"
  "Formats by extension: .cgns, .msh (Gmsh), .h5 (HOPR), .vtu; read only: .su2, .ugrid. recurve formats lists them.\n"
  "Exit status: 0 done, 1 wrong command line, 2 bad input or a file that cannot be written, 3 a cell is not certified "
  "valid, 130 interrupted.\n"
  "The output appears when it is complete; after a failure there is none. The input is never changed.\n"
  "Every cell that was valid before is certified to be valid, at every point of it; where curving would fold a cell, "
  "some curvature is given up, and the report says where.";

/// one line on standard error, whatever the message holds.
int fail(std::string message, int status)
{
  while (!message.empty() && message.back() == '\n')
    message.pop_back();
  for (char& character : message)
    if (character == '\n' || character == '\r')
      character = ' ';
  fmt::print(stderr, "recurve: {}\n", message);
  return status;
}

/// the names of all commands, as a list to read.
std::string command_names(const CLI::App& app)
{
  const auto commands = app.get_subcommands([](const CLI::App*) { return true; });
  std::string names;
  for (std::size_t c = 0; c < commands.size(); ++c)
    names += (c == 0 ? "" : c + 1 == commands.size() ? " and " : ", ") + commands[c]->get_name();
  return names;
}

/// what is wrong with the command line, in the words of CLI11 but for a first word that is no command.
std::string parse_message(const CLI::App& app, const CLI::ParseError& error, int argc, char** argv)
{
  std::string message = error.what();
  const auto is_named = [&](const CLI::App* command) { return argc > 1 && command->check_name(argv[1]); };
  if (argc > 1 && argv[1][0] != '-' && app.get_subcommands(is_named).empty())
    message = fmt::format("\"{}\" is not a command; commands are {}", argv[1], command_names(app));
  return fmt::format("{} (recurve --help explains)", message);
}

int run_program(int argc, char** argv)
{
  CLI::App app(description, "recurve");
  app.footer(examples);
  app.require_subcommand(1);
  app.set_version_flag("--version", "recurve " RECURVE_VERSION);
  std::vector<std::pair<std::string, Command>> commands = {
    {"check", add_check_command(app)},       {"convert", add_convert_command(app)}, {"curve", add_curve_command(app)},
    {"features", add_features_command(app)}, {"formats", add_formats_command(app)}, {"info", add_info_command(app)},
  };
  try
  {
    app.parse(argc, argv);
  }
  catch (const CLI::ParseError& error)
  {
    if (error.get_exit_code() == 0)
      return app.exit(error); // --help, --version
    return fail(parse_message(app, error, argc, argv), exit_usage);
  }
  const auto chosen = std::find_if(commands.begin(), commands.end(),
                                   [&](const auto& command) { return app.got_subcommand(command.first); });
  return chosen->second();
}

/// runs `program` and turns what it throws into a line and an exit status.
template <class Program>
int run_guarded(Program program)
{
  try
  {
    return program();
  }
  catch (const Usage_error& error)
  {
    return fail(error.what(), exit_usage);
  }
  catch (const Cancelled&)
  {
    return fail("interrupted; nothing was written", exit_cancelled);
  }
  catch (const std::bad_alloc&)
  {
    return fail("not enough memory for this mesh", exit_bad_input);
  }
  catch (const std::exception& error)
  {
    return fail(error.what(), exit_bad_input);
  }
}

} // namespace

} // namespace recurve

int main(int argc, char** argv)
{
  recurve::catch_signals(recurve::exit_cancelled);
  return recurve::run_guarded([&] { return recurve::run_program(argc, argv); });
}
