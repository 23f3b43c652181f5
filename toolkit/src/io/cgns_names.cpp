#include "cgns_names.h"

#include <fmt/format.h>

#include <algorithm>

namespace recurve::internal::cgns {

std::string cut_name(std::string_view name, std::size_t length)
{
  if (name.size() <= length)
    return std::string(name);
  while (length > 0 && (static_cast<unsigned char>(name[length]) & 0xC0U) == 0x80U)
    --length; // the byte after the cut continues a character: that character goes as a whole
  return std::string(name.substr(0, length));
}

std::string Cgns_names::take(std::string_view name)
{
  std::string wanted = cut_name(name, longest_cgns_name);
  std::replace(wanted.begin(), wanted.end(), '/', '_'); // separates nodes in a path
  std::erase_if(wanted, [](char c) { return static_cast<unsigned char>(c) < ' '; });
  if (wanted.empty() || wanted == "." || wanted == "..")
    wanted = "unnamed";
  std::string result = wanted;
  for (int n = 2; !taken_.insert(result).second; ++n)
  {
    const std::string suffix = fmt::format("_{}", n);
    result = cut_name(wanted, longest_cgns_name - suffix.size()) + suffix;
  }
  return result;
}

} // namespace recurve::internal::cgns
