#ifndef RECURVE_IO_CGNS_NAMES_H
#define RECURVE_IO_CGNS_NAMES_H

#include <initializer_list>
#include <string>
#include <string_view>
#include <unordered_set>

namespace recurve::internal::cgns {

/// Names of sibling nodes of a CGNS tree: at most 32 bytes long, without '/', all different.
class Cgns_names
{
public:
  Cgns_names() = default;
  Cgns_names(std::initializer_list<std::string> taken) : taken_(taken) {}

  void reserve(const std::string& name) { taken_.insert(name); }

  /// the name itself if it is free and allowed, else the nearest that is (cut, and with a number at its end); taken
  /// from then on.
  std::string take(std::string_view name);

private:
  std::unordered_set<std::string> taken_;
};

/// a name cut to at most `length` bytes, not within a UTF-8 character.
std::string cut_name(std::string_view name, std::size_t length);

/// longest name of a CGNS node, in bytes (SIDS).
inline constexpr std::size_t longest_cgns_name = 32;

} // namespace recurve::internal::cgns

#endif
