#include "command.h"
#include "interruption.h"
#include "output_options.h"

#include <recurve/io/mesh_io.h>
#include <recurve/run/stages.h>

#include <memory>

namespace recurve {

namespace {

struct Convert_arguments
{
  std::filesystem::path input, output;
  Write_options options;
  bool is_quiet = false;
};

void check_files(const Convert_arguments& given)
{
  check_usage([&] {
    mesh_format_of(given.input);
    check_writable(given.output, 1);
  });
  check_is_not_input(given.output, given.input);
}

std::string describe(const Convert_arguments& given, const Curved_mesh& mesh, const Read_report& report)
{
  Index patches = 0;
  for (const Zone& zone : mesh.linear.zones)
    patches += static_cast<Index>(zone.patches.size());
  std::string text =
    fmt::format("{} -> {}: degree {}, {} cells, {} nodes, {} zones, {} patches\n", given.input.string(),
                given.output.string(), mesh.degree, mesh.cell_count(), mesh.nodes.size(), mesh.zones.size(), patches);
  for (const std::string& note : report.notes)
    text += fmt::format("  note: {}\n", note);
  return text;
}

int run(const Convert_arguments& given)
{
  check_files(given);
  Progress_bar bar(!given.is_quiet);
  const Progress_callback progress = callback_of(bar);
  Read_report report;
  std::vector<Stage_time> times;
  const Curved_mesh mesh =
    run_stage("read", times, progress, [&] { return read_curved_mesh(given.input, &report, progress); });
  check_writable(given.output, mesh.degree);
  Pending_file output(given.output);
  remember_unfinished(0, output.path());
  run_stage("write", times, progress, [&] { write_mesh(mesh, output, {}, progress, given.options); });
  output.commit();
  bar.finish();
  tell_loss(given.output, mesh);
  if (!given.is_quiet)
    fmt::print("{}", describe(given, mesh, report));
  return exit_done;
}

} // namespace

Command add_convert_command(CLI::App& app)
{
  auto given = std::make_shared<Convert_arguments>();
  CLI::App* convert = app.add_subcommand("convert", "change the format without curving: recurve convert IN OUT");
  convert->add_option("IN", given->input, "mesh to read, linear or curved")->required();
  convert->add_option("OUT", given->output, "mesh to write; the format goes by the extension")->required();
  add_output_options(*convert, given->options);
  convert->add_flag("-q,--quiet", given->is_quiet, "no progress bar and no summary");
  return [given] { return run(*given); };
}

} // namespace recurve
