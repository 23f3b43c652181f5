#include "surface_options.h"

#include "command.h"

#include <recurve/run/feature_file.h>

#include <algorithm>
#include <filesystem>

namespace recurve {

void add_surface_options(CLI::App& command, Surface_options& given, Curving_options& options)
{
  command
    .add_option("--curve", options.curve,
                "patches to curve, separated by commas: NAME, ZONE/NAME or a family, with wildcards * ? [] "
                "(default: all on the boundary)")
    ->type_name("PATCH")
    ->delimiter(',');
  command.add_option("--keep", options.keep, "patches that stay straight, named in the same way")
    ->type_name("PATCH")
    ->delimiter(',');
  command
    .add_option("--features", given.features,
                "auto: find sharp edges and corners; none: smooth everywhere; a TOML file: as its edits say")
    ->type_name("auto|none|FILE")
    ->capture_default_str();
  given.detection = add_detection_options(command, options.features);
}

namespace {

bool is_given(const Detection_options& options, const char* name)
{
  return std::any_of(options.begin(), options.end(),
                     [&](const CLI::Option* option) { return option->get_name() == name && option->count() > 0; });
}

} // namespace

void finish_surface_options(const Surface_options& given, Curving_options& options)
{
  check_usage([&] { check(options.features); });
  if (is_given(given.detection, "--feature-angle"))
    options.features.method = Feature_method::dihedral;
  std::string why = "--feature-angle is one threshold instead of all others";
  std::error_code ignored;
  if (given.features == "none")
  {
    options.features.method = Feature_method::none;
    why = "--features none finds nothing by angles";
  }
  else if (given.features != "auto" && !std::filesystem::exists(given.features, ignored))
    throw Usage_error(fmt::format("--features takes auto, none or a file; there is no file {}", given.features));
  else if (given.features != "auto")
  {
    options.feature_edits = read_feature_file(given.features);
    if (!options.feature_edits->starts_from_detection)
    {
      options.features.method = Feature_method::none;
      why = fmt::format("{} says start = \"none\", so that nothing is found by angles", given.features);
    }
  }
  refuse_unread(given.detection, options.features, why);
}

} // namespace recurve
