#include <recurve/core/exceptions.h>
#include <recurve/mesh/internal/face_table.h>
#include <recurve/mesh/internal/neighbor_tree.h>
#include <recurve/mesh/internal/point_clusters.h>
#include <recurve/mesh/join_zones.h>

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <map>
#include <set>

namespace recurve {

namespace {

using internal::Element_block;
using internal::Face_corners;

/// Two float32 numbers that stand for one double differ by at most 2^-23 of it; twice that covers three axes.
constexpr double float32_slack = 1.0 / (1 << 22);
/// The same for doubles, where a writer has moved or scaled the zones.
constexpr double float64_slack = 4 * std::numeric_limits<double>::epsilon();
/// The slack never exceeds this part of the shortest edge, or points of neighbouring vertices might be taken for one.
constexpr double largest_slack = 0.25;
/// Points that an interface states to be one may lie apart by this part of the longest edge at them: files are sloppy.
/// A periodic partner, whose shift is at least a cell, lies farther away.
constexpr double largest_stated_gap = 0.1;
constexpr std::size_t notes_kept = 10;

/// Two points, numbered across the zones, that may be one.
struct Candidate
{
  bool lacks_common_face = false;
  double squared_distance = 0;
  Index a = no_index, b = no_index; ///< a < b

  friend bool operator<(const Candidate& p, const Candidate& q)
  {
    return std::tie(p.lacks_common_face, p.squared_distance, p.a, p.b) <
           std::tie(q.lacks_common_face, q.squared_distance, q.a, q.b);
  }
};

/// Lengths of the edges of cells at a point. Edges of length zero (collapsed cells) say nothing and are left out.
struct Edge_lengths
{
  double shortest = std::numeric_limits<double>::infinity();
  double longest = 0;
};

bool has_float32_coordinates(const Zone& zone)
{
  return std::all_of(zone.points.begin(), zone.points.end(), [](const Point& point) {
    return std::all_of(point.begin(), point.end(), [](double x) { return double(float(x)) == x; });
  });
}

double size_of(const Point& point)
{
  return std::max({std::abs(point[0]), std::abs(point[1]), std::abs(point[2])});
}

/// A face of `n` corners lies on another in 2n ways; corner `c` of the one then meets this corner of the other. Faces
/// that look at each other run opposite ways round: those ways come first.
int partner_corner(int n, int way, int c)
{
  return (way < n ? way + n - c : way + c) % n;
}

/// Numbers the points of all zones consecutively.
class Point_numbering
{
public:
  explicit Point_numbering(const Volume_mesh& mesh) : mesh_(mesh), first_(1, 0)
  {
    for (const Zone& zone : mesh.zones)
      first_.push_back(first_.back() + static_cast<Index>(zone.points.size()));
  }

  Index size() const { return first_.back(); }
  Index number(Index zone, Index point) const { return first_[zone] + point; }
  Index zone(Index number) const { return std::upper_bound(first_.begin(), first_.end(), number) - first_.begin() - 1; }
  Index point(Index number) const { return number - first_[zone(number)]; }
  const Point& position(Index number) const
  {
    const Index z = zone(number);
    return mesh_.zones[z].points[number - first_[z]];
  }

private:
  const Volume_mesh& mesh_;
  std::vector<Index> first_;
};

class Zone_joiner
{
public:
  Zone_joiner(const Volume_mesh& mesh, const Join_options& options)
    : mesh_(mesh), options_(options), cells_(internal::cell_blocks(mesh)), numbering_(mesh),
      clusters_(numbering_.size())
  {
    for (const Zone& zone : mesh.zones)
      is_float32_.push_back(has_float32_coordinates(zone));
  }

  Joined_zones join()
  {
    if (options_.use_connectivity)
      collect_stated_pairs();
    if (options_.use_geometry && mesh_.zones.size() > 1)
      collect_hull();
    measure_edges();
    join_stated_pairs();
    mark_stated_roots();
    if (options_.use_geometry && mesh_.zones.size() > 1)
      join_coinciding_points();
    return number_vertices();
  }

private:
  // Stated interfaces ------------------------------------------------------------------------------------------------

  void collect_stated_pairs()
  {
    for (std::size_t z = 0; z < mesh_.zones.size(); ++z)
      for (const Zone_interface& interface : mesh_.zones[z].interfaces)
        if (interface.is_abutting_one_to_one && !interface.periodicity)
          collect_interface(static_cast<Index>(z), interface);
  }

