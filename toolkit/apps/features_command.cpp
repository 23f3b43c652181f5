#include "command.h"
#include "describe.h"
#include "surface_options.h"

#include <recurve/io/mesh_io.h>
#include <recurve/run/feature_file.h>
#include <recurve/run/list_features.h>
#include <recurve/run/stages.h>

#include <memory>

namespace recurve {

namespace {

struct Features_arguments
{
  std::filesystem::path input, output;
  Surface_options surface;
  Curving_options options;
  bool as_json = false;
  bool is_quiet = false;
};

/// refuses before the work what can only fail after it.
void check_files(const Features_arguments& given)
{
  if (given.output.empty())
    return;
  check_usage([&] { check_feature_extension(given.output); });
  check_is_not_input(given.output, given.input);
}

int run(Features_arguments& given)
{
  finish_surface_options(given.surface, given.options);
  check_files(given);
  Progress_bar bar(!given.is_quiet);
  const Progress_callback progress = callback_of(bar);
  Read_report read_report;
  std::vector<Stage_time> times;
  Volume_mesh mesh = run_stage("read", times, progress, [&] { return read_mesh(given.input, &read_report, progress); });
  const Feature_listing listing =
    naming(given.input, [&] { return list_features(std::move(mesh), given.options, progress); });
  if (!given.output.empty())
    write_features(listing, given.output);
  bar.finish();
  if (given.as_json)
    fmt::print("{}", to_json(listing));
  else if (!given.is_quiet)
    fmt::print("{}: {}", given.input.string(), describe(listing));
  return exit_done;
}

} // namespace

Command add_features_command(CLI::App& app)
{
  auto given = std::make_shared<Features_arguments>();
  CLI::App* features = app.add_subcommand("features", "list the sharp edges of a mesh: recurve features IN [-o FILE]");
  features->add_option("IN", given->input, "linear mesh to read")->required();
  features
    ->add_option("-o,--output", given->output,
                 "write them: .toml (edits that give the same edges again), .csv (one edge a line) or .vtp")
    ->type_name("FILE");
  features->add_flag("--json", given->as_json, "list them, and what was rejected and why, as JSON");
  add_surface_options(*features, given->surface, given->options);
  features->add_flag("-q,--quiet", given->is_quiet, "no progress bar and no list");
  return [given] { return run(*given); };
}

} // namespace recurve
