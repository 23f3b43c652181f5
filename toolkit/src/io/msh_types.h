#ifndef RECURVE_IO_MSH_TYPES_H
#define RECURVE_IO_MSH_TYPES_H

#include <recurve/elements/element.h>

#include <array>
#include <optional>

namespace recurve::internal::msh {

/// Gmsh's numbers of the complete element families (MSH file format, "element types"); rows as `Element_type`, columns
/// by degree.
inline constexpr std::array<std::array<int, max_degree>, 7> type_numbers = {{{1, 8, 26, 27, 28, 62},
                                                                             {2, 9, 21, 23, 25, 42},
                                                                             {3, 10, 36, 37, 38, 47},
                                                                             {4, 11, 29, 30, 31, 71},
                                                                             {7, 14, 118, 119, 120, 121},
                                                                             {6, 13, 90, 91, 106, 107},
                                                                             {5, 12, 92, 93, 94, 95}}};

/// Gmsh's number of a point element.
inline constexpr int point_number = 15;

constexpr int type_number(Element_type type, int degree)
{
  return type_numbers[static_cast<std::size_t>(type)][static_cast<std::size_t>(degree - 1)];
}

struct Msh_type
{
  Element_type type;
  int degree;
};

/// the complete element with Gmsh's number `number`; none for others.
constexpr std::optional<Msh_type> find_type(int number)
{
  for (const Element_type type : all_element_types)
    for (int degree = 1; degree <= max_degree; ++degree)
      if (type_number(type, degree) == number)
        return Msh_type{type, degree};
  return std::nullopt;
}

} // namespace recurve::internal::msh

#endif
