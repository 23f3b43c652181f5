#include <recurve/mesh/internal/element_blocks.h>
#include <recurve/mesh/orient_cells.h>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

namespace recurve {

namespace {

/// A corner and the far ends of its three edges, ordered such that the reference element has a positive determinant.
using Corner_frame = std::array<int, 4>;

double determinant(const Point& a, const Point& b, const Point& c)
{
  return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

Point difference(const Point& a, const Point& b)
{
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

Point reference_corner(const Reference_element& reference, int corner)
{
  const auto& x = reference.corners[corner];
  return {double(x[0]), double(x[1]), double(x[2])};
}

std::vector<Corner_frame> corner_frames(Element_type type)
{
  const Reference_element& reference = reference_element(type);
  std::vector<Corner_frame> frames;
  for (int corner = 0; corner < reference.corner_count; ++corner)
  {
    std::vector<int> ends;
    for (int e = 0; e < reference.edge_count; ++e)
      for (int side = 0; side < 2; ++side)
        if (reference.edges[e][side] == corner)
          ends.push_back(reference.edges[e][1 - side]);
    if (ends.size() != 3) // the apex of a pyramid: its Jacobian depends on the way in, the base corners bound it
      continue;
    const Point origin = reference_corner(reference, corner);
    const double det = determinant(difference(reference_corner(reference, ends[0]), origin),
                                   difference(reference_corner(reference, ends[1]), origin),
                                   difference(reference_corner(reference, ends[2]), origin));
    if (det < 0)
      std::swap(ends[1], ends[2]);
    frames.push_back({corner, ends[0], ends[1], ends[2]});
  }
  return frames;
}

/// Corner c of the mirrored cell is corner mirror[c] of the cell.
std::array<int, 8> mirror(Element_type type)
{
  switch (type)
  {
  case Element_type::tetrahedron: return {0, 2, 1, 3};
  case Element_type::pyramid: return {0, 3, 2, 1, 4};
  case Element_type::prism: return {0, 2, 1, 3, 5, 4};
  case Element_type::hexahedron: return {0, 3, 2, 1, 4, 7, 6, 5};
  default: return {0, 1, 2, 3, 4, 5, 6, 7};
  }
}

/// Bound of the relative round-off of a 3x3 determinant of differences of doubles, relative to the product of the
/// lengths of its rows: each of the 6 terms takes 3 differences, 2 products and up to 3 sums, of half an epsilon each.
constexpr double determinant_round_off = 24 * std::numeric_limits<double>::epsilon();

int sign_of_corner(const Corner_frame& frame, const Index* nodes, const std::vector<Point>& points)
{
  std::array<Point, 3> edges;
  double size = 1;
  for (int i = 0; i < 3; ++i)
  {
    edges[i] = difference(points[nodes[frame[i + 1]]], points[nodes[frame[0]]]);
    size *= std::hypot(edges[i][0], edges[i][1], edges[i][2]);
  }
  const double det = determinant(edges[0], edges[1], edges[2]);
  if (std::abs(det) <= determinant_round_off * size)
    return 0;
  return det > 0 ? 1 : -1;
}

enum class Verdict : std::uint8_t
{
  good,
  collapsed,
  folded
};

struct Cell_state
{
  Verdict verdict = Verdict::good;
  bool is_inside_out = false;
};

Cell_state examine(std::span<const Corner_frame> frames, const Index* nodes, const std::vector<Point>& points)
{
  std::array<int, 3> count = {}; // negative, zero, positive
  for (const Corner_frame& frame : frames)
    ++count[sign_of_corner(frame, nodes, points) + 1];
  if (count[0] > 0 && count[2] > 0)
    return {Verdict::folded, false};
  return {count[1] > 0 ? Verdict::collapsed : Verdict::good, count[0] > 0};
}

void mirror_cell(Element_type type, Index* nodes)
{
  const std::array<int, 8> source = mirror(type);
  std::array<Index, 8> old = {};
  std::copy_n(nodes, corner_count(type), old.begin());
  for (int c = 0; c < corner_count(type); ++c)
    nodes[c] = old[source[c]];
}

void orient_section(const std::vector<Point>& points, Section& section, Cell_number first, Orientation_report& report)
{
  const std::vector<Corner_frame> frames = corner_frames(section.type);
  const Index size = section.size();
  std::vector<Cell_state> states(static_cast<std::size_t>(size));
  tbb::parallel_for(tbb::blocked_range<Index>(0, size), [&](const tbb::blocked_range<Index>& range) {
    for (Index e = range.begin(); e < range.end(); ++e)
    {
      Index* const nodes = section.nodes.data() + e * corner_count(section.type);
      states[e] = examine(frames, nodes, points);
      if (states[e].is_inside_out)
        mirror_cell(section.type, nodes);
    }
  });
  for (Index e = 0; e < size; ++e)
  {
    report.mirrored_cells += states[e].is_inside_out;
    if (states[e].verdict == Verdict::folded)
      report.invalid_cells.push_back({first.zone, first.cell + e});
    else if (states[e].verdict == Verdict::collapsed)
      report.collapsed_cells.push_back({first.zone, first.cell + e});
  }
}

} // namespace

Orientation_report orient_cells(Volume_mesh& mesh)
{
  Orientation_report report;
  for (std::size_t z = 0; z < mesh.zones.size(); ++z)
  {
    Cell_number first{static_cast<Index>(z), 0};
    for (Section& section : mesh.zones[z].cells)
    {
      orient_section(mesh.zones[z].points, section, first, report);
      first.cell += section.size();
    }
  }
  return report;
}

} // namespace recurve
