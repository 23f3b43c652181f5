#include "command.h"
#include "describe.h"
#include "wording.h"

#include <recurve/io/mesh_io.h>
#include <recurve/run/mesh_structure.h>
#include <recurve/run/mesh_summary.h>
#include <recurve/run/stages.h>

#include <nlohmann/json.hpp>

#include <memory>

namespace recurve {

namespace {

struct Info_arguments
{
  std::filesystem::path input;
  bool as_json = false;
};

int run(const Info_arguments& given)
{
  Progress_bar bar(true);
  const Progress_callback progress = callback_of(bar);
  Read_report read_report;
  std::vector<Stage_time> times;
  Curved_mesh mesh =
    run_stage("read", times, progress, [&] { return read_curved_mesh(given.input, &read_report, progress); });
  const Index straight_cells = update_straight_cells(mesh);
  const Mesh_structure structure =
    naming(given.input, [&] { return find_structure(mesh.linear, {}, times, progress); });
  const Mesh_summary summary = summarize(mesh.linear, structure);
  bar.finish();
  if (!given.as_json)
  {
    fmt::print("{}: {}", given.input.string(), describe(summary, read_report.notes));
    if (mesh.degree > 1)
      fmt::print("\nof degree {}: {}; {} of {} are exactly straight\n", mesh.degree,
                 counted(static_cast<Index>(mesh.nodes.size()), "node", "nodes"), grouped(straight_cells),
                 counted(mesh.cell_count(), "cell", "cells"));
    return exit_done;
  }
  auto json = nlohmann::ordered_json::parse(to_json(summary));
  json["file"] = given.input.string();
  json["degree"] = mesh.degree;
  json["nodes"] = mesh.nodes.size();
  json["straight_cells"] = straight_cells;
  json["notes"] = read_report.notes;
  fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
  return exit_done;
}

} // namespace

Command add_info_command(CLI::App& app)
{
  auto given = std::make_shared<Info_arguments>();
  CLI::App* info = app.add_subcommand("info", "say what a mesh consists of: recurve info IN");
  info->add_option("IN", given->input, "mesh to read, of any degree")->required();
  info->add_flag("--json", given->as_json, "as JSON");
  return [given] { return run(*given); };
}

} // namespace recurve
