#include "input_file.h"

#include <recurve/core/exceptions.h>

#include <fmt/format.h>

#include <fcntl.h>

#include <cerrno>

namespace recurve::internal {

namespace {

constexpr std::size_t buffer_bytes = std::size_t{1} << 20;

// The system reads that much ahead, so that the disk does not wait while numbers are taken from the buffer.
constexpr std::uint64_t ahead_bytes = std::uint64_t{32} << 20;

// Words of a mesh file are numbers and names; a longer one is no text.
constexpr std::size_t longest_word = 4096;

bool is_space(char character)
{
  return character == ' ' || (character >= '\t' && character <= '\r');
}

} // namespace

std::string printable(std::string_view text)
{
  std::string result(text.substr(0, 40));
  for (char& character : result)
    if (static_cast<unsigned char>(character) < 32 || static_cast<unsigned char>(character) > 126)
      character = '?';
  return result;
}

Input_file::Input_file(const std::filesystem::path& file, const Progress_callback& progress)
  : path_(file), progress_(progress), file_(std::fopen(file.c_str(), "rb"), std::fclose)
{
  if (!file_)
    throw Format_error(fmt::format("{}: cannot be opened: {}", file.string(), std::strerror(errno)));
  std::setvbuf(file_.get(), nullptr, _IONBF, 0);
  std::error_code error;
  size_ = std::filesystem::file_size(file, error);
  if (error)
    throw Format_error(fmt::format("{}: its size is not known: {}", file.string(), error.message()));
  buffer_.resize(std::clamp<std::size_t>(size_ + 1, 2 * longest_word, buffer_bytes)); // small for small files
}

void Input_file::check_count(std::uint64_t count, std::uint64_t bytes, std::string_view what) const
{
  if (bytes > 0 && count > remaining() / bytes)
    fail(fmt::format("{} {} cannot be in the rest of the file, {} bytes", count, what, remaining()));
}

void Input_file::fetch_ahead()
{
  const std::uint64_t here = buffer_offset_ + end_;
  if (size_ <= buffer_bytes || here + ahead_bytes / 2 < fetched_)
    return;
  fetched_ = std::max(fetched_, here);
  posix_fadvise(fileno(file_.get()), static_cast<off_t>(fetched_), static_cast<off_t>(ahead_bytes),
                POSIX_FADV_WILLNEED);
  fetched_ += ahead_bytes;
}

bool Input_file::refill()
{
  std::copy(buffer_.begin() + static_cast<std::ptrdiff_t>(at_), buffer_.begin() + static_cast<std::ptrdiff_t>(end_),
            buffer_.begin());
  buffer_offset_ += at_;
  end_ -= at_;
  at_ = 0;
  fetch_ahead();
  const std::size_t count = std::fread(buffer_.data() + end_, 1, buffer_.size() - end_, file_.get());
  if (count == 0 && std::ferror(file_.get()) != 0)
    fail(fmt::format("cannot be read: {}", std::strerror(errno)));
  end_ += count;
  const std::uint64_t percent = std::min<std::uint64_t>(100, 100 * (buffer_offset_ + end_) / (size_ + 1));
  if (percent > percent_)
    report_progress(progress_, "read", static_cast<double>(percent_ = percent) / 100);
  return count > 0;
}

void Input_file::fill(std::size_t count)
{
  while (end_ - at_ < count)
    if (!refill())
      fail("ends too early");
}

bool Input_file::read_line(std::string& line)
{
  line.clear();
  for (;;)
  {
    const auto first = buffer_.begin() + static_cast<std::ptrdiff_t>(at_);
    const auto last = buffer_.begin() + static_cast<std::ptrdiff_t>(end_);
    const auto end = std::find(first, last, '\n');
    line.append(first, end);
    at_ = static_cast<std::size_t>(end - buffer_.begin());
    if (end != last)
    {
      ++at_;
      ++line_;
      break;
    }
    if (!refill())
    {
      if (line.empty())
        return false;
      break;
    }
  }
  if (!line.empty() && line.back() == '\r')
    line.pop_back();
  return true;
}

std::string_view Input_file::read_word()
{
  for (;;)
  {
    while (at_ < end_ && is_space(buffer_[at_]))
      line_ += buffer_[at_++] == '\n';
    if (at_ < end_ || !refill())
      break;
  }
  std::size_t length = 0;
  for (;;)
  {
    while (at_ + length < end_ && !is_space(buffer_[at_ + length]))
      ++length;
    if (length > longest_word)
      fail_in_text("a word without end: this is no text");
    if (at_ + length < end_ || !refill())
      break;
  }
  const std::string_view word(buffer_.data() + at_, length);
  at_ += length;
  return word;
}

void Input_file::skip_bytes(std::uint64_t count)
{
  while (count > 0)
  {
    if (at_ == end_ && !refill())
      fail("ends too early");
    const std::size_t step = static_cast<std::size_t>(std::min<std::uint64_t>(count, end_ - at_));
    at_ += step;
    count -= step;
  }
}

bool Input_file::skip_behind(std::string_view text)
{
  for (;;)
  {
    const std::string_view have(buffer_.data() + at_, end_ - at_);
    const std::size_t found = have.find(text);
    const std::size_t passed = found != std::string_view::npos ? found + text.size()
                               : have.size() >= text.size()    ? have.size() - text.size() + 1
                                                               : 0;
    line_ += std::count(have.begin(), have.begin() + static_cast<std::ptrdiff_t>(passed), '\n');
    at_ += passed;
    if (found != std::string_view::npos)
      return true;
    if (!refill())
      return false;
  }
}

void Input_file::rewind()
{
  std::rewind(file_.get());
  buffer_offset_ = fetched_ = 0;
  at_ = end_ = 0;
  line_ = 1;
}

void Input_file::fail(std::string_view message) const
{
  if (!is_binary_)
    fail_in_text(message);
  throw Format_error(fmt::format("{}: {} (at byte {})", path_.string(), message, offset()));
}

void Input_file::fail_in_text(std::string_view message) const
{
  throw Format_error(fmt::format("{}: line {}: {}", path_.string(), line_, message));
}

void Input_file::fail_to_parse(std::string_view word, std::string_view what) const
{
  if (word.empty())
    fail_in_text(fmt::format("ends where {} is expected", what));
  fail_in_text(fmt::format("'{}' where {} is expected", printable(word), what));
}

} // namespace recurve::internal
