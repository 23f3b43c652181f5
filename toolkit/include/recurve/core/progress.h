#ifndef RECURVE_CORE_PROGRESS_H
#define RECURVE_CORE_PROGRESS_H

#include <recurve/core/exceptions.h>

#include <functional>
#include <string_view>

namespace recurve {

/// is called with the name of the running stage and the fraction of it that is done, 0 at its start and 1 at its end;
/// returns whether to go on. Called from one thread at a time, at most about a hundred times a stage.
using Progress_callback = std::function<bool(std::string_view stage, double fraction)>;

/// calls `callback` if there is one.
/// \throws Cancelled if it returns false.
inline void report_progress(const Progress_callback& callback, std::string_view stage, double fraction)
{
  if (callback && !callback(stage, fraction))
    throw Cancelled();
}

} // namespace recurve

#endif
