#ifndef RECURVE_SRC_RUN_JSON_H
#define RECURVE_SRC_RUN_JSON_H

#include <recurve/features/feature_options.h>
#include <recurve/features/feature_report.h>
#include <recurve/run/mesh_summary.h>

#include <nlohmann/json.hpp>

namespace recurve {

/// Keys stand in the order in which they are written, which makes reports readable and comparable.
using Json = nlohmann::ordered_json;

Json json_of(const Mesh_summary& summary);
Json json_of(const Feature_options& options);
Json json_of(const Feature_report& features);

/// indented text. Bytes of a file that are not UTF-8 (names in an old mesh) are replaced.
inline std::string json_text(const Json& json)
{
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
}

} // namespace recurve

#endif
