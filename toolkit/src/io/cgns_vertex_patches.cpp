#include "cgns_reading.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

// A list of points says less than a list of faces: at the rim between two patches a triangle may have all its corners
// in both lists. What decides, in this order: whole sections of faces that lie in the list (the usual way: section and
// list are the same thing twice), then single faces; a face in several lists goes where its flattest neighbour is.

namespace recurve::internal::cgns {

namespace {

/// A face of the zone, or of a cell and new, by its corners; a triangle's fourth corner is no_index.
struct Corner_face
{
  std::array<Index, 4> corners = {no_index, no_index, no_index, no_index};
  Index face = no_index; ///< number in the zone; no_index: to be made

  std::size_t size() const { return corners[3] == no_index ? 3 : 4; }
  std::array<Index, 4> key() const
  {
    std::array<Index, 4> sorted = corners;
    std::sort(sorted.begin(), sorted.end());
    return sorted;
  }
};

/// Marks that need no clearing between uses.
class Point_marks
{
public:
  explicit Point_marks(std::size_t count) : marks_(count, 0) {}

  void mark_only(const std::vector<Index>& points)
  {
    ++current_;
    for (const Index point : points)
      mark(point);
  }
  void mark(Index point) { marks_[static_cast<std::size_t>(point)] = current_; }
  bool has(Index point) const { return marks_[static_cast<std::size_t>(point)] == current_; }
  bool has_all(std::span<const Index> points) const
  {
    return std::all_of(points.begin(), points.end(), [&](Index point) { return point == no_index || has(point); });
  }

private:
  std::vector<Index> marks_;
  Index current_ = 0;
};

std::span<const Index> element_nodes(const Section& section, Index element)
{
  const auto corners = static_cast<std::size_t>(corner_count(section.type));
  return std::span<const Index>(section.nodes).subspan(static_cast<std::size_t>(element) * corners, corners);
}

/// The assignment while it goes on.
struct Matching
{
  Zone& zone;
  const std::vector<Vertex_patch>& patches;
  std::vector<Index>& patch_of_face;
  std::vector<std::string>& notes;
  Point_marks marks;

  bool is_free(Index first, const Section& section) const
  {
    return std::all_of(patch_of_face.begin() + first, patch_of_face.begin() + first + section.size(),
                       [](Index patch) { return patch == no_index; });
  }

