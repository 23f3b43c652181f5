#ifndef RECURVE_APPS_WORDING_H
#define RECURVE_APPS_WORDING_H

#include <recurve/core/types.h>
#include <recurve/elements/element.h>

#include <string>
#include <string_view>
#include <vector>

namespace recurve {

/// "1,234,567": what people read.
std::string grouped(Index number);

/// "1 cell", "1,234 cells".
std::string counted(Index number, std::string_view singular, std::string_view plural);

std::string_view plural_name(Element_type type);

/// "(1, 2, 3)".
std::string at_point(const Point& point);

/// rows as columns: all but the last padded to their longest entry.
std::string table(const std::vector<std::vector<std::string>>& rows);

} // namespace recurve

#endif
