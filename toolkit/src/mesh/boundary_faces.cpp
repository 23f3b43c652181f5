#include <recurve/mesh/boundary_faces.h>
#include <recurve/mesh/internal/face_table.h>

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

namespace recurve {

namespace {

using internal::Element_blocks;
using internal::Face_corners;

/// The numbering of vertices that a `Joined_zones` gives.
struct Joined_vertex
{
  const Joined_zones& joined;
  Index operator()(Index zone, Index point) const { return joined.vertex_of_point[zone][point]; }
};

using Table = internal::Face_table<Joined_vertex>;
using Group = std::span<const Table::Keyed_entry>;

/// What the faces of a run of vertices add to the result.
struct Run_result
{
  Boundary_report counts;
  std::vector<Cell_face> unassigned;
};

/// Per zone and face: number of the patch that lists it, or no_index.
using Patch_of_face = std::vector<std::vector<Index>>;

Patch_of_face patches_of_faces(const Volume_mesh& mesh)
{
  Patch_of_face result;
  for (const Zone& zone : mesh.zones)
  {
    result.emplace_back(static_cast<std::size_t>(zone.face_count()), no_index);
    for (std::size_t p = 0; p < zone.patches.size(); ++p)
      for (const Index face : zone.patches[p].faces)
        result.back()[face] = static_cast<Index>(p);
  }
  return result;
}

bool has_name(const std::vector<Patch>& patches, std::string_view name)
{
  return std::any_of(patches.begin(), patches.end(), [&](const Patch& patch) { return patch.name == name; });
}

/// `wish`, or the first of wish_2, wish_3, ... that `is_taken` does not hold for.
template <class Predicate>
std::string free_name(const std::string& wish, const Predicate& is_taken)
{
  std::string name = wish;
  for (int n = 2; is_taken(name); ++n)
    name = fmt::format("{}_{}", wish, n);
  return name;
}

/// gives the faces of sections that no patch lists a patch named like the section.
void add_patches_of_sections(Volume_mesh& mesh)
{
  const Patch_of_face patch_of_face = patches_of_faces(mesh);
  for (std::size_t z = 0; z < mesh.zones.size(); ++z)
  {
    Zone& zone = mesh.zones[z];
    Index number = 0;
    for (const Section& section : zone.faces)
    {
      Patch patch;
      for (const Index end = number + section.size(); number < end; ++number)
        if (patch_of_face[z][number] == no_index)
          patch.faces.push_back(number);
      if (patch.faces.empty())
        continue;
      patch.name = free_name(section.name, [&](const std::string& name) { return has_name(zone.patches, name); });
      zone.patches.push_back(std::move(patch));
    }
  }
}

class Boundary_finder
{
public:
  Boundary_finder(Volume_mesh& mesh, const Joined_zones& joined)
    : mesh_(mesh), cells_(internal::cell_blocks(mesh)), faces_(internal::face_blocks(mesh)),
      patch_of_face_(patches_of_faces(mesh)), table_(cells_, faces_, joined.vertex_count, Joined_vertex{joined})
  {
    for (const Zone& zone : mesh.zones)
      result_.owners.emplace_back(static_cast<std::size_t>(zone.face_count()));
  }

  Boundary_faces find()
  {
    const auto runs =
      table_.visit_groups<Run_result>([this](Group group, Run_result& run) { visit_group(group, run); });
    std::vector<Cell_face> unassigned;
    for (const Run_result& run : runs)
    {
      result_.report += run.counts;
      unassigned.insert(unassigned.end(), run.unassigned.begin(), run.unassigned.end());
    }
    orient_listed_faces();
    count_faces_without_cell();
    std::sort(unassigned.begin(), unassigned.end());
    add_unassigned(unassigned);
    name_patches_inside();
    return std::move(result_);
  }

private:
  // Faces with equal vertices: cells first, then listed faces, both ascending by zone and number. ---------------------

  void visit_group(Group group, Run_result& run)
  {
    const auto first_listed =
      std::find_if(group.begin(), group.end(), [&](const Table::Keyed_entry& e) { return table_.is_listed(e.entry); });
    const Group cells(group.begin(), first_listed), listed(first_listed, group.end());
    count_cells(cells, run);
    if (cells.size() == 1 && listed.empty())
      run.unassigned.push_back(cell_face(cells[0].entry));
    assign_owners(cells, listed, run);
  }

  void count_cells(Group cells, Run_result& run) const
  {
    run.counts.boundary_faces += cells.size() == 1;
    run.counts.crowded_faces += cells.size() > 2;
    run.counts.interface_faces += cells.size() >= 2 && cell_face(cells[0].entry).zone != cell_face(cells[1].entry).zone;
  }