  bool lies_in_marks(const Section& section) const { return marks.has_all(section.nodes); }
};

/// the best of several lists that a whole section lies in: the one of its name, else the shortest, else the first.
std::size_t choose_patch(const Matching& m, const std::string& section, const std::vector<std::size_t>& candidates)
{
  for (const std::size_t c : candidates)
    if (m.patches[c].name == section || m.patches[c].family == section)
      return c;
  return *std::min_element(candidates.begin(), candidates.end(), [&](std::size_t a, std::size_t b) {
    return m.patches[a].points.size() < m.patches[b].points.size();
  });
}

/// gives whole sections to patches; returns per patch whether sections account for all of its points.
std::vector<bool> match_sections(Matching& m)
{
  const std::vector<Section>& sections = m.zone.faces;
  std::vector<std::vector<std::size_t>> candidates(sections.size());
  for (std::size_t p = 0; p < m.patches.size(); ++p)
  {
    m.marks.mark_only(m.patches[p].points);
    Index first = 0;
    for (std::size_t s = 0; s < sections.size(); first += sections[s++].size())
      if (m.is_free(first, sections[s]) && m.lies_in_marks(sections[s]))
        candidates[s].push_back(p);
  }
  std::vector<std::vector<std::size_t>> sections_of(m.patches.size());
  Index first = 0;
  for (std::size_t s = 0; s < sections.size(); first += sections[s++].size())
  {
    if (candidates[s].empty())
      continue;
    const std::size_t chosen = choose_patch(m, sections[s].name, candidates[s]);
    sections_of[chosen].push_back(s);
    std::fill_n(m.patch_of_face.begin() + first, sections[s].size(), m.patches[chosen].patch);
    if (candidates[s].size() > 1)
      m.notes.push_back(
        fmt::format("zone '{}': the points of section '{}' are in {} boundary conditions, given to '{}'", m.zone.name,
                    sections[s].name, candidates[s].size(), m.patches[chosen].name));
  }
  std::vector<bool> is_complete(m.patches.size());
  for (std::size_t p = 0; p < m.patches.size(); ++p)
  {
    m.marks.mark_only({});
    for (const std::size_t s : sections_of[p])
      for (const Index point : sections[s].nodes)
        m.marks.mark(point);
    is_complete[p] = m.marks.has_all(m.patches[p].points);
  }
  return is_complete;
}

/// faces of sections without patch, then boundary faces of cells that no section has; only those whose corners are all
/// marked.
std::vector<Corner_face> loose_faces(const Matching& m)
{
  std::vector<Corner_face> in_sections, of_cells;
  Index face = 0;
  for (const Section& section : m.zone.faces)
    for (Index element = 0; element < section.size(); ++element, ++face)
    {
      const std::span<const Index> nodes = element_nodes(section, element);
      if (!m.marks.has_all(nodes))
        continue;
      Corner_face entry;
      std::copy(nodes.begin(), nodes.end(), entry.corners.begin());
      entry.face = face;
      in_sections.push_back(entry);
    }
  for (const Section& section : m.zone.cells)
  {
    const Reference_element& reference = reference_element(section.type);
    for (Index cell = 0; cell < section.size(); ++cell)
    {
      const std::span<const Index> nodes = element_nodes(section, cell);
      for (int f = 0; f < reference.face_count; ++f)
      {
        const Reference_face& side = reference.faces[static_cast<std::size_t>(f)];
        Corner_face entry;
        for (int c = 0; c < side.corner_count; ++c)
          entry.corners[static_cast<std::size_t>(c)] =
            nodes[static_cast<std::size_t>(side.corners[static_cast<std::size_t>(c)])];
        if (m.marks.has_all(entry.corners))
          of_cells.push_back(entry);
      }
    }
  }

  // A face of two cells is inside the volume; one of a section is there already.
  const auto by_key = [](const Corner_face& a, const Corner_face& b) { return a.key() < b.key(); };
  std::vector<std::array<Index, 4>> known;
  known.reserve(in_sections.size());
  for (const Corner_face& entry : in_sections)
    known.push_back(entry.key());
  std::sort(known.begin(), known.end());
  std::stable_sort(of_cells.begin(), of_cells.end(), by_key);
  std::vector<Corner_face> result;
  for (const Corner_face& entry : in_sections)
    if (m.patch_of_face[static_cast<std::size_t>(entry.face)] == no_index)
      result.push_back(entry);
  for (std::size_t begin = 0, end = 0; begin < of_cells.size(); begin = end)
  {
    while (end < of_cells.size() && of_cells[end].key() == of_cells[begin].key())
      ++end;
    if (end == begin + 1 && !std::binary_search(known.begin(), known.end(), of_cells[begin].key()))
      result.push_back(of_cells[begin]);
  }
  return result;
}

Point normal_of(const Zone& zone, const Corner_face& face)
{
  const auto at = [&](std::size_t c) { return zone.points[static_cast<std::size_t>(face.corners[c])]; };
  const Point a = at(0), b = at(1), c = at(2), d = face.size() == 4 ? at(3) : at(0);
  Point u, v; // the diagonals of a quadrangle; two sides of a triangle
  for (std::size_t m = 0; m < 3; ++m)
  {
    u[m] = c[m] - a[m];
    v[m] = face.size() == 4 ? d[m] - b[m] : b[m] - a[m];
  }
  Point n = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
  const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  if (length > 0)
    for (double& component : n)
      component /= length;
  return n;
}

/// pairs of positions in `faces` that share an edge.
std::vector<std::array<std::size_t, 2>> neighbours(const std::vector<Corner_face>& faces)
{
  struct Side
  {
    std::array<Index, 2> ends;
    std::size_t face;
  };
  std::vector<Side> sides;
  for (std::size_t f = 0; f < faces.size(); ++f)
    for (std::size_t c = 0; c < faces[f].size(); ++c)
    {
      const Index a = faces[f].corners[c], b = faces[f].corners[(c + 1) % faces[f].size()];
      sides.push_back({.ends = {std::min(a, b), std::max(a, b)}, .face = f});
    }
  std::stable_sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) { return a.ends < b.ends; });
  std::vector<std::array<std::size_t, 2>> result;
  for (std::size_t begin = 0, end = 0; begin < sides.size(); begin = end)
  {
    while (end < sides.size() && sides[end].ends == sides[begin].ends)
      ++end;
    for (std::size_t a = begin; a < end; ++a)
      for (std::size_t b = begin; b < end; ++b)
        if (a != b)
          result.push_back({sides[a].face, sides[b].face});
  }
  std::sort(result.begin(), result.end());
  return result;
}

