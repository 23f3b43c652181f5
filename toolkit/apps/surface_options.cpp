#include "surface_options.h"

#include "command.h"

#include <recurve/run/feature_file.h>

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
  command
    .add_option("--feature-angle", given.feature_angle,
                "instead of auto: every edge whose faces turn by more than this many degrees is sharp, no other")
    ->check(CLI::Range(0.0, 180.0));
}

void finish_surface_options(const Surface_options& given, Curving_options& options)
{
  std::error_code ignored;
  if (given.features == "none" && given.feature_angle)
    throw Usage_error("--features none and --feature-angle exclude each other");
  if (given.features == "none")
    options.features.method = Feature_method::none;
  else if (given.features != "auto" && !std::filesystem::exists(given.features, ignored))
    throw Usage_error(fmt::format("--features takes auto, none or a file; there is no file {}", given.features));
  else if (given.features != "auto")
    options.feature_edits = read_feature_file(given.features);
  if (given.feature_angle)
  {
    options.features.method = Feature_method::dihedral;
    options.features.dihedral_angle = *given.feature_angle;
  }
}

} // namespace recurve
