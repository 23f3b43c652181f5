#include "wording.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>

namespace recurve {

std::string grouped(Index number)
{
  const std::string digits = std::to_string(number);
  const std::size_t sign = number < 0 ? 1 : 0;
  std::string text = digits.substr(0, sign);
  for (std::size_t at = sign; at < digits.size(); ++at)
  {
    if (at > sign && (digits.size() - at) % 3 == 0)
      text += ',';
    text += digits[at];
  }
  return text;
}

std::string counted(Index number, std::string_view singular, std::string_view plural)
{
  return fmt::format("{} {}", grouped(number), number == 1 ? singular : plural);
}

std::string_view plural_name(Element_type type)
{
  switch (type)
  {
  case Element_type::tetrahedron: return "tetrahedra";
  case Element_type::pyramid: return "pyramids";
  case Element_type::prism: return "prisms";
  case Element_type::hexahedron: return "hexahedra";
  default: return element_name(type);
  }
}

std::string at_point(const Point& point)
{
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", point[0], point[1], point[2]);
}

std::string table(const std::vector<std::vector<std::string>>& rows)
{
  std::vector<std::size_t> widths;
  for (const auto& row : rows)
    for (std::size_t c = 0; c < row.size(); ++c)
    {
      if (c == widths.size())
        widths.push_back(0);
      widths[c] = std::max(widths[c], row[c].size());
    }
  std::string text;
  for (const auto& row : rows)
  {
    std::string line = " ";
    for (std::size_t c = 0; c < row.size(); ++c)
      line += fmt::format(" {:<{}}", row[c], widths[c]);
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  return text;
}

} // namespace recurve
