#ifndef RECURVE_RUN_STAGES_H
#define RECURVE_RUN_STAGES_H

#include <recurve/core/progress.h>

#include <chrono>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace recurve {

/// How long a part of a run took.
struct Stage_time
{
  std::string stage;
  double seconds = 0;
};

/// runs `work` as the stage `name`: tells `progress` where it starts and ends, and appends its duration to `times`.
/// \returns what `work` returns. \throws Cancelled if `progress` asks to stop, and what `work` throws.
template <class Work>
auto run_stage(std::string_view name, std::vector<Stage_time>& times, const Progress_callback& progress, Work work)
{
  const auto start = std::chrono::steady_clock::now();
  const auto finish = [&] {
    times.push_back(
      {std::string(name), std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count()});
    report_progress(progress, name, 1);
  };
  report_progress(progress, name, 0);
  if constexpr (std::is_void_v<decltype(work())>)
  {
    work();
    finish();
  }
  else
  {
    auto result = work();
    finish();
    return result;
  }
}

} // namespace recurve

#endif
