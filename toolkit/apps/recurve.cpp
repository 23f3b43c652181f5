// recurve: the program. Everything it does is a call of the library; here are only the command line, messages and exit
// status.
#include "describe.h"
#include "progress_bar.h"

#include <recurve/core/exceptions.h>
#include <recurve/io/mesh_io.h>
#include <recurve/run/curve_mesh.h>
#include <recurve/run/feature_file.h>
#include <recurve/run/list_features.h>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <new>
#include <optional>
#include <string>

namespace {

namespace fs = std::filesystem;

enum Exit_status
{
  exit_done = 0,
  exit_usage = 1,     // the command line itself is wrong
  exit_bad_input = 2, // a file, a patch, the disk
  // 3 is kept for "the result is not certified valid"
  exit_cancelled = 130 // what shells expect after Ctrl-C
};

/// A command line that asks for what cannot be, whatever the files hold.
class Usage_error : public std::invalid_argument
{
public:
  using std::invalid_argument::invalid_argument;
};

volatile std::sig_atomic_t is_interrupted = 0;

/// Names of the unfinished files, for a handler that may call next to nothing. Empty: none.
std::array<std::array<char, 4096>, 2> unfinished_files = {};

void interrupt(int)
{
  if (is_interrupted == 0)
  {
    is_interrupted = 1;
    return;
  }
  for (const auto& file : unfinished_files)
    if (file[0] != '\0')
      unlink(file.data());
  _exit(exit_cancelled);
}

/// lets Ctrl-C, kill and a closed terminal end the work at its next step, so that no half file is left; a second signal
/// ends it at once.
void catch_signals()
{
  struct sigaction action = {};
  action.sa_handler = interrupt;
  for (int signal : {SIGINT, SIGTERM, SIGHUP})
    sigaction(signal, &action, nullptr);
  // A write beyond a file size limit then fails like one on a full disk, with a message.
  std::signal(SIGXFSZ, SIG_IGN);
}

/// tells the handler of the file in `slot`.
void remember_unfinished(std::size_t slot, const fs::path& file)
{
  const std::string name = file.string();
  if (name.size() < unfinished_files[slot].size())
    std::copy(name.begin(), name.end(), unfinished_files[slot].begin());
}

struct Curve_command
{
  fs::path input, output, report;
  recurve::Curving_options options;
  std::string features = "auto";
  std::optional<double> feature_angle;
  bool is_quiet = false;
};

struct Features_command
{
  fs::path input, output;
  recurve::Curving_options options;
  std::string features = "auto";
  std::optional<double> feature_angle;
  bool is_quiet = false;
};

struct Info_command
{
  fs::path input;
  bool as_json = false;
};

recurve::Progress_callback callback_of(recurve::Progress_bar& bar)
{
  return [&bar](std::string_view stage, double fraction) {
    bar.show(stage, fraction);
    return is_interrupted == 0;
  };
}

/// runs `work` on the mesh of `file`, which knows nothing of files: faults of the mesh are told with the name of the
/// file.
template <class Work>
auto naming(const fs::path& file, Work work)
{
  try
  {
    return work();
  }
  catch (const recurve::Input_error& error)
  {
    throw recurve::Input_error(fmt::format("{}: {}", file.string(), error.what()));
  }
}

bool is_same_file(const fs::path& a, const fs::path& b)
{
  std::error_code ignored;
  return fs::equivalent(a, b, ignored) || fs::weakly_canonical(a, ignored) == fs::weakly_canonical(b, ignored);
}

/// refuses before the work what can only fail after it.
void check_files(const Curve_command& command)
{
  try
  {
    recurve::check_writable(command.output, command.options.degree);
  }
  catch (const recurve::Input_error& error)
  {
    throw Usage_error(error.what());
  }
  if (is_same_file(command.input, command.output))
    throw Usage_error(
      fmt::format("{}: output and input are the same file; the input is never overwritten", command.output.string()));
  if (!command.report.empty() &&
      (is_same_file(command.report, command.input) || is_same_file(command.report, command.output)))
    throw Usage_error(fmt::format("{}: the report needs a file of its own", command.report.string()));
}

void check_files(const Features_command& command)
{
  if (command.output.empty())
    return;
  try
  {
    recurve::check_feature_extension(command.output);
  }
  catch (const recurve::Input_error& error)
  {
    throw Usage_error(error.what());
  }
  if (is_same_file(command.input, command.output))
    throw Usage_error(
      fmt::format("{}: output and input are the same file; the input is never overwritten", command.output.string()));
}

/// A stream or device such as /dev/stdout cannot be renamed into place; it is written directly.
bool is_stream(const fs::path& path)
{
  std::error_code ignored;
  return fs::exists(path, ignored) && !fs::is_regular_file(path, ignored) && !fs::is_directory(path, ignored);
}

void write_text(const std::string& text, const fs::path& path, const fs::path& name)
{
  std::ofstream stream(path, std::ios::binary);
  stream << text;
  stream.close();
  if (!stream)
    throw recurve::Format_error(fmt::format("{}: cannot be written: {}", name.string(), std::strerror(errno)));
}

/// the two files of a conversion: both complete, or none there.
class Results
{
public:
  explicit Results(const Curve_command& command) : mesh_(command.output), report_path_(command.report)
  {
    remember_unfinished(0, mesh_.path());
    if (!report_path_.empty() && !is_stream(report_path_))
    {
      report_.emplace(report_path_);
      remember_unfinished(1, report_->path());
    }
  }

