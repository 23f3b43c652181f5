#include "certify.h"

#include "mesh_cells.h"
#include "validity_json.h"

#include <recurve/volume/restore_validity.h>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <numeric>

namespace recurve {

namespace {

constexpr std::size_t listed_cells = 20;

/// where the straight-sided mesh has all nodes, from the corners. Elements that share a node agree to the bit.
std::vector<Point> straight_positions(const Curved_mesh& mesh, const Mesh_cells& cells)
{
  std::vector<Point> result = mesh.nodes; // also the points of no cell
  for (const Element_block& block : cells.blocks)
  {
    const auto stride = static_cast<std::size_t>(node_count(block.type, mesh.degree));
    const tbb::blocked_range<std::size_t> all(0, block.nodes.size() / stride);
    tbb::parallel_for(all, [&](const tbb::blocked_range<std::size_t>& range) {
      std::array<Point, node_count(Element_type::hexahedron, max_degree)> positions;
      for (std::size_t e = range.begin(); e < range.end(); ++e)
      {
        const auto nodes = block.nodes.subspan(e * stride, stride);
        straight_nodes(block.type, mesh.degree, nodes, mesh.nodes, std::span(positions).first(stride));
        for (std::size_t m = 0; m < stride; ++m)
          for (std::size_t d = 0; d < 3; ++d)
            std::atomic_ref(result[static_cast<std::size_t>(nodes[m])][d])
              .store(positions[m][d], std::memory_order_relaxed);
      }
    });
  }
  return result;
}

double length(const Point& v)
{
  return std::hypot(v[0], v[1], v[2]);
}

Point cross(const Point& a, const Point& b, const Point& c)
{
  const Point u = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
  return {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
}

/// One certification: its steps share the mesh and the result.
class Certifying
{
public:
  Certifying(Curved_mesh& mesh, std::span<const Node_state> states, const Face_selection& is_boundary,
             std::span<const Periodic_nodes> periodic, const Restoration_options& options)
    : mesh_(mesh), states_(states), is_boundary_(is_boundary), options_(options), cells_(mesh)
  {
    for (const Periodic_nodes& nodes : periodic)
    {
      linked_.insert(linked_.end(), nodes.pairs.begin(), nodes.pairs.end());
      periods_.resize(linked_.size(), &nodes.period);
    }
    result_.bounds = Cell_bounds(cells_.count);
  }

  Certification run(const Progress_callback& progress)
  {
    straight_ = straight_positions(mesh_, cells_);
    find_displaced();
    find_roles();
    node_factors_.resize(mesh_.nodes.size());
    Step_counter steps(progress, "certify", 2 * cells_.count);
    result_.restoration = restore_validity(mesh_.nodes, straight_, cells_.blocks, mesh_.degree, about_nodes(), options_,
                                           [&](Index block, Index element, const Jacobian_bounds& bounds) {
                                             const auto n = static_cast<std::size_t>(cells_.number(block, element));
                                             result_.bounds.scaled[n] = bounds.scaled;
                                             result_.bounds.verdicts[n] = bounds.verdict;
                                             steps.count();
                                           });
    result_.is_checked = true;
    result_.excluded = described(result_.restoration.excluded);
    result_.uncertified = described(result_.restoration.uncertified);
    result_.worst = describe_cells(mesh_, result_.bounds, worst_cells(result_.bounds, listed_cells));
    find_factors();
    measure_faces();
    return std::move(result_);
  }

private:
  Restoration_nodes about_nodes()
  {
    Restoration_nodes about{roles_, linked_, node_factors_};
    about.image = [this](std::size_t pair, const Point& position) {
      const auto& [node, image] = linked_[pair];
      return periodic_position(*periods_[pair], straight_[static_cast<std::size_t>(node)],
                               straight_[static_cast<std::size_t>(image)], position);
    };
    return about;
  }

  /// the nodes that were displaced before anything was given up.
  void find_displaced()
  {
    is_displaced_.resize(mesh_.nodes.size());
    for (std::size_t n = 0; n < is_displaced_.size(); ++n)
      is_displaced_[n] = mesh_.nodes[n] != straight_[n];
  }

  void find_roles()
  {
    roles_.assign(mesh_.nodes.size(), Node_role::inside);
    for_each_face([&](std::size_t zone, Index face, Element_type, std::span<const Index> nodes) {
      if (is_boundary_[zone][static_cast<std::size_t>(face)] != 0)
        for (const Index node : nodes)
          roles_[static_cast<std::size_t>(node)] = Node_role::follower;
    });
    for (std::size_t n = 0; n < states_.size(); ++n)
      if (states_[n] == Node_state::placed)
        roles_[n] = Node_role::surface;
  }

  /// calls visit(zone, face of the zone, type, nodes) for each face of all zones.
  template <class Visit>
  void for_each_face(const Visit& visit) const
  {
    for (std::size_t z = 0; z < mesh_.zones.size(); ++z)
    {
      Index face = 0;
      for (const Curved_section& section : mesh_.zones[z].faces)
      {
        const auto stride = static_cast<std::size_t>(node_count(section.type, mesh_.degree));
        for (std::size_t first = 0; first < section.nodes.size(); first += stride)
          visit(z, face++, section.type, std::span<const Index>(section.nodes).subspan(first, stride));
      }
    }
  }

  std::vector<Cell_verdict> described(const std::vector<Block_element>& list) const
  {
    std::vector<Index> numbers;
    numbers.reserve(list.size());
    for (const Block_element& cell : list)
      numbers.push_back(cells_.number(cell.block, cell.element));
    return describe_cells(mesh_, result_.bounds, numbers);
  }

  /// the smallest factor of a displaced node.
  double factor_of(std::span<const Index> nodes) const
  {
    double factor = 1;
    for (const Index node : nodes)
      if (is_displaced_[static_cast<std::size_t>(node)] != 0)
        factor = std::min(factor, node_factors_[static_cast<std::size_t>(node)]);
    return factor;
  }

  void find_factors()
  {
    result_.factors.reserve(static_cast<std::size_t>(cells_.count));
    for (const Element_block& block : cells_.blocks)
    {
      const auto stride = static_cast<std::size_t>(node_count(block.type, mesh_.degree));
      for (std::size_t first = 0; first < block.nodes.size(); first += stride)
        result_.factors.push_back(factor_of(block.nodes.subspan(first, stride)));
    }
  }

  /// a quadrangle counts as the two triangles of a diagonal.
  double area(std::span<const Index> corners) const
  {
    const auto at = [&](std::size_t c) { return straight_[static_cast<std::size_t>(corners[c])]; };
    double sum = length(cross(at(0), at(1), at(2))) / 2;
    if (corners.size() == 4)
      sum += length(cross(at(0), at(2), at(3))) / 2;
    return sum;
  }

  /// A face inside the mesh that two zones list counts twice, as both its sides are boundaries of something.
  void measure_faces()
  {
    patch_of_face_.clear();
    for_each_face([&](std::size_t zone, Index face, Element_type type, std::span<const Index> nodes) {
      const auto is_curved = [&](Index node) {
        return roles_[static_cast<std::size_t>(node)] == Node_role::surface &&
               is_displaced_[static_cast<std::size_t>(node)] != 0;
      };
      // Corners are never displaced: a face on a curved patch has all nodes inside its edges on the surface.
      const auto inner = nodes.subspan(static_cast<std::size_t>(corner_count(type)));
      const auto is_on_surface = [&](Index node) {
        return roles_[static_cast<std::size_t>(node)] == Node_role::surface;
      };
      if (!std::ranges::all_of(inner, is_on_surface) || std::ranges::none_of(inner, is_curved))
        return;
      const auto corners = nodes.first(static_cast<std::size_t>(corner_count(type)));
      const double own_area = area(corners);
      ++result_.curved_faces;
      result_.curved_area += own_area;
      if (const double factor = factor_of(nodes); factor == 1)
        result_.full_area += own_area;
      else
        result_.reduced_faces.push_back(reduced_face(zone, face, corners, factor));
    });
  }

  Reduced_face reduced_face(std::size_t zone, Index face, std::span<const Index> corners, double factor)
  {
    Reduced_face result{mesh_.linear.zones[zone].name, patch_name(zone, face), face, {}, factor};
    for (const Index corner : corners)
      for (std::size_t d = 0; d < 3; ++d)
        result.center[d] += straight_[static_cast<std::size_t>(corner)][d] / static_cast<double>(corners.size());
    return result;
  }

  std::string patch_name(std::size_t zone, Index face)
  {
    const Zone& linear = mesh_.linear.zones[zone];
    if (patch_of_face_.empty())
      patch_of_face_.resize(mesh_.zones.size());
    std::vector<Index>& patches = patch_of_face_[zone];
    if (patches.empty())
    {
      patches.assign(static_cast<std::size_t>(linear.face_count()), no_index);
      for (std::size_t p = 0; p < linear.patches.size(); ++p)
        for (const Index f : linear.patches[p].faces)
          patches[static_cast<std::size_t>(f)] = static_cast<Index>(p);
    }
    const Index patch = patches[static_cast<std::size_t>(face)];
    return patch == no_index ? "" : linear.patches[static_cast<std::size_t>(patch)].name;
  }

  Curved_mesh& mesh_;
  std::span<const Node_state> states_;
  const Face_selection& is_boundary_;
  const Restoration_options& options_;
  Mesh_cells cells_;
  std::vector<std::array<Index, 2>> linked_;
  std::vector<const Period*> periods_; ///< per linked pair
  std::vector<Point> straight_;
  std::vector<std::uint8_t> is_displaced_;
  std::vector<Node_role> roles_;
  std::vector<double> node_factors_;
  std::vector<std::vector<Index>> patch_of_face_; ///< per zone; made when needed
  Certification result_;
};

// Reports stay readable; the totals are complete.
constexpr std::size_t listed_faces = 1000;
constexpr std::size_t listed_verdicts = 100;

template <class T>
std::vector<T> first_of(const std::vector<T>& list, std::size_t count)
{
  return {list.begin(), list.begin() + static_cast<std::ptrdiff_t>(std::min(count, list.size()))};
}

Json json_of_faces(const std::vector<Reduced_face>& faces)
{
  Json json = Json::array();
  for (const Reduced_face& face : first_of(faces, listed_faces))
    json.push_back({{"zone", face.zone},
                    {"patch", face.patch},
                    {"face", face.face},
                    {"center", face.center},
                    {"factor", face.factor}});
  return json;
}

} // namespace

Certification certify_and_restore(Curved_mesh& mesh, std::span<const Node_state> states,
                                  const Face_selection& is_boundary, std::span<const Periodic_nodes> periodic,
                                  const Restoration_options& options, const Progress_callback& progress)
{
  return Certifying(mesh, states, is_boundary, periodic, options).run(progress);
}

std::vector<Cell_field> cell_fields(const Certification& certification)
{
  if (!certification.is_checked)
    return {};
  std::vector<Cell_field> fields = cell_fields(certification.bounds);
  fields.push_back({"curving_factor", certification.factors});
  return fields;
}

Json json_of(const Certification& certification)
{
  if (!certification.is_checked)
    return {{"is_checked", false}};
  const Restoration_report& report = certification.restoration;
  Json factors = Json::array();
  for (std::size_t level = 0; level < curving_factors.size(); ++level)
    factors.push_back({{"factor", curving_factors[level]}, {"nodes", report.nodes_of_level[level]}});
  const auto cells = static_cast<Index>(certification.bounds.verdicts.size());
  const auto excluded = static_cast<Index>(certification.excluded.size());
  return {{"is_checked", true},
          {"is_certified", certification.is_certified()},
          {"promised_cells", cells - excluded},
          {"excluded_cells", excluded},
          {"uncertified_cells", certification.uncertified.size()},
          {"share_at_full_curvature", certification.full_share()},
          {"curved_faces", certification.curved_faces},
          {"reduced_faces", certification.reduced_faces.size()},
          {"curved_area", certification.curved_area},
          {"area_at_full_curvature", certification.full_area},
          {"failing_cells", report.failing_cells},
          {"repaired_cells", report.repaired_cells},
          {"repaired_nodes", report.repaired_nodes},
          {"reduced_cells", report.reduced_cells},
          {"rounds", report.rounds},
          {"factors", std::move(factors)},
          {"before_curving", json_of(report.straight)},
          {"after_deformation", json_of(report.deformed)},
          {"after_restoration", json_of(report.restored)},
          {"worst_cells", json_of(certification.worst)},
          {"first_excluded_cells", json_of(first_of(certification.excluded, listed_verdicts))},
          {"first_uncertified_cells", json_of(first_of(certification.uncertified, listed_verdicts))},
          {"first_reduced_faces", json_of_faces(certification.reduced_faces)}};
}

} // namespace recurve
