#ifndef RECURVE_APPS_SURFACE_OPTIONS_H
#define RECURVE_APPS_SURFACE_OPTIONS_H

#include "detection_options.h"

#include <recurve/run/curving_options.h>

#include <CLI/CLI.hpp>

#include <string>

namespace recurve {

/// What curve and features have in common: the choice of patches and of sharp edges, as the command line gives it.
struct Surface_options
{
  std::string features = "auto";
  Detection_options detection; ///< known from the moment they are added
};

/// adds the options of the surface to a command; they go into `given` and straight into `options`.
void add_surface_options(CLI::App& command, Surface_options& given, Curving_options& options);

/// carries what was given over to `options`, reading the feature file if one is named.
/// \throws Usage_error if options contradict each other or have no effect; Input_error if the feature file is faulty.
void finish_surface_options(const Surface_options& given, Curving_options& options);

} // namespace recurve

#endif
