#ifndef RECURVE_CORE_EXCEPTIONS_H
#define RECURVE_CORE_EXCEPTIONS_H

#include <stdexcept>

namespace recurve {

/// An argument, option or mesh that breaks the documented contract of a function.
/// The message says what was expected and what was found.
class Input_error : public std::invalid_argument
{
public:
  using std::invalid_argument::invalid_argument;
};

/// A file that cannot be read or written as the format it claims to be.
/// The message names the file and, as far as they are known, zone, section, element and node.
class Format_error : public std::runtime_error
{
public:
  using std::runtime_error::runtime_error;
};

/// A numerical method that failed where its contract promises a result.
class Solver_error : public std::runtime_error
{
public:
  using std::runtime_error::runtime_error;
};

/// Thrown out of long work when the progress callback asks to stop; see `progress.h`.
class Cancelled : public std::runtime_error
{
public:
  Cancelled() : std::runtime_error("cancelled") {}
};

} // namespace recurve

#endif