  void collect_interface(Index zone, const Zone_interface& interface)
  {
    const Zone* const donor = find_zone(mesh_, interface.donor_zone);
    if (donor == nullptr)
      throw Input_error(fmt::format("zone '{}', interface '{}': there is no zone '{}'", mesh_.zones[zone].name,
                                    interface.name, interface.donor_zone));
    if (interface.points.size() != interface.donor_points.size())
      throw Input_error(fmt::format("zone '{}', interface '{}': {} points meet {} points of zone '{}'",
                                    mesh_.zones[zone].name, interface.name, interface.points.size(),
                                    interface.donor_points.size(), interface.donor_zone));
    const Index donor_zone = donor - mesh_.zones.data();
    for (std::size_t m = 0; m < interface.points.size(); ++m)
      if (interface.location == Zone_interface::Location::vertex)
        add_stated_pair(stated_point(zone, interface.points[m], interface),
                        stated_point(donor_zone, interface.donor_points[m], interface));
      else
        add_stated_faces(stated_face(zone, interface.points[m], interface),
                         stated_face(donor_zone, interface.donor_points[m], interface), interface);
  }

  Index stated_point(Index zone, Index point, const Zone_interface& interface) const
  {
    if (point < 0 || point >= static_cast<Index>(mesh_.zones[zone].points.size()))
      throw Input_error(fmt::format("interface '{}': node {} of zone '{}' does not exist (nodes are 1 to {})",
                                    interface.name, point + 1, mesh_.zones[zone].name,
                                    mesh_.zones[zone].points.size()));
    return numbering_.number(zone, point);
  }

  Face_corners stated_face(Index zone, Index face, const Zone_interface& interface) const
  {
    const Section_entry entry = find_element(mesh_.zones[zone].faces, face);
    if (entry.section == no_index)
      throw Input_error(fmt::format("interface '{}': face {} of zone '{}' does not exist (faces are 1 to {})",
                                    interface.name, face + 1, mesh_.zones[zone].name, mesh_.zones[zone].face_count()));
    const Section& section = mesh_.zones[zone].faces[entry.section];
    Face_corners corners{zone, corner_count(section.type), {}};
    std::copy_n(section.nodes.begin() + entry.element * corners.count, corners.count, corners.points.begin());
    return corners;
  }

  void add_stated_pair(Index a, Index b)
  {
    if (a != b)
      stated_.push_back(candidate(a, b));
  }

  /// pairs the corners in that of the 2n ways of putting one face on the other that leaves the smallest gap.
  void add_stated_faces(const Face_corners& a, const Face_corners& b, const Zone_interface& interface)
  {
    const int n = a.count;
    if (b.count != n)
      throw Input_error(fmt::format("interface '{}' of zone '{}': a face of {} corners meets one of {}", interface.name,
                                    mesh_.zones[a.zone].name, n, b.count));
    const auto partner = [&](int way, int c) { return corner(b, partner_corner(n, way, c)); };
    int best = 0;
    double smallest_gap = std::numeric_limits<double>::infinity();
    for (int way = 0; way < 2 * n; ++way)
    {
      double gap = 0;
      for (int c = 0; c < n; ++c)
        gap = std::max(
          gap, internal::squared_distance(numbering_.position(corner(a, c)), numbering_.position(partner(way, c))));
      if (gap < smallest_gap)
      {
        smallest_gap = gap;
        best = way;
      }
    }
    for (int c = 0; c < n; ++c)
      add_stated_pair(corner(a, c), partner(best, c));
  }

  void join_stated_pairs()
  {
    // An interface is often stated from both its zones.
    std::sort(stated_.begin(), stated_.end());
    stated_.erase(std::unique(stated_.begin(), stated_.end(),
                              [](const Candidate& p, const Candidate& q) { return p.a == q.a && p.b == q.b; }),
                  stated_.end());
    // The cut of a zone with itself goes first: it alone may put two points of a zone into one vertex.
    for (const bool is_cut : {true, false})
      for (const Candidate& pair : stated_)
        if ((numbering_.zone(pair.a) == numbering_.zone(pair.b)) == is_cut)
        {
          const double gap = largest_stated_gap * std::max(lengths(pair.a).longest, lengths(pair.b).longest);
          if (std::sqrt(pair.squared_distance) > gap + slack(pair.a))
            refuse(pair, result_.pairs_refused_by_distance, "an interface joins them, but they lie apart");
          else if (is_cut)
            clusters_.merge(pair.a, pair.b);
          else
            merge_or_refuse(pair);
        }
  }

  void mark_stated_roots()
  {
    for (const Candidate& pair : stated_)
      for (const Index number : {pair.a, pair.b})
        stated_root_[number] = clusters_.root(number);
  }

  // Coinciding points ------------------------------------------------------------------------------------------------