  void assign_owners(Group cells, Group listed, Run_result& run)
  {
    for (std::size_t i = 0; i < listed.size(); ++i)
    {
      const Place face = place(listed[i].entry);
      int times_before = 0; // listed by this zone
      bool is_duplicate = false;
      for (std::size_t j = 0; j < i; ++j)
        if (const Place other = place(listed[j].entry); other.zone == face.zone)
        {
          ++times_before;
          is_duplicate |= patch(other) == patch(face);
        }
      const Face_owners owners = owners_for(cells, face.zone, times_before);
      const int sides = owners.first.zone == no_index ? 0 : place_of(owners) == Face_place::inside ? 2 : 1;
      run.counts.duplicate_faces += times_before > 0 && (is_duplicate || times_before >= sides);
      result_.owners[face.zone][face.number] = owners;
    }
  }

  /// the two cells of a face, one of its zone first; the second time that a zone lists a face, its other side is meant.
  Face_owners owners_for(Group cells, Index zone, int times_before) const
  {
    if (cells.empty())
      return {};
    std::size_t own = 0;
    while (own < cells.size() && cell_face(cells[own].entry).zone != zone)
      ++own;
    own = own == cells.size() ? 0 : own;
    if (cells.size() == 1)
      return {cell_face(cells[own].entry), {}};
    const std::size_t other = own == 0 ? 1 : 0;
    Face_owners owners{cell_face(cells[own].entry), cell_face(cells[other].entry)};
    if (times_before == 1 && owners.second.zone == owners.first.zone)
      std::swap(owners.first, owners.second);
    return owners;
  }

  struct Place
  {
    Index zone;
    Index number; ///< of the face in its zone
  };

  Place place(Index entry) const
  {
    const Index number = table_.listed_number(entry);
    const internal::Element_block& block = faces_.block_of(number);
    return {block.zone, block.first_in_zone + (number - block.first)};
  }

  Index patch(const Place& face) const { return patch_of_face_[face.zone][face.number]; }

  Cell_face cell_face(Index entry) const
  {
    const Index cell = table_.cell_of(entry);
    const internal::Element_block& block = cells_.block_of(cell);
    return {block.zone, block.first_in_zone + (cell - block.first), table_.face_of(entry)};
  }

  // Results ----------------------------------------------------------------------------------------------------------

  void count_faces_without_cell()
  {
    for (const auto& owners : result_.owners)
      result_.report.faces_without_cell += std::count_if(
        owners.begin(), owners.end(), [](const Face_owners& o) { return place_of(o) == Face_place::nowhere; });
  }

  Index entry_of(const Cell_face& face) const
  {
    for (const internal::Element_block& block : cells_.blocks())
      if (block.zone == face.zone && face.cell < block.first_in_zone + block.section->size())
        return 8 * (block.first + face.cell - block.first_in_zone) + face.face;
    return no_index;
  }

  void orient_listed_faces()
  {
    for (std::size_t z = 0; z < mesh_.zones.size(); ++z)
    {
      Index number = 0;
      for (Section& section : mesh_.zones[z].faces)
        for (Index e = 0; e < section.size(); ++e, ++number)
          if (const Cell_face& owner = result_.owners[z][number].first; owner.zone != no_index)
            orient(section, e, static_cast<Index>(z), owner);
    }
  }

  void orient(Section& section, Index element, Index zone, const Cell_face& owner)
  {
    const int count = corner_count(section.type);
    Index* const nodes = section.nodes.data() + element * count;
    Face_corners listed{zone, count, {}};
    std::copy_n(nodes, count, listed.points.begin());
    const Face_corners outward = table_.corners(entry_of(owner));
    if (!run_alike(table_.vertices(listed), count, table_.vertices(outward), outward.count))
      std::reverse(nodes + 1, nodes + count);
  }

  /// whether two faces of the same vertices go around them the same way. Repeated vertices are passed over.
  static bool run_alike(const std::array<Index, 4>& a, int a_count, const std::array<Index, 4>& b, int b_count)
  {
    int matches = 0;
    for (int i = 0; i < a_count; ++i)
      for (int j = 0; j < b_count; ++j)
      {
        const Index from = a[i], to = a[(i + 1) % a_count];
        if (from == to || b[j] == b[(j + 1) % b_count])
          continue;
        matches += from == b[j] && to == b[(j + 1) % b_count];
        matches -= from == b[(j + 1) % b_count] && to == b[j];
      }
    return matches >= 0;
  }

