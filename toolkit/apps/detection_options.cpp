#include "detection_options.h"

#include "command.h"

#include <algorithm>
#include <initializer_list>
#include <string_view>

namespace recurve {

namespace {

constexpr const char* group = "Sharp edges (angles in degrees; 0 is flat)";

/// Adds options to the group of a command and keeps them.
class Option_adder
{
public:
  explicit Option_adder(CLI::App& command) : command_(command) {}

  template <class Value>
  void number(const char* name, Value& value, const char* meaning)
  {
    keep(command_.add_option(name, value, meaning)->capture_default_str());
  }

  void flag(const char* name, bool& value, const char* meaning) { keep(command_.add_flag(name, value, meaning)); }

  void negation(const char* name, bool& value, const char* meaning)
  {
    keep(add_negation(command_, name, value, meaning));
  }

  Detection_options take() { return std::move(options_); }

private:
  void keep(CLI::Option* option) { options_.push_back(option->group(group)); }

  CLI::App& command_;
  Detection_options options_;
};

/// whether detection by `method` reads the option `name`.
bool is_read(Feature_method method, const std::string& name)
{
  const auto is_one_of = [&](std::initializer_list<std::string_view> names) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  switch (method)
  {
  case Feature_method::none: return is_one_of({"--patch-edges", "--turning-angle"});
  case Feature_method::dihedral:
    return is_one_of({"--feature-angle", "--patch-edges", "--smooth-patches", "--turning-angle", "--corner-defect"});
  case Feature_method::classified: return name != "--feature-angle";
  }
  return true;
}

} // namespace

Detection_options add_detection_options(CLI::App& command, Feature_options& options)
{
  Option_adder add(command);
  add.number("--feature-angle", options.dihedral_angle,
             "one angle instead of all the others: every edge whose faces turn by more is sharp, no other");
  add.flag("--patch-edges", options.patch_edges, "every edge between two patches is sharp");
  add.flag("--smooth-patches", options.smooth_patches, "only edges between two patches can be sharp");
  add.number("--weak-angle", options.weak_angle, "edges up to this are never sharp; 15 for noisy meshes");
  add.number("--end-angle", options.end_angle, "an edge supports its curve at a junction from this on");
  add.number("--strong-angle", options.strong_angle, "an edge above this is strong evidence for a doubtful curve");
  add.number("--strong-edges", options.strong_edges, "a curve with a doubtful end needs more strong edges than this");
  add.number("--sharp-angle", options.sharp_angle, "an edge above this is sharp wherever it is");
  add.number("--acute-angle", options.acute_angle, "beside an edge above this, edges that are not sharp are doubtful");
  add.number("--corner-defect", options.corner_defect,
             "a vertex whose face angles miss 360 degrees by as much is a corner");
  add.number("--turning-angle", options.turning_angle, "a curve that turns by more at a vertex is cut there");
  add.number("--ridge-deviation", options.ridge_deviation, "largest angle of an edge with the ridge that it continues");
  add.number("--ridge-ratio", options.ridge_ratio, "largest ratio of normal spreads, along to across, on a ridge");
  add.negation("--no-border-ends", options.border_ends, "a weak curve that ends at a border is no curve");
  add.negation("--no-reject-smooth", options.reject_smooth, "keep curves along which the surface bends as beside them");
  add.number("--smooth-angle", options.smooth_angle, "edges above this are never rejected as smooth");
  add.number("--smooth-contrast", options.smooth_contrast,
             "a curve is rejected as smooth if it bends less than so many times as much as the surface beside it");
  add.number("--crease-contrast", options.crease_contrast,
             "a doubtful curve is kept if it bends more than so many times as much as the surface beside it");
  return add.take();
}

void refuse_unread(const Detection_options& given, const Feature_options& options, const std::string& why)
{
  for (const CLI::Option* option : given)
    if (option->count() > 0 && !is_read(options.method, option->get_name()))
      throw Usage_error(fmt::format("{}: {} would have no effect", why, option->get_name()));
}

} // namespace recurve