/// chooses one of the candidates of each face: the only one, else that of the flattest neighbour with only one, else
/// the first.
std::vector<std::size_t> choose_candidates(const Matching& m, const std::vector<Corner_face>& faces,
                                           const std::vector<std::vector<std::size_t>>& candidates)
{
  std::vector<std::size_t> chosen(faces.size());
  std::vector<double> flattest(faces.size(), -1);
  for (std::size_t f = 0; f < faces.size(); ++f)
    chosen[f] = candidates[f].front();
  if (std::all_of(candidates.begin(), candidates.end(), [](const auto& list) { return list.size() == 1; }))
    return chosen;
  for (const auto& [f, other] : neighbours(faces))
  {
    if (candidates[f].size() == 1 || candidates[other].size() != 1 ||
        std::find(candidates[f].begin(), candidates[f].end(), candidates[other].front()) == candidates[f].end())
      continue;
    const Point a = normal_of(m.zone, faces[f]), b = normal_of(m.zone, faces[other]);
    const double flatness = std::abs(a[0] * b[0] + a[1] * b[1] + a[2] * b[2]); // sides may be turned either way
    if (flatness > flattest[f])
    {
      flattest[f] = flatness;
      chosen[f] = candidates[other].front();
    }
  }
  return chosen;
}

/// adds faces of cells to the zone, in one section per patch and type.
void make_sections(Matching& m, const std::vector<Corner_face>& faces, const std::vector<std::size_t>& chosen)
{
  Cgns_names names = section_names(m.zone);
  for (std::size_t p = 0; p < m.patches.size(); ++p)
    for (const std::size_t size : {3U, 4U})
    {
      Section section = {
        .name = {}, .type = size == 3 ? Element_type::triangle : Element_type::quadrangle, .nodes = {}};
      for (std::size_t f = 0; f < faces.size(); ++f)
        if (chosen[f] == p && faces[f].face == no_index && faces[f].size() == size)
          section.nodes.insert(section.nodes.end(), faces[f].corners.begin(),
                               faces[f].corners.begin() + static_cast<std::ptrdiff_t>(size));
      if (section.nodes.empty())
        continue;
      section.name = names.take(m.patches[p].name);
      m.patch_of_face.resize(m.patch_of_face.size() + static_cast<std::size_t>(section.size()), m.patches[p].patch);
      m.zone.faces.push_back(std::move(section));
    }
}

} // namespace

void match_vertex_patches(Zone& zone, const std::vector<Vertex_patch>& patches, std::vector<Index>& patch_of_face,
                          std::vector<std::string>& notes)
{
  if (patches.empty())
    return;
  Matching m = {zone, patches, patch_of_face, notes, Point_marks(zone.points.size())};
  const std::vector<bool> is_complete = match_sections(m);
  m.marks.mark_only({});
  for (std::size_t p = 0; p < patches.size(); ++p)
    if (!is_complete[p])
      for (const Index point : patches[p].points)
        m.marks.mark(point);
  std::vector<Corner_face> faces = loose_faces(m);
  std::vector<std::vector<std::size_t>> candidates(faces.size());
  for (std::size_t p = 0; p < patches.size(); ++p)
  {
    if (is_complete[p])
      continue;
    m.marks.mark_only(patches[p].points);
    for (std::size_t f = 0; f < faces.size(); ++f)
      if (m.marks.has_all(faces[f].corners))
        candidates[f].push_back(p);
  }
  std::vector<Corner_face> claimed;
  std::vector<std::vector<std::size_t>> claims;
  for (std::size_t f = 0; f < faces.size(); ++f)
    if (!candidates[f].empty())
    {
      claimed.push_back(faces[f]);
      claims.push_back(candidates[f]);
    }
  const std::vector<std::size_t> chosen = choose_candidates(m, claimed, claims);
  for (std::size_t f = 0; f < claimed.size(); ++f)
    if (claimed[f].face != no_index)
      patch_of_face[static_cast<std::size_t>(claimed[f].face)] = patches[chosen[f]].patch;
  make_sections(m, claimed, chosen);
}

} // namespace recurve::internal::cgns