  void add_unassigned(const std::vector<Cell_face>& faces)
  {
    result_.report.unassigned_faces = static_cast<Index>(faces.size());
    for (auto first = faces.begin(); first != faces.end();)
    {
      const auto last = std::find_if(first, faces.end(), [&](const Cell_face& f) { return f.zone != first->zone; });
      add_unassigned_of_zone(std::span<const Cell_face>(first, last));
      first = last;
    }
  }

  void add_unassigned_of_zone(std::span<const Cell_face> faces)
  {
    Zone& zone = mesh_.zones[faces.front().zone];
    Patch patch;
    patch.name = "unassigned";
    const auto old =
      std::find_if(zone.patches.begin(), zone.patches.end(), [&](const Patch& p) { return p.name == patch.name; });
    Patch& target = old == zone.patches.end() ? zone.patches.emplace_back(std::move(patch)) : *old;
    Index number = zone.face_count();
    for (const Element_type type : {Element_type::triangle, Element_type::quadrangle})
    {
      Section section = unassigned_section(zone, type);
      for (const Cell_face& face : faces)
        if (const std::vector<Index> points = distinct_corners(face);
            points.size() == static_cast<std::size_t>(corner_count(type)))
        {
          section.nodes.insert(section.nodes.end(), points.begin(), points.end());
          target.faces.push_back(number++);
          result_.owners[face.zone].push_back({face, {}});
        }
      if (!section.nodes.empty())
        zone.faces.push_back(std::move(section));
    }
  }

  static Section unassigned_section(const Zone& zone, Element_type type)
  {
    const auto is_taken = [&](const std::string& name) {
      for (const auto* sections : {&zone.cells, &zone.faces, &zone.bars})
        for (const Section& section : *sections)
          if (section.name == name)
            return true;
      return false;
    };
    return {free_name(fmt::format("unassigned_{}", element_name(type)), is_taken), type, {}};
  }

  /// corners of a face of a cell, from corner 0 on; of a collapsed quadrangle only the three that differ.
  std::vector<Index> distinct_corners(const Cell_face& face) const
  {
    const Face_corners corners = table_.corners(entry_of(face));
    const std::array<Index, 4> vertices = table_.vertices(corners);
    std::vector<Index> points;
    for (int c = 0; c < corners.count; ++c)
      if (std::find(vertices.begin(), vertices.begin() + c, vertices[c]) == vertices.begin() + c)
        points.push_back(corners.points[c]);
    return points;
  }

  void name_patches_inside()
  {
    for (std::size_t z = 0; z < mesh_.zones.size(); ++z)
      for (const Patch& patch : mesh_.zones[z].patches)
      {
        const auto has_face_in = [&](Face_place place) {
          return std::any_of(patch.faces.begin(), patch.faces.end(),
                             [&](Index face) { return place_of(result_.owners[z][face]) == place; });
        };
        const std::string name = fmt::format("{}/{}", mesh_.zones[z].name, patch.name);
        if (has_face_in(Face_place::inside))
          result_.report.internal_patches.push_back(name);
        if (has_face_in(Face_place::zone_interface))
          result_.report.interface_patches.push_back(name);
      }
  }

  Volume_mesh& mesh_;
  Element_blocks cells_;
  Element_blocks faces_;
  Patch_of_face patch_of_face_;
  Table table_;
  Boundary_faces result_;
};

} // namespace

Boundary_report& Boundary_report::operator+=(const Boundary_report& other)
{
  boundary_faces += other.boundary_faces;
  interface_faces += other.interface_faces;
  unassigned_faces += other.unassigned_faces;
  faces_without_cell += other.faces_without_cell;
  duplicate_faces += other.duplicate_faces;
  crowded_faces += other.crowded_faces;
  internal_patches.insert(internal_patches.end(), other.internal_patches.begin(), other.internal_patches.end());
  interface_patches.insert(interface_patches.end(), other.interface_patches.begin(), other.interface_patches.end());
  return *this;
}

Face_place place_of(const Face_owners& owners)
{
  if (owners.first.zone == no_index)
    return Face_place::nowhere;
  if (owners.second.zone == no_index)
    return Face_place::boundary;
  return owners.first.zone == owners.second.zone ? Face_place::inside : Face_place::zone_interface;
}

Boundary_faces find_boundary_faces(Volume_mesh& mesh, const Joined_zones& joined)
{
  add_patches_of_sections(mesh);
  return Boundary_finder(mesh, joined).find();
}

} // namespace recurve
