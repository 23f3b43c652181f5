#include "interruption.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <string>

namespace recurve {

namespace {

volatile std::sig_atomic_t has_signal = 0;
volatile std::sig_atomic_t exit_status = 0;

/// Names of the unfinished files, for a handler that may call next to nothing. Empty: none.
std::array<std::array<char, 4096>, unfinished_slots> unfinished_files = {};

void interrupt(int)
{
  if (has_signal == 0)
  {
    has_signal = 1;
    return;
  }
  for (const auto& file : unfinished_files)
    if (file[0] != '\0')
      unlink(file.data());
  _exit(exit_status);
}

} // namespace

void catch_signals(int status)
{
  exit_status = status;
  struct sigaction action = {};
  action.sa_handler = interrupt;
  for (int signal : {SIGINT, SIGTERM, SIGHUP})
    sigaction(signal, &action, nullptr);
  // A write beyond a file size limit then fails like one on a full disk, with a message.
  std::signal(SIGXFSZ, SIG_IGN);
}

bool is_interrupted()
{
  return has_signal != 0;
}

void remember_unfinished(std::size_t slot, const std::filesystem::path& file)
{
  const std::string name = file.string();
  if (name.size() < unfinished_files[slot].size())
    std::copy(name.begin(), name.end(), unfinished_files[slot].begin());
}

} // namespace recurve
