#ifndef RECURVE_APPS_DETECTION_OPTIONS_H
#define RECURVE_APPS_DETECTION_OPTIONS_H

#include <recurve/features/feature_options.h>

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

namespace recurve {

/// The options of a command that go into `Feature_options`.
using Detection_options = std::vector<const CLI::Option*>;

/// adds an option for each threshold of `options`, all in a group of their own; the values go straight there.
Detection_options add_detection_options(CLI::App& command, Feature_options& options);

/// refuses options that the method of `options` does not read: whoever gives one expects that it has an effect.
/// \param why  what makes them useless: "--features none finds nothing by angles".
/// \throws Usage_error that names the first one given.
void refuse_unread(const Detection_options& given, const Feature_options& options, const std::string& why);

} // namespace recurve

#endif
