#ifndef RECURVE_APPS_INTERRUPTION_H
#define RECURVE_APPS_INTERRUPTION_H

#include <cstddef>
#include <filesystem>

namespace recurve {

/// lets Ctrl-C, kill and a closed terminal end the work at its next step, so that no half file is left; a second signal
/// ends it at once, with the exit status `status`. A crash is told in one line and leaves no half file either.
void catch_signals(int status);

/// whether a signal has come.
bool is_interrupted();

/// Number of unfinished files that can be remembered.
inline constexpr std::size_t unfinished_slots = 4;

/// names a file that is to be removed when a second signal or a crash ends the work.
void remember_unfinished(std::size_t slot, const std::filesystem::path& file);

} // namespace recurve

#endif
