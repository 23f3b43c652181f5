#include "command.h"
#include "describe.h"
#include "interruption.h"
#include "output_options.h"
#include "surface_options.h"

#include <recurve/io/mesh_io.h>
#include <recurve/io/vtk.h>
#include <recurve/run/curve_mesh.h>
#include <recurve/run/curve_surface_mesh.h>
#include <recurve/run/stages.h>

#include <array>
#include <chrono>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace recurve {

namespace {

namespace fs = std::filesystem;

struct Curve_arguments
{
  fs::path input, output, report, histogram;
  Surface_options surface;
  std::vector<std::string> periodic; ///< "A,B"
  Curving_options options;
  Write_options write;
  bool is_quiet = false;
};

Picture_format picture_format(const fs::path& file)
{
  if (file.extension() == ".svg")
    return Picture_format::svg;
  if (file.extension() == ".png")
    return Picture_format::png;
  throw Usage_error(fmt::format("{}: the histogram is written as .svg or .png", file.string()));
}

/// refuses before the work what can only fail after it.
void check_files(const Curve_arguments& given)
{
  check_usage([&] { check_writable(given.output, given.options.degree); });
  check_is_not_input(given.output, given.input);
  if (!given.report.empty() && (is_same_file(given.report, given.input) || is_same_file(given.report, given.output)))
    throw Usage_error(fmt::format("{}: the report needs a file of its own", given.report.string()));
  if (given.histogram.empty())
    return;
  picture_format(given.histogram);
  for (const fs::path& other : {given.input, given.output, given.report})
    if (!other.empty() && is_same_file(given.histogram, other))
      throw Usage_error(fmt::format("{}: the histogram needs a file of its own", given.histogram.string()));
}

/// A text, or a picture, that is written beside the mesh, or to a stream.
class Text_result
{
public:
  Text_result(fs::path name, std::size_t slot) : name_(std::move(name))
  {
    if (name_.empty() || is_stream(name_))
      return;
    file_.emplace(name_);
    remember_unfinished(slot, file_->path());
  }

  const fs::path& name() const { return name_; }

  template <class MakeText>
  void write(const MakeText& make_text)
  {
    if (!name_.empty())
      write_text(make_text(), file_ ? file_->path() : name_, name_);
  }

  void commit()
  {
    if (file_)
      file_->commit();
  }

private:
  fs::path name_;
  std::optional<Pending_file> file_;
};

/// the files of a conversion: all complete, or none there.
class Results
{
public:
  explicit Results(const Curve_arguments& given)
    : mesh_(given.output), report_(given.report, 1), histogram_(given.histogram, 2)
  {
    remember_unfinished(0, mesh_.path());
  }

  Pending_file& mesh() { return mesh_; }