  /// finds the faces that are sides of one cell only, looking at each zone alone, and their points.
  void collect_hull()
  {
    const internal::Element_blocks none;
    const auto number = [this](Index zone, Index point) { return numbering_.number(zone, point); };
    const internal::Face_table table(cells_, none, numbering_.size(), number);
    const auto lists = table.visit_groups<std::vector<Face_corners>>([&](const auto& group, auto& faces) {
      if (group.size() == 1)
        faces.push_back(table.corners(group.front().entry));
    });
    for (const auto& list : lists)
      for (const Face_corners& face : list)
      {
        hull_faces_.push_back(face);
        for (int c = 0; c < face.count; ++c)
          hull_.push_back(numbering_.number(face.zone, face.points[c]));
      }
    std::sort(hull_.begin(), hull_.end());
    hull_.erase(std::unique(hull_.begin(), hull_.end()), hull_.end());
  }

  void join_coinciding_points()
  {
    std::vector<Candidate> candidates = find_coinciding_points();
    prefer_common_faces(candidates);
    std::sort(candidates.begin(), candidates.end());
    for (const Candidate& pair : candidates)
      merge_or_refuse(pair);
  }

  std::vector<Candidate> find_coinciding_points() const
  {
    std::vector<Point> positions;
    std::vector<double> reach;
    for (const Index number : hull_)
    {
      positions.push_back(numbering_.position(number));
      const double edge = lengths(number).shortest;
      // Infinite: all edges here have length zero, so there is no length to be relative to.
      reach.push_back(std::isinf(edge) ? 0 : options_.tolerance * edge + std::min(slack(number), largest_slack * edge));
    }
    const internal::Neighbor_tree tree(positions);
    const auto lists = internal::for_each_run<std::vector<Candidate>>(
      static_cast<Index>(hull_.size()), [&](Index first, Index last, std::vector<Candidate>& found) {
        for (Index i = first; i < last; ++i)
          tree.visit_ball(positions[i], reach[i], [&](Index j) {
            if (hull_[i] < hull_[j] && numbering_.zone(hull_[i]) != numbering_.zone(hull_[j]) &&
                internal::squared_distance(positions[i], positions[j]) <= reach[j] * reach[j])
              found.push_back(candidate(hull_[i], hull_[j]));
          });
      });
    std::vector<Candidate> candidates;
    for (const auto& list : lists)
      candidates.insert(candidates.end(), list.begin(), list.end());
    return candidates;
  }

  /// Where two points of a zone coincide with one of another zone, position cannot choose; faces can.
  void prefer_common_faces(std::vector<Candidate>& candidates) const
  {
    internal::Point_clusters places(static_cast<Index>(hull_.size()));
    for (const Candidate& pair : candidates)
      places.merge(hull_number(pair.a), hull_number(pair.b));
    const std::vector<char> is_ambiguous = find_ambiguous(places);
    if (std::find(is_ambiguous.begin(), is_ambiguous.end(), 1) == is_ambiguous.end())
      return;
    const std::set<std::pair<Index, Index>> on_common_face = pairs_on_common_faces(places, is_ambiguous);
    for (Candidate& pair : candidates)
      pair.lacks_common_face = is_ambiguous[hull_number(pair.a)] && !on_common_face.contains({pair.a, pair.b});
  }

  /// per hull point: whether its place holds two points of one zone.
  std::vector<char> find_ambiguous(const internal::Point_clusters& places) const
  {
    std::vector<char> is_ambiguous(hull_.size(), 0);
    for (std::size_t i = 0; i < hull_.size(); ++i)
      for (Index j = places.next(static_cast<Index>(i)); j != static_cast<Index>(i) && !is_ambiguous[i];
           j = places.next(j))
        for (Index k = places.next(j); k != j && !is_ambiguous[i]; k = places.next(k))
          is_ambiguous[i] = numbering_.zone(hull_[j]) == numbering_.zone(hull_[k]);
    return is_ambiguous;
  }

