#ifndef RECURVE_IO_CGNS_ELEMENT_CODES_H
#define RECURVE_IO_CGNS_ELEMENT_CODES_H

#include "cgns_writing.h"

#include <recurve/elements/element.h>

#include <cgnslib.h>

#include <array>

namespace recurve::internal::cgns {

/// CGNS's complete element families; rows as `Element_type`, columns by degree.
inline constexpr std::array<std::array<ElementType_t, largest_cgns_degree>, 7> element_codes = {
  {{BAR_2, BAR_3, BAR_4, BAR_5},
   {TRI_3, TRI_6, TRI_10, TRI_15},
   {QUAD_4, QUAD_9, QUAD_16, QUAD_25},
   {TETRA_4, TETRA_10, TETRA_20, TETRA_35},
   {PYRA_5, PYRA_14, PYRA_30, PYRA_55},
   {PENTA_6, PENTA_18, PENTA_40, PENTA_75},
   {HEXA_8, HEXA_27, HEXA_64, HEXA_125}}};

constexpr ElementType_t element_code(Element_type type, int degree)
{
  return element_codes[static_cast<std::size_t>(type)][static_cast<std::size_t>(degree - 1)];
}

} // namespace recurve::internal::cgns

#endif
