#include <recurve/elements/element.h>

namespace recurve {

namespace {

constexpr Reference_face triangle(int a, int b, int c)
{
  return {Element_type::triangle, 3, {a, b, c, 0}};
}

constexpr Reference_face quadrangle(int a, int b, int c, int d)
{
  return {Element_type::quadrangle, 4, {a, b, c, d}};
}

// The numbering of the SIDS, counted from 0.
constexpr Reference_element table[] = {
  {Element_type::line, 1, 2, 1, 0, {{{0, 0, 0}, {1, 0, 0}}}, {{{0, 1}}}, {}},
  {Element_type::triangle, 2, 3, 3, 0, {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}, {{{0, 1}, {1, 2}, {2, 0}}}, {}},
  {Element_type::quadrangle,
   2,
   4,
   4,
   0,
   {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}},
   {{{0, 1}, {1, 2}, {2, 3}, {3, 0}}},
   {}},
  {Element_type::tetrahedron,
   3,
   4,
   6,
   4,
   {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}},
   {{{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}},
   {triangle(0, 2, 1), triangle(0, 1, 3), triangle(1, 2, 3), triangle(2, 0, 3)}},
  {Element_type::pyramid,
   3,
   5,
   8,
   5,
   {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}}},
   {{{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 4}, {1, 4}, {2, 4}, {3, 4}}},
   {quadrangle(0, 3, 2, 1), triangle(0, 1, 4), triangle(1, 2, 4), triangle(2, 3, 4), triangle(3, 0, 4)}},
  {Element_type::prism,
   3,
   6,
   9,
   5,
   {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}}},
   {{{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 4}, {2, 5}, {3, 4}, {4, 5}, {5, 3}}},
   {quadrangle(0, 1, 4, 3), quadrangle(1, 2, 5, 4), quadrangle(2, 0, 3, 5), triangle(0, 2, 1), triangle(3, 4, 5)}},
  {Element_type::hexahedron,
   3,
   8,
   12,
   6,
   {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}},
   {{{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 4}, {1, 5}, {2, 6}, {3, 7}, {4, 5}, {5, 6}, {6, 7}, {7, 4}}},
   {quadrangle(0, 3, 2, 1), quadrangle(0, 1, 5, 4), quadrangle(1, 2, 6, 5), quadrangle(2, 3, 7, 6),
    quadrangle(0, 4, 7, 3), quadrangle(4, 5, 6, 7)}},
};

constexpr std::string_view names[] = {"line",    "triangle", "quadrangle", "tetrahedron",
                                      "pyramid", "prism",    "hexahedron"};

} // namespace

const Reference_element& reference_element(Element_type type)
{
  return table[static_cast<int>(type)];
}

std::string_view element_name(Element_type type)
{
  return names[static_cast<int>(type)];
}

int interior_node_count(Element_type type, int degree)
{
  const int p = degree;
  switch (type)
  {
  case Element_type::line: return p - 1;
  case Element_type::triangle: return (p - 1) * (p - 2) / 2;
  case Element_type::quadrangle: return (p - 1) * (p - 1);
  case Element_type::tetrahedron: return (p - 1) * (p - 2) * (p - 3) / 6;
  case Element_type::pyramid: return (p - 2) * (p - 1) * (2 * p - 3) / 6;
  case Element_type::prism: return (p - 1) * (p - 1) * (p - 2) / 2;
  case Element_type::hexahedron: return (p - 1) * (p - 1) * (p - 1);
  }
  return 0;
}

} // namespace recurve
