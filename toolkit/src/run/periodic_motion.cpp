#include "periodic_motion.h"

#include <recurve/core/exceptions.h>
#include <recurve/elements/node_layout.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <span>

namespace recurve {

namespace {

struct Face
{
  Element_type type = Element_type::triangle;
  std::span<const Index> nodes;

  std::span<const Index> corners() const { return nodes.first(static_cast<std::size_t>(corner_count(type))); }
};

Point turned(const std::array<Point, 3>& rotation, const Point& v)
{
  Point result;
  for (std::size_t r = 0; r < 3; ++r)
    result[r] = rotation[r][0] * v[0] + rotation[r][1] * v[1] + rotation[r][2] * v[2];
  return result;
}

Period period_of(const Periodicity& stated)
{
  Period period;
  period.center = stated.rotation_center;
  period.translation = stated.translation;
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    const double angle = stated.rotation_angle[axis];
    if (angle == 0)
      continue;
    period.is_translation = false;
    const std::size_t a = (axis + 1) % 3, b = (axis + 2) % 3;
    for (std::size_t column = 0; column < 3; ++column)
    {
      const double u = period.rotation[a][column], v = period.rotation[b][column];
      period.rotation[a][column] = std::cos(angle) * u - std::sin(angle) * v;
      period.rotation[b][column] = std::sin(angle) * u + std::cos(angle) * v;
    }
  }
  return period;
}

double distance(const Point& a, const Point& b)
{
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

/// Points to be found by where they are.
class Point_grid
{
public:
  Point_grid(const Curved_mesh& mesh, std::span<const Index> nodes, double tolerance)
    : mesh_(mesh), tolerance_(tolerance)
  {
    for (const Index node : nodes)
      cells_[cell(mesh.nodes[static_cast<std::size_t>(node)])].push_back(node);
  }

  /// the nearest within the tolerance, or no_index.
  Index find(const Point& position) const
  {
    Index nearest = no_index;
    double least = tolerance_;
    const Cell middle = cell(position);
    for (int m = 0; m < 27; ++m)
    {
      const auto found = cells_.find({middle[0] + m % 3 - 1, middle[1] + m / 3 % 3 - 1, middle[2] + m / 9 - 1});
      if (found == cells_.end())
        continue;
      for (const Index node : found->second)
        if (const double d = distance(mesh_.nodes[static_cast<std::size_t>(node)], position); d <= least)
        {
          least = d;
          nearest = node;
        }
    }
    return nearest;
  }

private:
  using Cell = std::array<long long, 3>;

  Cell cell(const Point& p) const
  {
    return {std::llround(p[0] / tolerance_), std::llround(p[1] / tolerance_), std::llround(p[2] / tolerance_)};
  }

  const Curved_mesh& mesh_;
  double tolerance_;
  std::map<Cell, std::vector<Index>> cells_;
};

/// Two patches and the partners of their corners.
class Patch_pair
{
public:
  Patch_pair(const Curved_mesh& mesh, const Period& period) : mesh_(mesh) { result_.period = period; }

  std::map<Index, Index> partner; ///< of corners

  /// pairs the nodes of all faces whose corners have partners.
  Periodic_nodes pair(std::span<const Face> faces, std::span<const Face> others)
  {
    std::map<std::vector<Index>, const Face*> by_corners;
    for (const Face& other : others)
      by_corners.emplace(sorted({other.corners().begin(), other.corners().end()}), &other);
    for (const Face& face : faces)
    {
      std::vector<Index> images;
      for (const Index corner : face.corners())
        if (const auto found = partner.find(corner); found != partner.end())
          images.push_back(found->second);
      if (images.size() < face.corners().size())
        continue;
      if (const auto found = by_corners.find(sorted(images)); found != by_corners.end())
        pair_faces(face, images, *found->second);
    }
    std::sort(result_.pairs.begin(), result_.pairs.end());
    result_.pairs.erase(std::unique(result_.pairs.begin(), result_.pairs.end()), result_.pairs.end());
    return std::move(result_);
  }

private:
  static std::vector<Index> sorted(std::vector<Index> list)
  {
    std::sort(list.begin(), list.end());
    return list;
  }

  /// \param images  partners of the corners of `face`, in their order
  void pair_faces(const Face& face, const std::vector<Index>& images, const Face& other)
  {
    const int n = corner_count(face.type);
    const auto corners = other.corners();
    const int first = static_cast<int>(std::ranges::find(corners, images[0]) - corners.begin());
    const bool is_reversed = corners[static_cast<std::size_t>((first + 1) % n)] != images[1];
    const std::span<const int> order = face_orientation(other.type, mesh_.degree, first, is_reversed);
    for (std::size_t m = 0; m < face.nodes.size(); ++m)
      if (const Index image = other.nodes[static_cast<std::size_t>(order[m])]; image != face.nodes[m])
        result_.pairs.push_back({face.nodes[m], image});
  }

  const Curved_mesh& mesh_;
  Periodic_nodes result_;
};

std::vector<Face> faces_of_zone(const Curved_mesh& mesh, std::size_t zone)
{
  std::vector<Face> faces;
  for (const Curved_section& section : mesh.zones[zone].faces)
  {
    const auto n = static_cast<std::size_t>(node_count(section.type, mesh.degree));
    for (std::size_t first = 0; first < section.nodes.size(); first += n)
      faces.push_back({section.type, std::span<const Index>(section.nodes).subspan(first, n)});
  }
  return faces;
}

std::vector<Face> faces_of_patches(const Curved_mesh& mesh, const std::string& name)
{
  std::vector<Face> result;
  bool is_known = false;
  for (std::size_t z = 0; z < mesh.zones.size(); ++z)
  {
    const std::vector<Face> all = faces_of_zone(mesh, z);
    for (const Patch& patch : mesh.linear.zones[z].patches)
      if (patch.name == name)
      {
        is_known = true;
        for (const Index face : patch.faces)
          result.push_back(all[static_cast<std::size_t>(face)]);
      }
  }
  if (!is_known)
    throw Input_error(fmt::format("periodic patches: there is no patch {}", name));
  return result;
}

std::vector<Index> corners_of(std::span<const Face> faces)
{
  std::set<Index> corners;
  for (const Face& face : faces)
    corners.insert(face.corners().begin(), face.corners().end());
  return {corners.begin(), corners.end()};
}

/// the middle of the box of some nodes, and its diagonal.
std::pair<Point, double> box_of(const Curved_mesh& mesh, std::span<const Index> nodes)
{
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Point low = {infinity, infinity, infinity}, high = {-infinity, -infinity, -infinity}, middle;
  for (const Index node : nodes)
    for (std::size_t d = 0; d < 3; ++d)
    {
      low[d] = std::min(low[d], mesh.nodes[static_cast<std::size_t>(node)][d]);
      high[d] = std::max(high[d], mesh.nodes[static_cast<std::size_t>(node)][d]);
    }
  for (std::size_t d = 0; d < 3; ++d)
    middle[d] = (low[d] + high[d]) / 2;
  return {middle, distance(low, high)};
}

// Of the diagonal of the patch: what is farther apart is not the same point, even where coordinates were rounded to
// float32; far less than the edges of a periodic patch are long.
constexpr double matching_tolerance = 1e-6;

Periodic_nodes pair_named(const Curved_mesh& mesh, const std::array<std::string, 2>& names)
{
  const std::vector<Face> faces = faces_of_patches(mesh, names[0]), others = faces_of_patches(mesh, names[1]);
  const std::vector<Index> corners = corners_of(faces), other_corners = corners_of(others);
  const auto [middle, diagonal] = box_of(mesh, corners);
  const Point other_middle = box_of(mesh, other_corners).first;
  Period period;
  for (std::size_t d = 0; d < 3; ++d)
    period.translation[d] = other_middle[d] - middle[d];
  const Point_grid grid(mesh, other_corners, matching_tolerance * diagonal);
  Patch_pair pair(mesh, period);
  for (const Index corner : corners)
    if (const Index image = grid.find(period.image(mesh.nodes[static_cast<std::size_t>(corner)])); image != no_index)
      pair.partner[corner] = image;
  if (pair.partner.size() < corners.size() || corners.size() != other_corners.size())
    throw Input_error(
      fmt::format("periodic patches: {} and {} are no translation apart: {} of {} corners have a partner", names[0],
                  names[1], pair.partner.size(), std::max(corners.size(), other_corners.size())));
  return pair.pair(faces, others);
}

Periodic_nodes pair_interface(const Curved_mesh& mesh, std::size_t zone, std::size_t donor,
                              const Zone_interface& interface)
{
  const std::vector<Face> faces = faces_of_zone(mesh, zone), others = faces_of_zone(mesh, donor);
  const Period period = period_of(*interface.periodicity);
  Patch_pair pair(mesh, period);
  for (std::size_t m = 0; m < interface.points.size(); ++m)
  {
    const auto a = static_cast<std::size_t>(interface.points[m]),
               b = static_cast<std::size_t>(interface.donor_points[m]);
    if (interface.location == Zone_interface::Location::vertex)
    {
      pair.partner[mesh.zones[zone].nodes[a]] = mesh.zones[donor].nodes[b];
      continue;
    }
    for (const Index corner : faces[a].corners())
      pair.partner[corner] = *std::ranges::min_element(others[b].corners(), {}, [&](Index other) {
        return distance(mesh.nodes[static_cast<std::size_t>(other)],
                        period.image(mesh.nodes[static_cast<std::size_t>(corner)]));
      });
  }
  return pair.pair(faces, others);
}

/// An interface and its partner say the same twice: of two opposite pairs the first one is kept, so that one node leads
/// and the other follows.
void drop_returns(std::vector<Periodic_nodes>& list)
{
  std::set<std::array<Index, 2>> known;
  for (Periodic_nodes& periodic : list)
  {
    std::erase_if(periodic.pairs, [&](const auto& pair) { return known.count({pair[1], pair[0]}) > 0; });
    known.insert(periodic.pairs.begin(), periodic.pairs.end());
  }
}

} // namespace

Point Period::image(const Point& position) const
{
  Point result = position;
  if (!is_translation)
  {
    result = turned(rotation, {position[0] - center[0], position[1] - center[1], position[2] - center[2]});
    for (std::size_t d = 0; d < 3; ++d)
      result[d] += center[d];
  }
  for (std::size_t d = 0; d < 3; ++d)
    result[d] += translation[d];
  return result;
}

Point Period::image_of_displacement(const Point& displacement) const
{
  return is_translation ? displacement : turned(rotation, displacement);
}

Point periodic_position(const Period& period, const Point& straight, const Point& straight_image, const Point& position)
{
  if (period.image(straight) == straight_image)
    return period.image(position);
  const Point displacement =
    period.image_of_displacement({position[0] - straight[0], position[1] - straight[1], position[2] - straight[2]});
  return {straight_image[0] + displacement[0], straight_image[1] + displacement[1],
          straight_image[2] + displacement[2]};
}

std::vector<Periodic_nodes> find_periodic_nodes(const Curved_mesh& mesh,
                                                const std::vector<std::array<std::string, 2>>& named)
{
  std::vector<Periodic_nodes> result;
  result.reserve(named.size());
  for (const auto& names : named)
    result.push_back(pair_named(mesh, names));
  for (std::size_t z = 0; z < mesh.zones.size(); ++z)
    for (const Zone_interface& interface : mesh.linear.zones[z].interfaces)
      for (std::size_t donor = 0; donor < mesh.zones.size(); ++donor)
        if (interface.periodicity && interface.is_abutting_one_to_one &&
            mesh.linear.zones[donor].name == interface.donor_zone)
          result.push_back(pair_interface(mesh, z, donor, interface));
  drop_returns(result);
  return result;
}

} // namespace recurve
