#include "periodic_nodes.h"

#include <recurve/elements/node_layout.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <span>
#include <string_view>
#include <unordered_map>

namespace recurve {

namespace {

Point rotated(Point p, const Point& angle)
{
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    const std::size_t a = (axis + 1) % 3, b = (axis + 2) % 3;
    const double c = std::cos(angle[axis]), s = std::sin(angle[axis]);
    p = axis == 0   ? Point{p[0], c * p[a] - s * p[b], s * p[a] + c * p[b]}
        : axis == 1 ? Point{s * p[a] + c * p[b], p[1], c * p[a] - s * p[b]}
                    : Point{c * p[a] - s * p[b], s * p[a] + c * p[b], p[2]};
  }
  return p;
}

Point image(const Periodicity& period, const Point& p)
{
  const Point& center = period.rotation_center;
  const Point q = rotated({p[0] - center[0], p[1] - center[1], p[2] - center[2]}, period.rotation_angle);
  return {q[0] + center[0] + period.translation[0], q[1] + center[1] + period.translation[1],
          q[2] + center[2] + period.translation[2]};
}

class Periodic_pairs
{
public:
  explicit Periodic_pairs(const Curved_mesh& mesh) : mesh_(mesh) {}

  std::vector<std::array<Index, 2>> find()
  {
    for (std::size_t z = 0; z < mesh_.zones.size(); ++z)
      for (const Zone_interface& interface : mesh_.linear.zones[z].interfaces)
        if (interface.periodicity && interface.is_abutting_one_to_one)
          add_interface(z, interface);
    std::sort(pairs_.begin(), pairs_.end());
    pairs_.erase(std::unique(pairs_.begin(), pairs_.end()), pairs_.end());
    return std::move(pairs_);
  }

private:
  using Face_key = std::array<Index, 4>; ///< corners, ascending

  struct Face
  {
    Element_type type;
    std::span<const Index> nodes;
  };

  void add_interface(std::size_t z, const Zone_interface& interface)
  {
    std::size_t donor = 0;
    while (donor < mesh_.zones.size() && mesh_.linear.zones[donor].name != interface.donor_zone)
      ++donor;
    if (donor == mesh_.zones.size())
      return;
    partner_.clear();
    for (std::size_t i = 0; i < interface.points.size(); ++i)
      if (interface.location == Zone_interface::Location::vertex)
        partner_[corner(z, interface.points[i])] = corner(donor, interface.donor_points[i]);
      else
        pair_corners(face(z, interface.points[i]), face(donor, interface.donor_points[i]), *interface.periodicity);
    for (const auto& [a, b] : partner_)
      pair(a, b);
    std::map<Face_key, Face> faces;
    for_each_face(donor, [&](const Face& f) { faces.emplace(key(f, [](Index n) { return n; }), f); });
    for_each_face(z, [&](const Face& f) {
      if (!std::ranges::all_of(corners(f), [&](Index n) { return partner_.count(n) > 0; }))
        return;
      const auto found = faces.find(key(f, [&](Index n) { return partner_.at(n); }));
      if (found != faces.end())
        pair_faces(f, found->second);
    });
  }

  Index corner(std::size_t zone, Index point) const { return mesh_.zones[zone].nodes[static_cast<std::size_t>(point)]; }

  Face face(std::size_t zone, Index number) const
  {
    const Section_entry at = find_element(mesh_.linear.zones[zone].faces, number);
    const Curved_section& section = mesh_.zones[zone].faces[static_cast<std::size_t>(at.section)];
    return element(section, at.element);
  }

  Face element(const Curved_section& section, Index number) const
  {
    const auto stride = static_cast<std::size_t>(node_count(section.type, mesh_.degree));
    return {section.type,
            std::span<const Index>(section.nodes).subspan(static_cast<std::size_t>(number) * stride, stride)};
  }

  template <class Visit>
  void for_each_face(std::size_t zone, const Visit& visit) const
  {
    for (const Curved_section& section : mesh_.zones[zone].faces)
      for (Index e = 0; e * node_count(section.type, mesh_.degree) < static_cast<Index>(section.nodes.size()); ++e)
        visit(element(section, e));
  }

  static std::span<const Index> corners(const Face& f)
  {
    return f.nodes.first(static_cast<std::size_t>(corner_count(f.type)));
  }

  template <class Node_of>
  static Face_key key(const Face& f, const Node_of& node_of)
  {
    Face_key result = {no_index, no_index, no_index, no_index};
    std::ranges::transform(corners(f), result.begin(), node_of);
    std::ranges::sort(result);
    return result;
  }

  void pair_corners(const Face& from, const Face& to, const Periodicity& period)
  {
    for (const Index a : corners(from))
    {
      const Point p = image(period, mesh_.nodes[static_cast<std::size_t>(a)]);
      double least = std::numeric_limits<double>::infinity();
      for (const Index b : corners(to))
      {
        const Point& q = mesh_.nodes[static_cast<std::size_t>(b)];
        if (const double d = std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]); d < least)
        {
          least = d;
          partner_[a] = b;
        }
      }
    }
  }

  void pair(Index a, Index b)
  {
    if (a != b)
      pairs_.push_back({std::min(a, b), std::max(a, b)});
  }

  void pair_runs(const Face& f, int first_of_f, const Face& g, int first_of_g, int count)
  {
    for (int m = 0; m < count; ++m)
      pair(f.nodes[static_cast<std::size_t>(first_of_f + m)], g.nodes[static_cast<std::size_t>(first_of_g + m)]);
  }

  void pair_faces(const Face& f, const Face& g)
  {
    const Reference_element& reference = reference_element(f.type);
    const auto ends = [&](const Face& of, int e, const auto& node_of) {
      const auto& numbers = reference.edges[static_cast<std::size_t>(e)];
      const Index a = node_of(of.nodes[static_cast<std::size_t>(numbers[0])]),
                  b = node_of(of.nodes[static_cast<std::size_t>(numbers[1])]);
      return std::array{std::min(a, b), std::max(a, b)};
    };
    for (int e = 0; e < reference.edge_count; ++e)
      for (int d = 0; d < reference.edge_count; ++d)
        if (ends(f, e, [&](Index n) { return partner_.at(n); }) == ends(g, d, [](Index n) { return n; }))
          pair_runs(f, first_edge_node(f.type, mesh_.degree, e), g, first_edge_node(g.type, mesh_.degree, d),
                    mesh_.degree - 1);
    const int inside = first_interior_node(f.type, mesh_.degree);
    pair_runs(f, inside, g, inside, interior_node_count(f.type, mesh_.degree));
  }

  const Curved_mesh& mesh_;
  std::unordered_map<Index, Index> partner_; ///< of the corners of one interface
  std::vector<std::array<Index, 2>> pairs_;
};

} // namespace

std::vector<std::array<Index, 2>> periodic_nodes(const Curved_mesh& mesh)
{
  return Periodic_pairs(mesh).find();
}

} // namespace recurve
