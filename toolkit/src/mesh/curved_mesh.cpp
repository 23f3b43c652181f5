#include <recurve/core/exceptions.h>
#include <recurve/elements/node_layout.h>
#include <recurve/mesh/curved_mesh.h>
#include <recurve/mesh/internal/straight_element.h>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <vector>

namespace recurve {

namespace internal {

namespace {

/// The functions of degree 1 of the reference cell; of the pyramid, those on its collapsed cube.
std::array<double, 8> corner_weights(Element_type type, double x, double y, double z)
{
  switch (type)
  {
  case Element_type::tetrahedron: return {1 - x - y - z, x, y, z};
  case Element_type::pyramid:
  {
    const double h = 1 - z; // a node inside is below the apex
    const double a = x / h, b = y / h;
    return {(1 - a) * (1 - b) * h, a * (1 - b) * h, a * b * h, (1 - a) * b * h, z};
  }
  case Element_type::prism: return {(1 - x - y) * (1 - z), x * (1 - z), y * (1 - z), (1 - x - y) * z, x * z, y * z};
  case Element_type::hexahedron:
    return {(1 - x) * (1 - y) * (1 - z), x * (1 - y) * (1 - z), x * y * (1 - z), (1 - x) * y * (1 - z),
            (1 - x) * (1 - y) * z,       x * (1 - y) * z,       x * y * z,       (1 - x) * y * z};
  default: return {};
  }
}

using Weight_table = std::vector<std::array<double, 8>>;

Weight_table make_interior_weights(Element_type type, int degree)
{
  Weight_table table;
  if (reference_element(type).dimension < 3)
    return table;
  const std::span<const Lattice_point> nodes = canonical_nodes(type, degree);
  for (std::size_t m = static_cast<std::size_t>(first_interior_node(type, degree)); m < nodes.size(); ++m)
    table.push_back(
      corner_weights(type, double(nodes[m][0]) / degree, double(nodes[m][1]) / degree, double(nodes[m][2]) / degree));
  return table;
}

std::vector<Weight_table> make_all_interior_weights()
{
  std::vector<Weight_table> tables;
  for (const Element_type type : all_element_types)
    for (int degree = 1; degree <= max_degree; ++degree)
      tables.push_back(make_interior_weights(type, degree));
  return tables;
}

} // namespace

std::span<const std::array<double, 8>> interior_weights(Element_type type, int degree)
{
  static const std::vector<Weight_table> tables = make_all_interior_weights();
  return tables[static_cast<std::size_t>(type) * max_degree + static_cast<std::size_t>(degree - 1)];
}

} // namespace internal

namespace {

using internal::Canonical_face;

void place_edge_nodes(Element_type type, int degree, std::span<const Index> nodes, std::span<const Point> points,
                      std::span<Point> positions)
{
  const Reference_element& reference = reference_element(type);
  for (int e = 0; e < reference.edge_count; ++e)
  {
    const Point& a = points[nodes[reference.edges[e][0]]];
    const Point& b = points[nodes[reference.edges[e][1]]];
    Point* const target = positions.data() + first_edge_node(type, degree, e);
    for (int k = 1; k < degree; ++k)
      target[k - 1] = internal::straight_edge_node(a, b, k, degree);
  }
}

/// \param corners  corner numbers of the face, in the element
/// \param numbers  numbers of all nodes of the face, in the element
void place_face_nodes(Element_type face_type, std::span<const int> corners, std::span<const int> numbers, int degree,
                      std::span<const Index> nodes, std::span<const Point> points, std::span<Point> positions)
{
  if (interior_node_count(face_type, degree) == 0)
    return;
  const int count = corner_count(face_type);
  std::array<Index, 4> vertices = {};
  for (int c = 0; c < count; ++c)
    vertices[c] = nodes[corners[c]];
  const Canonical_face canonical = internal::canonical_face(vertices, count);
  std::array<Point, 4> canonical_corners = {};
  for (int c = 0; c < count; ++c)
    canonical_corners[c] = points[vertices[canonical.corner(c, count)]];
  const std::span<const int> place = face_orientation(face_type, degree, canonical.first, canonical.is_reversed);
  const std::span<const Lattice_point> lattice = canonical_nodes(face_type, degree);
  for (int m = first_interior_node(face_type, degree); m < static_cast<int>(lattice.size()); ++m)
    positions[numbers[place[m]]] =
      internal::straight_face_node(canonical_corners, count, lattice[m][0], lattice[m][1], degree);
}

void place_interior_nodes(Element_type type, int degree, std::span<const Index> nodes, std::span<const Point> points,
                          std::span<Point> positions)
{
  std::array<Point, 8> corners = {};
  const int count = corner_count(type);
  for (int c = 0; c < count; ++c)
    corners[c] = points[nodes[c]];
  Point* target = positions.data() + first_interior_node(type, degree);
  for (const std::array<double, 8>& weights : internal::interior_weights(type, degree))
    *target++ = internal::straight_interior_node(std::span<const Point>(corners.data(), count), weights);
}

} // namespace

void straight_nodes(Element_type type, int degree, std::span<const Index> nodes, std::span<const Point> points,
                    std::span<Point> positions)
{
  const Reference_element& reference = reference_element(type);
  for (int c = 0; c < reference.corner_count; ++c)
    positions[c] = points[nodes[c]];
  place_edge_nodes(type, degree, nodes, points, positions);
  for (int f = 0; f < reference.face_count; ++f)
  {
    const Reference_face& face = reference.faces[f];
    place_face_nodes(face.type, face.corners, face_nodes(type, degree, f), degree, nodes, points, positions);
  }
  if (reference.dimension == 3)
    place_interior_nodes(type, degree, nodes, points, positions);
  if (reference.dimension != 2)
    return;
  std::array<int, node_count(Element_type::quadrangle, max_degree)> numbers = {};
  for (int m = 0; m < node_count(type, degree); ++m)
    numbers[m] = m;
  place_face_nodes(type, numbers, numbers, degree, nodes, points, positions);
}

Index Curved_mesh::cell_count() const
{
  Index count = 0;
  for (const Curved_zone& zone : zones)
    count += static_cast<Index>(zone.is_straight.size());
  return count;
}

namespace {

Index update_straight_cells(const Curved_section& section, int degree, std::span<const Point> points,
                            std::span<std::uint8_t> is_straight)
{
  const std::size_t count = static_cast<std::size_t>(node_count(section.type, degree));
  const tbb::blocked_range<std::size_t> all(0, is_straight.size());
  return tbb::parallel_reduce(
    all, Index(0),
    [&](const tbb::blocked_range<std::size_t>& range, Index straight) {
      std::vector<Point> positions(count);
      for (std::size_t e = range.begin(); e < range.end(); ++e)
      {
        const std::span<const Index> nodes(section.nodes.data() + e * count, count);
        straight_nodes(section.type, degree, nodes, points, positions);
        is_straight[e] = 1;
        for (std::size_t m = 0; m < count && is_straight[e]; ++m)
          is_straight[e] = points[nodes[m]] == positions[m];
        straight += is_straight[e];
      }
      return straight;
    },
    std::plus<Index>());
}

} // namespace

Index update_straight_cells(Curved_mesh& mesh)
{
  Index straight = 0;
  for (Curved_zone& zone : mesh.zones)
  {
    std::size_t first = 0;
    for (const Curved_section& section : zone.cells)
    {
      const std::size_t size = section.nodes.size() / static_cast<std::size_t>(node_count(section.type, mesh.degree));
      straight +=
        update_straight_cells(section, mesh.degree, mesh.nodes, std::span(zone.is_straight).subspan(first, size));
      first += size;
    }
  }
  return straight;
}

} // namespace recurve
