// Why cells of a mesh are still folded after the layers have followed the wall. Each such cell is led back, through the
// stack of prisms or hexahedra that it is in, to the face of the boundary beneath it, of several to the one that bulges
// most for its first cell; a Markdown table counts the cells by what that face is like, a second one lists the first of
// them.
//
//   explain_folds MESH DEGREE [LISTED]
//
// Taken together are cells whose straight-sided selves are valid and that are not certified after deformation, before
// validity is restored. A face is folded if, at one of 33 x 33 points, its normal is turned by more than 90 degrees
// from the mean one.
#include <recurve/elements/basis.h>
#include <recurve/io/mesh_io.h>
#include <recurve/mesh/join_zones.h>
#include <recurve/run/curve_mesh.h>
#include <recurve/volume/bound_jacobian.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <map>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace {

using namespace recurve;

constexpr double infinity = std::numeric_limits<double>::infinity();

Point difference(const Point& a, const Point& b)
{
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
double dot(const Point& a, const Point& b)
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Point cross(const Point& a, const Point& b)
{
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double length(const Point& a)
{
  return std::sqrt(dot(a, a));
}

using Corners = std::vector<Index>;

struct Cell
{
  Element_type type;
  std::span<const Index> nodes;
};

struct Wall_face
{
  Element_type type;
  std::span<const Index> nodes;
  std::string patch;
  bool is_folded = false;
  double least_normal = 1; ///< smallest component of a normal along the mean one, over the largest
  double bulge = 0;        ///< largest displacement of a node
  double shortest_edge = infinity, largest_angle = 0;
  double first_height = infinity;

  std::span<const Index> corners() const { return nodes.first(static_cast<std::size_t>(corner_count(type))); }
};

/// Where a cell is above a face of the boundary.
struct Place
{
  Index face = no_index;
  int level = 0;
};

class Explanation
{
public:
  Explanation(Volume_mesh mesh, int degree)
  {
    curved_ = curve_mesh(std::move(mesh), {.degree = degree, .certify = false});
    straight_ = elevate(curved_.linear, join_zones(curved_.linear), degree);
    list_cells();
    list_wall_faces();
    for (std::size_t f = 0; f < faces_.size(); ++f)
      climb(static_cast<Index>(f));
    find_folds();
    for (Wall_face& face : faces_)
    {
      measure(face);
      if (const auto corners = face.corners(); !fault(face).empty())
        faulty_corners_.insert(corners.begin(), corners.end());
    }
  }

  void print(std::size_t listed) const
  {
    struct Count
    {
      Index cells = 0;
      std::set<Index> faces;
      double least_bulge = infinity, largest_bulge = 0;
    };
    std::map<std::string, Count> counts;
    for (const Index c : folds_)
    {
      const Index f = places_[static_cast<std::size_t>(c)].face;
      Count& count = counts[reason(c)];
      ++count.cells;
      count.faces.insert(f);
      if (f == no_index)
        continue;
      const double bulge = relative_bulge(faces_[static_cast<std::size_t>(f)]);
      count.least_bulge = std::min(count.least_bulge, bulge);
      count.largest_bulge = std::max(count.largest_bulge, bulge);
    }
    std::printf("%zu of %zu cells folded after deformation; %td of %zu displaced faces of the boundary are folded\n\n",
                folds_.size(), cells_.size(), std::ranges::count_if(faces_, &Wall_face::is_folded), faces_.size());
    std::printf("| beneath the cell | cells | faces | bulge / first height |\n|---|---|---|---|\n");
    for (const auto& [name, count] : counts)
      std::printf("| %s | %lld | %zu | %.3g to %.3g |\n", name.c_str(), static_cast<long long>(count.cells),
                  count.faces.size(), count.least_bulge, count.largest_bulge);
    list(listed);
  }

private:
  void list_cells()
  {
    for (const Curved_zone& zone : curved_.zones)
      for (const Curved_section& section : zone.cells)
      {
        const auto n = static_cast<std::size_t>(node_count(section.type, curved_.degree));
        for (std::size_t first = 0; first < section.nodes.size(); first += n)
        {
          const auto number = static_cast<Index>(cells_.size());
          cells_.push_back({section.type, std::span<const Index>(section.nodes).subspan(first, n)});
          for (int f = 0; f < reference_element(section.type).face_count; ++f)
            neighbours_[corners_of(cells_.back(), f)].push_back(number);
        }
      }
    places_.resize(cells_.size());
  }

  static Corners corners_of(const Cell& cell, int f)
  {
    const Reference_face& face = reference_element(cell.type).faces[static_cast<std::size_t>(f)];
    Corners corners;
    for (int c = 0; c < face.corner_count; ++c)
      corners.push_back(cell.nodes[static_cast<std::size_t>(face.corners[static_cast<std::size_t>(c)])]);
    std::ranges::sort(corners);
    return corners;
  }

  /// the faces of patches of which a node was displaced.
  void list_wall_faces()
  {
    for (std::size_t z = 0; z < curved_.zones.size(); ++z)
    {
      std::vector<Wall_face> all;
      for (const Curved_section& section : curved_.zones[z].faces)
      {
        const auto n = static_cast<std::size_t>(node_count(section.type, curved_.degree));
        for (std::size_t first = 0; first < section.nodes.size(); first += n)
          all.push_back({section.type, std::span<const Index>(section.nodes).subspan(first, n), {}});
      }
      for (const Patch& patch : curved_.linear.zones[z].patches)
        for (const Index f : patch.faces)
        {
          Wall_face face = all[static_cast<std::size_t>(f)];
          face.patch = patch.name;
          for (const Index n : face.nodes)
            face.bulge = std::max(face.bulge, length(difference(at(curved_, n), at(straight_, n))));
          if (face.bulge > 0)
            faces_.push_back(face);
        }
    }
  }

  /// marks the cells of the stack above a face.
  void climb(Index number)
  {
    Wall_face& face = faces_[static_cast<std::size_t>(number)];
    Corners corners(face.nodes.begin(), face.nodes.begin() + corner_count(face.type));
    std::ranges::sort(corners);
    Index from = no_index;
    for (int level = 0;; ++level)
    {
      const auto found = neighbours_.find(corners);
      if (found == neighbours_.end())
        return;
      const auto next = std::ranges::find_if(found->second, [&](Index c) { return c != from; });
      if (next == found->second.end())
        return;
      from = *next;
      Place& place = places_[static_cast<std::size_t>(from)];
      const Cell& cell = cells_[static_cast<std::size_t>(from)];
      const Corners opposite = opposite_of(cell, corners);
      if (level == 0 && !opposite.empty())
        face.first_height = height(cell, corners, opposite);
      if (place.face == no_index || relative_bulge(face) > relative_bulge(faces_[static_cast<std::size_t>(place.face)]))
        place = {number, level};
      if (opposite.empty())
        return;
      corners = opposite;
    }
  }

  /// the corners of a prism or hexahedron that are not in the face `corners`; empty if they are no face.
  static Corners opposite_of(const Cell& cell, const Corners& corners)
  {
    for (int f = 0; f < reference_element(cell.type).face_count; ++f)
      if (Corners other = corners_of(cell, f);
          other.size() == corners.size() &&
          std::ranges::none_of(other, [&](Index n) { return std::ranges::binary_search(corners, n); }))
        return other;
    return {};
  }

  double height(const Cell& cell, const Corners& corners, const Corners& opposite) const
  {
    double least = infinity;
    const Reference_element& reference = reference_element(cell.type);
    for (int e = 0; e < reference.edge_count; ++e)
    {
      const auto& ends = reference.edges[static_cast<std::size_t>(e)];
      const Index a = cell.nodes[static_cast<std::size_t>(ends[0])], b = cell.nodes[static_cast<std::size_t>(ends[1])];
      if (std::ranges::binary_search(corners, a) != std::ranges::binary_search(corners, b) &&
          std::ranges::binary_search(opposite, a) != std::ranges::binary_search(opposite, b))
        least = std::min(least, length(difference(at(straight_, a), at(straight_, b))));
    }
    return least;
  }

  void find_folds()
  {
    for (std::size_t c = 0; c < cells_.size(); ++c)
    {
      const Cell& cell = cells_[c];
      if (std::ranges::all_of(cell.nodes, [&](Index n) { return at(curved_, n) == at(straight_, n); }))
        continue;
      if (!is_valid(curved_, cell) && is_valid(straight_, cell))
        folds_.push_back(static_cast<Index>(c));
    }
  }

  static Jacobian_bounds bounds(const Curved_mesh& mesh, const Cell& cell)
  {
    std::vector<Point> points;
    for (const Index n : cell.nodes)
      points.push_back(at(mesh, n));
    return bound_jacobian(cell.type, mesh.degree, points);
  }
  static bool is_valid(const Curved_mesh& mesh, const Cell& cell)
  {
    return bounds(mesh, cell).verdict == Validity::valid;
  }
  static double scaled(const Curved_mesh& mesh, const Cell& cell) { return bounds(mesh, cell).scaled; }

  void measure(Wall_face& face) const
  {
    const Reference_element& reference = reference_element(face.type);
    const int n = corner_count(face.type);
    for (int c = 0; c < n; ++c)
    {
      const auto corner = [&](int k) { return at(straight_, face.nodes[static_cast<std::size_t>((c + k) % n)]); };
      const Point next = difference(corner(1), corner(0)), last = difference(corner(n - 1), corner(0));
      face.shortest_edge = std::min(face.shortest_edge, length(next));
      const double angle = std::atan2(length(cross(next, last)), dot(next, last)) * 180 / std::acos(-1);
      face.largest_angle = std::max(face.largest_angle, angle);
    }
    constexpr int steps = 32;
    std::vector<Point> normals;
    for (int i = 0; i <= steps; ++i)
      for (int j = 0; j <= (reference.corner_count == 3 ? steps - i : steps); ++j)
        normals.push_back(normal(face, {double(i) / steps, double(j) / steps, 0}));
    Point mean = {};
    for (const Point& normal : normals)
      mean = {mean[0] + normal[0], mean[1] + normal[1], mean[2] + normal[2]};
    double least = infinity, most = 0;
    for (const Point& normal : normals)
    {
      least = std::min(least, dot(normal, mean));
      most = std::max(most, dot(normal, mean));
    }
    face.least_normal = least / most;
    face.is_folded = least <= 0;
  }

  Point normal(const Wall_face& face, const Reference_point& xi) const
  {
    std::vector<std::array<double, 3>> derivatives(face.nodes.size());
    lagrange_derivatives(face.type, curved_.degree, xi, derivatives);
    std::array<Point, 2> tangents = {};
    for (std::size_t m = 0; m < face.nodes.size(); ++m)
      for (std::size_t t = 0; t < 2; ++t)
        for (std::size_t d = 0; d < 3; ++d)
          tangents[t][d] += derivatives[m][t] * at(curved_, face.nodes[m])[d];
    return cross(tangents[0], tangents[1]);
  }

  static double relative_bulge(const Wall_face& face) { return face.bulge / face.first_height; }

  /// what keeps layers from following a face; empty: nothing.
  static std::string fault(const Wall_face& face)
  {
    constexpr double flat_corner = 165, nearly_folded = 0.1, large_bulge = 0.5;
    if (face.is_folded)
      return "folded";
    if (face.least_normal < nearly_folded)
      return "nearly folded: a normal shrinks to less than a tenth";
    if (face.bulge > large_bulge * face.shortest_edge)
      return "bulges by more than half its shortest edge";
    if (face.largest_angle > flat_corner)
      return "has a corner of more than 165 degrees";
    return {};
  }

  std::string reason(Index cell) const
  {
    constexpr double hardly_valid = 0.1;
    const Place& place = places_[static_cast<std::size_t>(cell)];
    if (place.face == no_index)
      return "no face of the boundary: not in a stack";
    const Wall_face& face = faces_[static_cast<std::size_t>(place.face)];
    if (const std::string own = fault(face); !own.empty())
      return face.patch + ": " + own;
    if (std::ranges::any_of(face.corners(), [&](Index n) { return faulty_corners_.count(n) > 0; }))
      return face.patch + ": next to such a face";
    if (scaled(straight_, cells_[static_cast<std::size_t>(cell)]) < hardly_valid)
      return face.patch + ": no fault, but the straight cell has a scaled Jacobian below 0.1";
    return face.patch + ": no fault";
  }

  void list(std::size_t listed) const
  {
    std::printf(
      "\n| cell | type | level | patch | least normal | bulge / first height | bulge / shortest edge |"
      " largest angle | scaled Jacobian, straight | now | at |\n|---|---|---|---|---|---|---|---|---|---|---|\n");
    for (std::size_t m = 0; m < std::min(listed, folds_.size()); ++m)
    {
      const auto c = static_cast<std::size_t>(folds_[m]);
      const Place& place = places_[c];
      const Wall_face face = place.face == no_index ? Wall_face{} : faces_[static_cast<std::size_t>(place.face)];
      const Point& corner = at(straight_, cells_[c].nodes[0]);
      std::printf("| %zu | %s | %d | %s | %.3f | %.3g | %.3g | %.1f | %.3g | %.3g | %.4g %.4g %.4g |\n", c,
                  std::string(element_name(cells_[c].type)).c_str(), place.level, face.patch.c_str(), face.least_normal,
                  relative_bulge(face), face.bulge / face.shortest_edge, face.largest_angle,
                  scaled(straight_, cells_[c]), scaled(curved_, cells_[c]), corner[0], corner[1], corner[2]);
    }
  }

  static const Point& at(const Curved_mesh& mesh, Index node) { return mesh.nodes[static_cast<std::size_t>(node)]; }

  Curved_mesh curved_, straight_;
  std::vector<Cell> cells_;
  std::map<Corners, std::vector<Index>> neighbours_; ///< cells by the corners of their faces
  std::vector<Wall_face> faces_;
  std::vector<Place> places_;      ///< per cell
  std::set<Index> faulty_corners_; ///< of faces with a fault
  std::vector<Index> folds_;
};

} // namespace

int main(int argc, char** argv)
{
  if (argc < 3)
  {
    std::fprintf(stderr, "usage: explain_folds MESH DEGREE [LISTED]\n");
    return 1;
  }
  const Explanation explanation(read_mesh(argv[1]), std::atoi(argv[2]));
  explanation.print(argc > 3 ? static_cast<std::size_t>(std::atoi(argv[3])) : 0);
  return 0;
}
