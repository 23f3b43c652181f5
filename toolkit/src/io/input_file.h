#ifndef RECURVE_IO_INPUT_FILE_H
#define RECURVE_IO_INPUT_FILE_H

#include <recurve/core/progress.h>
#include <recurve/core/types.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace recurve::internal {

/// text of a file as it may stand in a message: its beginning, what is no ASCII as question marks.
std::string printable(std::string_view text);

/// A file that is read from front to back, as text or as binary numbers of either byte order. Every function throws
/// `Format_error`, whose message names the file and the place, when the file ends too early or holds something else.
class Input_file
{
public:
  /// \param progress  must outlive the object.
  Input_file(const std::filesystem::path& file, const Progress_callback& progress);

  std::uint64_t size() const { return size_; }
  std::uint64_t offset() const { return buffer_offset_ + at_; }
  std::uint64_t remaining() const { return size_ - std::min(size_, offset()); }

  /// says that numbers are binary, so that messages name the byte, and whether of the other byte order than this
  /// machine's. A file is text before.
  void set_binary(bool is_swapped)
  {
    is_binary_ = true;
    is_swapped_ = is_swapped;
  }

  /// \throws Format_error unless `count` things of at least `bytes` bytes each can follow in the file: a count that is
  /// not to be believed, before memory is taken for it.
  void check_count(std::uint64_t count, std::uint64_t bytes, std::string_view what) const;

  /// the rest of the line, without its end; false at the end of the file.
  bool read_line(std::string& line);

  /// the next word of text; empty at the end of the file. Valid until the next call.
  std::string_view read_word();

  /// the next word as a number.
  template <class Number>
  Number parse(std::string_view what)
  {
    const std::string_view word = read_word();
    Number value = {};
    const char* const first = word.data() + (word.starts_with('+') ? 1 : 0);
    const auto [end, error] = std::from_chars(first, word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size())
      fail_to_parse(word, what);
    return value;
  }

  /// the next binary number.
  template <class Number>
  Number read()
  {
    std::array<std::byte, sizeof(Number)> bytes;
    read_bytes(bytes.data(), bytes.size());
    if (is_swapped_)
      std::reverse(bytes.begin(), bytes.end());
    Number value;
    std::memcpy(&value, bytes.data(), bytes.size());
    return value;
  }

  void read_bytes(void* target, std::size_t count)
  {
    if (end_ - at_ < count)
      fill(count);
    std::memcpy(target, buffer_.data() + at_, count);
    at_ += count;
  }

  void skip_bytes(std::uint64_t count);

  /// goes behind the next occurrence of `text`; false if there is none.
  bool skip_behind(std::string_view text);

  void rewind();

  [[noreturn]] void fail(std::string_view message) const;

  /// for the lines of text of a binary file.
  [[noreturn]] void fail_in_text(std::string_view message) const;

private:
  bool refill();
  void fetch_ahead();
  void fill(std::size_t count);
  [[noreturn]] void fail_to_parse(std::string_view word, std::string_view what) const;

  std::filesystem::path path_;
  const Progress_callback& progress_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_;
  std::uint64_t size_ = 0;
  std::uint64_t buffer_offset_ = 0; ///< of the first byte of the buffer, in the file
  std::uint64_t fetched_ = 0;       ///< end of what the system was asked to read
  std::vector<char> buffer_;
  std::size_t at_ = 0, end_ = 0;
  Index line_ = 1;
  std::uint64_t percent_ = 0; ///< told to the progress
  bool is_binary_ = false, is_swapped_ = false;
};

} // namespace recurve::internal

#endif
