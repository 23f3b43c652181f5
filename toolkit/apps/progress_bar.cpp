#include "progress_bar.h"

#include <fmt/format.h>

#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace recurve {

namespace {

constexpr int width = 30;

} // namespace

Progress_bar::Progress_bar(bool is_wanted) : is_shown_(is_wanted && isatty(STDERR_FILENO) == 1)
{}

void Progress_bar::show(std::string_view stage, double fraction)
{
  if (!is_shown_)
    return;
  if (stage != stage_)
  {
    finish();
    stage_ = stage;
    start_ = std::chrono::steady_clock::now();
  }
  const int percent = static_cast<int>(100 * std::clamp(fraction, 0.0, 1.0));
  if (percent == percent_)
    return;
  percent_ = percent;
  draw(fraction);
}

void Progress_bar::draw(double fraction) const
{
  const int filled = static_cast<int>(width * std::clamp(fraction, 0.0, 1.0));
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  fmt::print(stderr, "\r{:<24} [{:=<{}}{:{}}] {:3d} % {:7.1f} s", stage_, "", filled, "", width - filled, percent_,
             seconds);
  std::fflush(stderr);
}

void Progress_bar::finish()
{
  if (!stage_.empty())
    fmt::print(stderr, "\n");
  stage_.clear();
  percent_ = -1;
}

} // namespace recurve