  std::set<std::pair<Index, Index>> pairs_on_common_faces(const internal::Point_clusters& places,
                                                          const std::vector<char>& is_ambiguous) const
  {
    struct Placed_face
    {
      std::array<Index, 4> key;
      Index face;
    };
    std::vector<Placed_face> faces;
    for (std::size_t f = 0; f < hull_faces_.size(); ++f)
    {
      bool counts = false;
      std::array<Index, 4> at = {no_index, no_index, no_index, no_index};
      for (int c = 0; c < hull_faces_[f].count; ++c)
      {
        const Index i = hull_number(corner(hull_faces_[f], c));
        counts |= is_ambiguous[i] != 0;
        at[c] = places.root(i);
      }
      if (counts)
        faces.push_back({internal::face_key(at, hull_faces_[f].count).vertices, static_cast<Index>(f)});
    }
    std::sort(faces.begin(), faces.end(), [](const Placed_face& a, const Placed_face& b) {
      return std::tie(a.key, a.face) < std::tie(b.key, b.face);
    });
    std::set<std::pair<Index, Index>> pairs;
    for (std::size_t i = 0; i < faces.size(); ++i)
      for (std::size_t j = i + 1; j < faces.size() && faces[j].key == faces[i].key; ++j)
        if (hull_faces_[faces[i].face].zone != hull_faces_[faces[j].face].zone)
          add_corner_pairs(hull_faces_[faces[i].face], hull_faces_[faces[j].face], places, pairs);
    return pairs;
  }

  /// adds the pairs of the first way of laying `g` on `f` that puts every corner on its place. Going around matters
  /// where two corners of a face share a place (faces at the axis of a polar grid).
  void add_corner_pairs(const Face_corners& f, const Face_corners& g, const internal::Point_clusters& places,
                        std::set<std::pair<Index, Index>>& pairs) const
  {
    for (int way = 0; f.count == g.count && way < 2 * f.count; ++way)
    {
      bool fits = true;
      for (int c = 0; c < f.count && fits; ++c)
        fits = places.root(hull_number(corner(f, c))) ==
               places.root(hull_number(corner(g, partner_corner(f.count, way, c))));
      if (!fits)
        continue;
      for (int c = 0; c < f.count; ++c)
        pairs.insert(std::minmax(corner(f, c), corner(g, partner_corner(f.count, way, c))));
      return;
    }
  }

  // Both -------------------------------------------------------------------------------------------------------------

  Index corner(const Face_corners& face, int c) const { return numbering_.number(face.zone, face.points[c]); }

  Index hull_number(Index number) const { return std::lower_bound(hull_.begin(), hull_.end(), number) - hull_.begin(); }

  /// by how much round-off in the file may have moved a point.
  double slack(Index number) const
  {
    return (is_float32_[numbering_.zone(number)] ? float32_slack : float64_slack) *
           size_of(numbering_.position(number));
  }

  Candidate candidate(Index a, Index b) const
  {
    return {false, internal::squared_distance(numbering_.position(a), numbering_.position(b)), std::min(a, b),
            std::max(a, b)};
  }

  /// measures the edges at the points that may be joined.
  void measure_edges()
  {
    measured_ = hull_;
    for (const Candidate& pair : stated_)
      measured_.insert(measured_.end(), {pair.a, pair.b});
    std::sort(measured_.begin(), measured_.end());
    measured_.erase(std::unique(measured_.begin(), measured_.end()), measured_.end());
    lengths_.resize(measured_.size());
    if (measured_.empty())
      return;
    std::vector<Index> slot(static_cast<std::size_t>(numbering_.size()), no_index);
    for (std::size_t i = 0; i < measured_.size(); ++i)
      slot[measured_[i]] = static_cast<Index>(i);
    for (const Element_block& block : cells_.blocks())
      for (Index e = 0; e < block.section->size(); ++e)
        measure_cell(block, internal::corner_points(block, block.first + e), slot);
  }

  void measure_cell(const Element_block& block, const Index* points, const std::vector<Index>& slot)
  {
    const Reference_element& reference = reference_element(block.section->type);
    const std::vector<Point>& positions = mesh_.zones[block.zone].points;
    for (int e = 0; e < reference.edge_count; ++e)
    {
      const Index a = points[reference.edges[e][0]], b = points[reference.edges[e][1]];
      const Index slots[] = {slot[numbering_.number(block.zone, a)], slot[numbering_.number(block.zone, b)]};
      if (slots[0] == no_index && slots[1] == no_index)
        continue;
      const double length = std::sqrt(internal::squared_distance(positions[a], positions[b]));
      for (const Index s : slots)
        if (s != no_index && length > 0)
        {
          lengths_[s].shortest = std::min(lengths_[s].shortest, length);
          lengths_[s].longest = std::max(lengths_[s].longest, length);
        }
    }
  }

  const Edge_lengths& lengths(Index number) const
  {
    return lengths_[std::lower_bound(measured_.begin(), measured_.end(), number) - measured_.begin()];
  }

  void merge_or_refuse(const Candidate& pair)
  {
    if (clusters_.root(pair.a) == clusters_.root(pair.b))
      return;
    if (share_zone(pair.a, pair.b))
      refuse(pair, result_.pairs_refused_by_zone, "they coincide, but joining them would join two nodes of one zone");
    else
      clusters_.merge(pair.a, pair.b);
  }

