#ifndef RECURVE_APPS_DESCRIBE_H
#define RECURVE_APPS_DESCRIBE_H

#include <recurve/run/curving_report.h>
#include <recurve/run/list_features.h>
#include <recurve/run/mesh_summary.h>

#include <string>

namespace recurve {

/// what `recurve info` prints: zones, cells, patches and interfaces as tables.
std::string describe(const Mesh_summary& summary, const std::vector<std::string>& notes);

/// what `recurve features` prints: the curves as a table.
std::string describe(const Feature_listing& listing);

/// what `recurve curve` prints when it is done: a few lines.
std::string describe(const Curving_report& report);

} // namespace recurve

#endif
