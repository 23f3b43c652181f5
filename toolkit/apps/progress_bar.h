#ifndef RECURVE_APPS_PROGRESS_BAR_H
#define RECURVE_APPS_PROGRESS_BAR_H

#include <chrono>
#include <string>
#include <string_view>

namespace recurve {

/// Draws one line per stage of long work on standard error, if that is a terminal; else nothing.
class Progress_bar
{
public:
  explicit Progress_bar(bool is_wanted);
  ~Progress_bar() { finish(); }
  Progress_bar(const Progress_bar&) = delete;
  Progress_bar& operator=(const Progress_bar&) = delete;

  /// draws `fraction` of `stage`; a new stage closes the line of the last.
  void show(std::string_view stage, double fraction);

  /// closes the line of the running stage, so that other text starts on a line of its own.
  void finish();

private:
  void draw(double fraction) const;

  bool is_shown_ = false;
  std::string stage_;
  int percent_ = -1;
  std::chrono::steady_clock::time_point start_;
};

} // namespace recurve

#endif