  bool share_zone(Index a, Index b) const
  {
    Index p = a;
    do
    {
      Index q = b;
      do
      {
        if (numbering_.zone(p) == numbering_.zone(q))
          return true;
        q = clusters_.next(q);
      } while (q != b);
      p = clusters_.next(p);
    } while (p != a);
    return false;
  }

  void refuse(const Candidate& pair, Index& count, std::string_view reason)
  {
    ++count;
    if (result_.notes.size() < notes_kept)
      result_.notes.push_back(fmt::format("node {} of zone '{}' and node {} of zone '{}' were not joined: {} ({:.3g})",
                                          numbering_.point(pair.a) + 1, mesh_.zones[numbering_.zone(pair.a)].name,
                                          numbering_.point(pair.b) + 1, mesh_.zones[numbering_.zone(pair.b)].name,
                                          reason, std::sqrt(pair.squared_distance)));
  }

  Joined_zones number_vertices()
  {
    std::map<std::pair<Index, Index>, Joined_pair> pairs;
    Index number = 0;
    for (std::size_t z = 0; z < mesh_.zones.size(); ++z)
    {
      std::vector<Index> vertices(mesh_.zones[z].points.size());
      for (Index& vertex : vertices)
      {
        const Index root = clusters_.root(number);
        // Roots are the smallest of their clusters, so theirs are the zones that are numbered already.
        vertex = root == number ? result_.vertex_count++ : vertex_of(root, vertices, static_cast<Index>(z));
        count_pairs(number, pairs);
        ++number;
      }
      result_.vertex_of_point.push_back(std::move(vertices));
    }
    for (auto& [zones, pair] : pairs)
      result_.pairs.push_back(std::move(pair));
    return std::move(result_);
  }

  Index vertex_of(Index number, const std::vector<Index>& current, Index current_zone) const
  {
    const Index zone = numbering_.zone(number);
    return (zone == current_zone ? current : result_.vertex_of_point[zone])[numbering_.point(number)];
  }

  void count_pairs(Index number, std::map<std::pair<Index, Index>, Joined_pair>& pairs) const
  {
    for (Index other = clusters_.next(number); other != number; other = clusters_.next(other))
    {
      if (other > number)
        continue;
      const Index a = numbering_.zone(other), b = numbering_.zone(number);
      Joined_pair& pair = pairs[{a, b}];
      pair.zone_a = mesh_.zones[a].name;
      pair.zone_b = mesh_.zones[b].name;
      const auto stated_a = stated_root_.find(other), stated_b = stated_root_.find(number);
      const bool is_stated =
        stated_a != stated_root_.end() && stated_b != stated_root_.end() && stated_a->second == stated_b->second;
      ++(is_stated ? pair.points_by_connectivity : pair.points_by_geometry);
      pair.largest_gap =
        std::max(pair.largest_gap,
                 std::sqrt(internal::squared_distance(numbering_.position(other), numbering_.position(number))));
    }
  }

  const Volume_mesh& mesh_;
  const Join_options& options_;
  internal::Element_blocks cells_;
  Point_numbering numbering_;
  internal::Point_clusters clusters_;
  std::vector<char> is_float32_; ///< per zone
  std::vector<Candidate> stated_;
  std::map<Index, Index> stated_root_; ///< per point of an interface: its cluster before geometry was asked
  std::vector<Face_corners> hull_faces_;
  std::vector<Index> hull_;     ///< points on the hull of their zone, ascending
  std::vector<Index> measured_; ///< points whose edges are measured, ascending
  std::vector<Edge_lengths> lengths_;
  Joined_zones result_;
};

} // namespace

Joined_zones join_zones(const Volume_mesh& mesh, const Join_options& options)
{
  return Zone_joiner(mesh, options).join();
}

std::vector<Point> joined_points(const Volume_mesh& mesh, const Joined_zones& joined)
{
  bool matches = mesh.zones.size() == joined.vertex_of_point.size();
  for (std::size_t z = 0; z < mesh.zones.size() && matches; ++z)
    matches = mesh.zones[z].points.size() == joined.vertex_of_point[z].size();
  if (!matches)
    throw Input_error("the joined vertices are not those of the mesh: zones or points differ");
  std::vector<Point> points(static_cast<std::size_t>(joined.vertex_count));
  // Backwards, so that the first zone has the last word.
  for (std::size_t z = mesh.zones.size(); z-- > 0;)
    for (std::size_t n = mesh.zones[z].points.size(); n-- > 0;)
      points[joined.vertex_of_point[z][n]] = mesh.zones[z].points[n];
  return points;
}

} // namespace recurve
