#ifndef RECURVE_SRC_RUN_VALIDITY_JSON_H
#define RECURVE_SRC_RUN_VALIDITY_JSON_H

#include "json.h"

#include <recurve/run/certification.h>
#include <recurve/run/validity_check.h>

#include <vector>

namespace recurve {

Json json_of(const Jacobian_report& report);
Json json_of(const std::vector<Cell_verdict>& cells);
Json json_of(const Certification& certification);

} // namespace recurve

#endif