  recurve::Pending_file& mesh() { return mesh_; }

  void commit(const recurve::Curving_report& report)
  {
    if (report_)
      write_text(to_json(report), report_->path(), report_path_);
    else if (!report_path_.empty())
      write_text(to_json(report), report_path_, report_path_);
    mesh_.commit();
    if (report_)
      report_->commit();
  }

private:
  recurve::Pending_file mesh_;
  fs::path report_path_;
  std::optional<recurve::Pending_file> report_;
};

void run(Curve_command& command)
{
  using namespace recurve;
  check_files(command);
  Progress_bar bar(!command.is_quiet);
  const Progress_callback progress = callback_of(bar);
  const auto start = std::chrono::steady_clock::now();

  Read_report read_report;
  std::vector<Stage_time> read_time;
  Volume_mesh linear =
    run_stage("read", read_time, progress, [&] { return read_mesh(command.input, &read_report, progress); });
  Results results(command);
  Curving_report report;
  const Curved_mesh curved =
    naming(command.input, [&] { return curve_mesh(std::move(linear), command.options, &report, progress); });
  run_stage("write", report.stages, progress, [&] { write_mesh(curved, results.mesh(), {}, progress); });

  report.input = command.input.string();
  report.output = command.output.string();
  report.notes = read_report.notes;
  report.stages.insert(report.stages.begin(), read_time.begin(), read_time.end());
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  report.peak_memory_bytes = peak_memory_bytes();
  results.commit(report);
  bar.finish();
  if (!command.is_quiet)
    fmt::print("{}", describe(report));
}

void run(const Features_command& command)
{
  using namespace recurve;
  Progress_bar bar(!command.is_quiet);
  const Progress_callback progress = callback_of(bar);
  Read_report read_report;
  std::vector<Stage_time> times;
  Volume_mesh mesh =
    run_stage("read", times, progress, [&] { return read_mesh(command.input, &read_report, progress); });
  const Feature_listing listing =
    naming(command.input, [&] { return list_features(std::move(mesh), command.options, progress); });
  if (!command.output.empty())
    write_features(listing, command.output);
  bar.finish();
  if (!command.is_quiet)
    fmt::print("{}: {}", command.input.string(), describe(listing));
}

void run(const Info_command& command)
{
  using namespace recurve;
  Progress_bar bar(true);
  const Progress_callback progress = callback_of(bar);
  Read_report read_report;
  std::vector<Stage_time> times;
  Volume_mesh mesh =
    run_stage("read", times, progress, [&] { return read_mesh(command.input, &read_report, progress); });
  const Mesh_structure structure = naming(command.input, [&] { return find_structure(mesh, {}, times, progress); });
  const Mesh_summary summary = summarize(mesh, structure);
  bar.finish();
  if (!command.as_json)
  {
    fmt::print("{}: {}", command.input.string(), describe(summary, read_report.notes));
    return;
  }
  auto json = nlohmann::ordered_json::parse(to_json(summary));
  json["file"] = command.input.string();
  json["notes"] = read_report.notes;
  fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

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
  "\n"
  "Formats by extension: .cgns (read; written up to degree 4), .vtu (written up to degree 6).\n"
  "Exit status: 0 done, 1 wrong command line, 2 bad input or a file that cannot be written, 130 interrupted.\n"
  "The output appears when it is complete; after a failure there is none. The input is never changed.\n"
  "Whether the curved cells are valid is not checked yet; the report says so.";

/// what curve and features have in common: the choice of patches and of sharp edges.
template <class Command>
void add_surface_options(CLI::App& app, Command& command)
{
  app
    .add_option("--curve", command.options.curve,
                "patches to curve, separated by commas: NAME, ZONE/NAME or a family, with wildcards * ? [] "
                "(default: all on the boundary)")
    ->type_name("PATCH")
    ->delimiter(',');
  app.add_option("--keep", command.options.keep, "patches that stay straight, named in the same way")
    ->type_name("PATCH")
    ->delimiter(',');
  app
    .add_option("--features", command.features,
                "auto: find sharp edges and corners; none: smooth everywhere; a TOML file: as its edits say")
    ->type_name("auto|none|FILE")
    ->capture_default_str();
  app
    .add_option("--feature-angle", command.feature_angle,
                "instead of auto: every edge whose faces turn by more than this many degrees is sharp, no other")
    ->check(CLI::Range(0.0, 180.0));
}

void add_curve_command(CLI::App& app, Curve_command& command)
{
  CLI::App* curve = app.add_subcommand("curve", "curve a mesh: recurve curve IN OUT");
  curve->footer(examples);
  curve->add_option("IN", command.input, "linear mesh to read")->required();
  curve->add_option("OUT", command.output, "curved mesh to write; the format goes by the extension")->required();
  curve->add_option("-p,--degree", command.options.degree, "degree of the elements")
    ->check(CLI::Range(1, recurve::max_degree))
    ->capture_default_str();
  curve
    ->add_option("-d,--fit-degree", command.options.fit_degree,
                 "degree of the polynomials fitted to the surface (default: the degree of the elements, at least 2)")
    ->check(CLI::Range(1, recurve::max_degree));
  add_surface_options(*curve, command);
  curve->add_option("--report", command.report, "write what happened as JSON")->type_name("FILE.json");
  curve->add_option("--threads", command.options.threads, "largest number of threads (default: all)")
    ->check(CLI::Range(1, 4096));
  curve->add_flag("-q,--quiet", command.is_quiet, "no progress bar and no summary");
}

void add_features_command(CLI::App& app, Features_command& command)
{
  CLI::App* features = app.add_subcommand("features", "list the sharp edges of a mesh: recurve features IN [-o FILE]");
  features->add_option("IN", command.input, "linear mesh to read")->required();
  features
    ->add_option("-o,--output", command.output,
                 "write them: .toml (edits that give the same edges again), .csv (one edge a line) or .vtp")
    ->type_name("FILE");
  add_surface_options(*features, command);
  features->add_flag("-q,--quiet", command.is_quiet, "no progress bar and no list");
}

void add_info_command(CLI::App& app, Info_command& command)
{
  CLI::App* info = app.add_subcommand("info", "say what a mesh consists of: recurve info IN");
  info->add_option("IN", command.input, "linear mesh to read")->required();
  info->add_flag("--json", command.as_json, "as JSON");
}

template <class Command>
void finish_options(Command& command)
{
  std::error_code ignored;
  if (command.features == "none" && command.feature_angle)
    throw Usage_error("--features none and --feature-angle exclude each other");
  if (command.features == "none")
    command.options.features.method = recurve::Feature_method::none;
  else if (command.features != "auto" && !fs::exists(command.features, ignored))
    throw Usage_error(fmt::format("--features takes auto, none or a file; there is no file {}", command.features));
  else if (command.features != "auto")
    command.options.feature_edits = recurve::read_feature_file(command.features);
  if (command.feature_angle)
  {
    command.options.features.method = recurve::Feature_method::dihedral;
    command.options.features.dihedral_angle = *command.feature_angle;
  }
}

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

/// what is wrong with the command line, in the words of CLI11 but for a first word that is no command.
std::string parse_message(const CLI::App& app, const CLI::ParseError& error, int argc, char** argv)
{
  std::string message = error.what();
  const auto is_named = [&](const CLI::App* command) { return argc > 1 && command->check_name(argv[1]); };
  if (argc > 1 && argv[1][0] != '-' && app.get_subcommands(is_named).empty())
    message = fmt::format("\"{}\" is not a command; commands are curve, features and info", argv[1]);
  return fmt::format("{} (recurve --help explains)", message);
}

int run_program(int argc, char** argv)
{
  Curve_command curve;
  Features_command features;
  Info_command info;
  CLI::App app(description, "recurve");
  app.footer(examples);
  app.require_subcommand(1);
  app.set_version_flag("--version", "recurve " RECURVE_VERSION);
  add_curve_command(app, curve);
  add_features_command(app, features);
  add_info_command(app, info);
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
  if (app.got_subcommand("info"))
    run(info);
  else if (app.got_subcommand("features"))
  {
    finish_options(features);
    check_files(features);
    run(features);
  }
  else
  {
    finish_options(curve);
    run(curve);
  }
  return exit_done;
}

} // namespace

int main(int argc, char** argv)
{
  catch_signals();
  try
  {
    return run_program(argc, argv);
  }
  catch (const Usage_error& error)
  {
    return fail(error.what(), exit_usage);
  }
  catch (const recurve::Cancelled&)
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