  void commit(const Curving_report& report)
  {
    report_.write([&] { return to_json(report); });
    histogram_.write([&] { return draw_histogram(report.jacobians, picture_format(histogram_.name())); });
    mesh_.commit();
    report_.commit();
    histogram_.commit();
  }

private:
  Pending_file mesh_;
  Text_result report_, histogram_;
};

/// "A,B" as A and B.
std::array<std::string, 2> split_pair(const std::string& pair)
{
  const auto comma = pair.find(',');
  if (comma == std::string::npos || pair.find(',', comma + 1) != std::string::npos)
    throw Usage_error(fmt::format("--periodic takes two patches, as A,B; not {}", pair));
  return {pair.substr(0, comma), pair.substr(comma + 1)};
}

/// curves a surface mesh (OFF, OBJ, PLY, STL), which has neither patches nor an interior.
int run_on_surface(const Curve_arguments& given)
{
  if (!given.options.curve.empty() || !given.options.keep.empty() || given.options.feature_edits)
    throw Usage_error(
      fmt::format("{}: a surface mesh has no patches to choose and no edges to edit", given.input.string()));
  if (!given.report.empty())
    throw Usage_error("--report: there is none for a surface mesh");
  if (!given.histogram.empty())
    throw Usage_error("--histogram: a surface mesh has no cells");
  if (!given.periodic.empty())
    throw Usage_error("--periodic: a surface mesh has no patches");
  Progress_bar bar(!given.is_quiet);
  const Progress_callback progress = callback_of(bar);
  Pending_file file(given.output);
  remember_unfinished(0, file.path());
  Surface_mesh_report report;
  const Curved_mesh curved = naming(
    given.input, [&] { return curve_surface_mesh(read_surface_mesh(given.input), given.options, &report, progress); });
  write_mesh(curved, file, {}, progress);
  file.commit();
  bar.finish();
  if (!given.is_quiet)
    fmt::print(
      "{}: {} faces curved to degree {}; {} critical edges; {} at a lower degree; {} nodes moved, the farthest "
      "{:.4g}\nwrote {}\n",
      given.input.string(), report.fits.faces, given.options.degree, report.features.critical_edges,
      report.fits.lowered_faces, report.curving.moved_edge_nodes + report.curving.moved_face_nodes,
      report.curving.largest_displacement, given.output.string());
  return exit_done;
}

int run(Curve_arguments& given)
{
  finish_surface_options(given.surface, given.options);
  check_files(given);
  if (is_surface_file(given.input))
    return run_on_surface(given);
  for (const std::string& pair : given.periodic)
    given.options.periodic.push_back(split_pair(pair));
  given.options.record_jacobians = !given.histogram.empty();
  Progress_bar bar(!given.is_quiet);
  const Progress_callback progress = callback_of(bar);
  const auto start = std::chrono::steady_clock::now();

  Read_report read_report;
  std::vector<Stage_time> read_time;
  Volume_mesh linear =
    run_stage("read", read_time, progress, [&] { return read_mesh(given.input, &read_report, progress); });
  Results results(given);
  Curving_report report;
  const Curved_mesh curved =
    naming(given.input, [&] { return curve_mesh(std::move(linear), given.options, &report, progress); });
  run_stage("write", report.stages, progress,
            [&] { write_mesh(curved, results.mesh(), cell_fields(report.certification), progress, given.write); });

  report.input = given.input.string();
  report.output = given.output.string();
  report.notes = read_report.notes;
  report.stages.insert(report.stages.begin(), read_time.begin(), read_time.end());
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  report.peak_memory_bytes = peak_memory_bytes();
  results.commit(report);
  bar.finish();
  tell_loss(given.output, curved);
  if (!given.is_quiet)
    fmt::print("{}", describe(report));
  return report.certification.is_certified() ? exit_done : exit_uncertified;
}

/// A number from `least` to `most`, which `words` describe; nan is none.
CLI::Validator number_within(double least, double most, const std::string& words)
{
  const auto check = [=](const std::string& text) {
    double number = 0;
    const bool is_number = CLI::detail::lexical_cast(text, number);
    return is_number && number >= least && number <= most ? std::string()
                                                          : fmt::format("expected {}, found {}", words, text);
  };
  return {check, ""};
}

void add_deformation_options(CLI::App& curve, Curve_arguments& given)
{
  constexpr double smallest = std::numeric_limits<double>::min(), largest = std::numeric_limits<double>::max();
  const auto a_length = number_within(smallest, largest, "a positive number");
  // A higher power leaves only the nearest node, and soon exceeds all numbers.
  const auto an_exponent = number_within(0.01, 20, "0.01 to 20");
  constexpr const char* group = "Interior";
  Deformation_options& formula = given.options.deformation;
  add_negation(curve, "--no-deform", given.options.deform,
               "bend only cells that touch the curved surface; thin layers behind it may fold")
    ->group(group);
  curve
    .add_option("--periodic", given.periodic,
                "patches that are a translation apart and stay so, as A,B; may be given again. What the mesh calls "
                "periodic stays so by itself")
    ->type_name("A,B")
    ->take_all()
    ->group(group);
  curve
    .add_option(
      "--influence-radius", formula.summation.reach,
      "distance from the nearest node of the boundary that moves, beyond which nothing does, in the unit of the mesh "
      "(default: no limit)")
    ->check(a_length)
    ->group(group);
  curve
    .add_option("--influence-length", formula.length,
                "L of the formula (L/r)^a + (alpha L/r)^b, in the unit of the mesh (default: the mean length of the "
                "edges of curved faces)")
    ->check(a_length)
    ->group(group);
  curve.add_option("--influence-alpha", formula.alpha, "its alpha, the weight of what is near")
    ->check(number_within(0, 100, "0 to 100"))
    ->capture_default_str()
    ->group(group);
  curve.add_option("--influence-far", formula.a, "its exponent a, of what is far")
    ->check(an_exponent)
    ->capture_default_str()
    ->group(group);
  curve.add_option("--influence-near", formula.b, "its exponent b, of what is near")
    ->check(an_exponent)
    ->capture_default_str()
    ->group(group);
  curve
    .add_flag(
      "--area-weights", given.options.area_weights,
      "weigh each node by its area of the boundary, so that a fine wall has no more influence than a coarse one")
    ->group(group);
  curve
    .add_option("--deform-error", formula.summation.error_bound,
                "largest error of the motion inside, relative to the largest displacement of the surface")
    ->check(number_within(1e-9, 1, "1e-9 to 1"))
    ->capture_default_str()
    ->group(group);
}

} // namespace

Command add_curve_command(CLI::App& app)
{
  auto given = std::make_shared<Curve_arguments>();
  CLI::App* curve = app.add_subcommand("curve", "curve a mesh: recurve curve IN OUT");
  curve->footer(app.get_footer());
  curve->add_option("IN", given->input, "linear mesh to read")->required();
  curve->add_option("OUT", given->output, "curved mesh to write; the format goes by the extension")->required();
  curve->add_option("-p,--degree", given->options.degree, "degree of the elements")
    ->check(CLI::Range(1, max_degree))
    ->capture_default_str();
  curve
    ->add_option("-d,--fit-degree", given->options.fit_degree,
                 "degree of the polynomials fitted to the surface (default: the degree of the elements, at least 2)")
    ->check(CLI::Range(1, max_degree));
  curve
    ->add_option("--fit-preset", given->options.fit_preset,
                 "how the surface is fitted: default, or as in the paper by Ims and Wang")
    ->transform(CLI::CheckedTransformer(
                  std::map<std::string, Fit_preset>{{"default", Fit_preset::standard}, {"paper", Fit_preset::paper}})
                  .description(""))
    ->type_name("default|paper")
    ->default_str("default");
  add_surface_options(*curve, given->surface, given->options);
  add_deformation_options(*curve, *given);
  add_output_options(*curve, given->write);
  curve->add_option("--report", given->report, "write what happened as JSON")->type_name("FILE.json");
  curve
    ->add_option("--histogram", given->histogram,
                 "bound the Jacobians of all cells after each step as well, and draw their histograms")
    ->type_name("FILE.svg|.png");
  curve->add_option("--threads", given->options.threads, "largest number of threads (default: all)")
    ->check(CLI::Range(1, 4096));
  curve->add_flag("-q,--quiet", given->is_quiet, "no progress bar and no summary");
  return [given] { return run(*given); };
}

} // namespace recurve
