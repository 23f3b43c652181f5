#include "command.h"
#include "describe_validity.h"

#include <recurve/io/mesh_io.h>
#include <recurve/run/stages.h>
#include <recurve/run/validity_check.h>

#include <nlohmann/json.hpp>
#include <tbb/global_control.h>

#include <memory>
#include <optional>

namespace recurve {

namespace {

constexpr const char* explanation =
  "Certifies that no cell of a mesh is folded: straight or curved, degrees 1 to 6, tetrahedra, pyramids, prisms and "
  "hexahedra, from whichever program.\n"
  "The determinant of each cell's Jacobian matrix is bounded everywhere in the cell, not sampled: a cell called valid "
  "is valid at every point, also between corners, nodes and integration points. \"invalid\" means that the "
  "determinant is zero or negative somewhere; \"undecided\", that neither could be proven, so do not rely on the "
  "cell.\n"
  "The scaled Jacobian is the determinant's certified lower bound over its upper bound: 1 for a cell that is straight "
  "and undistorted along its parameters, near 0 for one about to fold. Cells are numbered from 0 in "
  "each zone.\n";

constexpr const char* examples =
  "Examples:\n"
  "  recurve check curved.cgns                       verdict by cell type, worst cells, histogram\n"
  "  recurve check curved.msh --worst 50             the fifty worst cells\n"
  "  recurve check curved.cgns --vtu verdict.vtu     look at \"scaled_jacobian\" and \"verdict\" in ParaView\n"
  "  recurve check curved.cgns --json | jq .is_valid for scripts\n"
  "\n"
  "Exit status: 0 every cell is certified valid, 3 not every cell is, 1 wrong command line, 2 bad input.";

struct Check_arguments
{
  std::filesystem::path input, picture;
  int worst = 10, threads = 0;
  bool as_json = false;
};

void write_picture(const Check_arguments& given, const Curved_mesh& mesh, const Validity_check& check,
                   const Progress_callback& progress)
{
  if (!given.picture.empty())
    write_mesh(mesh, given.picture, cell_fields(check.bounds), progress);
}

int run(const Check_arguments& given)
{
  if (!given.picture.empty())
  {
    check_is_not_input(given.picture, given.input);
    if (given.picture.extension() != ".vtu")
      throw Usage_error(fmt::format("{}: --vtu writes a .vtu file", given.picture.string()));
  }
  std::optional<tbb::global_control> threads;
  if (given.threads > 0)
    threads.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(given.threads));
  Progress_bar bar(true);
  const Progress_callback progress = callback_of(bar);
  Read_report read_report;
  std::vector<Stage_time> times;
  const Curved_mesh mesh =
    run_stage("read", times, progress, [&] { return read_curved_mesh(given.input, &read_report, progress); });
  if (mesh.cell_count() == 0)
    throw Input_error(given.input.string() + ": no cells, so there is nothing to certify");
  const Validity_check check = run_stage("certify", times, progress, [&] {
    return check_validity(mesh, static_cast<std::size_t>(given.worst), {}, progress);
  });
  write_picture(given, mesh, check, progress);
  bar.finish();
  if (given.as_json)
  {
    auto json = nlohmann::ordered_json::parse(to_json(check));
    json["file"] = given.input.string();
    json["notes"] = read_report.notes;
    fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
  }
  else
    fmt::print("{}", describe(check, given.input.string()));
  return check.is_valid() ? exit_done : exit_uncertified;
}

} // namespace

Command add_check_command(CLI::App& app)
{
  auto given = std::make_shared<Check_arguments>();
  CLI::App* check = app.add_subcommand("check", "certify that no cell is folded: recurve check FILE");
  check->description(explanation);
  check->footer(examples);
  check->add_option("FILE", given->input, "mesh to read, of any degree")->required();
  check->add_option("--worst", given->worst, "how many of the worst cells to list")
    ->check(CLI::Range(0, 1000000))
    ->capture_default_str();
  check->add_flag("--json", given->as_json, "as JSON");
  check->add_option("--vtu", given->picture, "write the mesh with verdict and scaled Jacobian of each cell")
    ->type_name("FILE.vtu");
  check->add_option("--threads", given->threads, "largest number of threads (default: all)")
    ->check(CLI::Range(1, 4096));
  return [given] { return run(*given); };
}

} // namespace recurve
