#ifndef RECURVE_APPS_DESCRIBE_VALIDITY_H
#define RECURVE_APPS_DESCRIBE_VALIDITY_H

#include <recurve/run/certification.h>
#include <recurve/run/validity_check.h>

#include <string>

namespace recurve {

/// what `recurve curve` says about validity.
std::string describe(const Certification& certification);

/// what `recurve check` prints about the mesh of a file.
std::string describe(const Validity_check& check, const std::string& file);

} // namespace recurve

#endif
