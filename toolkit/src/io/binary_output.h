#ifndef RECURVE_SRC_IO_BINARY_OUTPUT_H
#define RECURVE_SRC_IO_BINARY_OUTPUT_H

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <functional>
#include <string_view>
#include <utility>
#include <vector>

namespace recurve {

/// File that is written from front to back in little endian and that lives only if close() succeeds: until then the
/// destructor removes it.
class Binary_output
{
public:
  /// \throws Format_error if the file cannot be created.
  explicit Binary_output(const std::filesystem::path& path);
  ~Binary_output();
  Binary_output(const Binary_output&) = delete;
  Binary_output& operator=(const Binary_output&) = delete;

  /// \throws Format_error if a full buffer cannot be written, as by all that follow.
  void put_text(std::string_view text) { put_bytes(text.data(), text.size()); }

  template <class Number>
  void put(Number value)
  {
    std::byte bytes[sizeof(Number)];
    std::memcpy(bytes, &value, sizeof(Number));
    if constexpr (std::endian::native == std::endian::big)
      std::reverse(bytes, bytes + sizeof(Number));
    put_bytes(bytes, sizeof(Number));
  }

  /// bytes put so far.
  std::uint64_t size() const { return size_; }

  /// calls `function` now and then, after about every MiB.
  void call_after_writes(std::function<void()> function) { after_write_ = std::move(function); }

  /// brings everything to the disk; a full disk shows here at the latest.
  void close();

private:
  void put_bytes(const void* bytes, std::size_t count)
  {
    if (buffer_.size() + count > buffer_.capacity())
      flush();
    const auto* first = static_cast<const std::byte*>(bytes);
    if (count > buffer_.capacity())
      write(first, count);
    else
      buffer_.insert(buffer_.end(), first, first + count);
    size_ += count;
  }
  void flush();
  void write(const std::byte* bytes, std::size_t count);
  [[noreturn]] void fail(std::string_view what) const;

  std::filesystem::path path_;
  std::FILE* file_ = nullptr;
  std::vector<std::byte> buffer_;
  std::uint64_t size_ = 0;
  std::function<void()> after_write_;
};

} // namespace recurve

#endif
