#include "interruption.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <string>
#include <string_view>

namespace recurve {

namespace {

volatile std::sig_atomic_t has_signal = 0;
volatile std::sig_atomic_t exit_status = 0;

/// Names of the unfinished files, for a handler that may call next to nothing. Empty: none.
std::array<std::array<char, 4096>, unfinished_slots> unfinished_files = {};

void remove_unfinished()
{
  for (const auto& file : unfinished_files)
    if (file[0] != '\0')
      unlink(file.data());
}

void interrupt(int)
{
  if (has_signal == 0)
  {
    has_signal = 1;
    return;
  }
  remove_unfinished();
  _exit(exit_status);
}

/// leaves no half file after a crash; HDF5 crashes on some files whose bytes are damaged.
void crash(int signal)
{
  constexpr std::string_view message = "recurve: crashed; a damaged input can be the cause, else please report it\n";
  [[maybe_unused]] const auto count = write(STDERR_FILENO, message.data(), message.size());
  remove_unfinished();
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

void catch_crashes()
{
  // A stack that has overflown cannot hold the handler.
  static std::array<char, 1 << 16> memory = {};
  stack_t stack = {};
  stack.ss_sp = memory.data();
  stack.ss_size = memory.size();
  sigaltstack(&stack, nullptr);
  struct sigaction action = {};
  action.sa_handler = crash;
  action.sa_flags = SA_ONSTACK;
  for (int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGABRT})
    sigaction(signal, &action, nullptr);
}

} // namespace

void catch_signals(int status)
{
  exit_status = status;
  struct sigaction action = {};
  action.sa_handler = interrupt;
  for (int signal : {SIGINT, SIGTERM, SIGHUP})
    sigaction(signal, &action, nullptr);
  catch_crashes();
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
