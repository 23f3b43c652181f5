#include <recurve/mesh/volume_mesh.h>

namespace recurve {

namespace {

Index element_count(const std::vector<Section>& sections)
{
  Index count = 0;
  for (const Section& section : sections)
    count += section.size();
  return count;
}

} // namespace

Index Zone::cell_count() const
{
  return element_count(cells);
}

Index Zone::face_count() const
{
  return element_count(faces);
}

Index Volume_mesh::cell_count() const
{
  Index count = 0;
  for (const Zone& zone : zones)
    count += zone.cell_count();
  return count;
}

const Zone* find_zone(const Volume_mesh& mesh, std::string_view name)
{
  for (const Zone& zone : mesh.zones)
    if (zone.name == name)
      return &zone;
  return nullptr;
}

Section_entry find_element(const std::vector<Section>& sections, Index number)
{
  if (number < 0)
    return {};
  for (std::size_t s = 0; s < sections.size(); ++s)
  {
    if (number < sections[s].size())
      return {static_cast<Index>(s), number};
    number -= sections[s].size();
  }
  return {};
}

} // namespace recurve
