// Meshes that were not made for this project; each test says so and passes where they are absent.
#include "support/feature_check.h"
#include "support/shared_data.h"

#include <recurve/io/cgns.h>
#include <recurve/mesh/boundary_surface.h>

#include <CGAL/boost/graph/IO/OFF.h>

#include <catch2/catch.hpp>

#include <cstdio>
#include <iostream>
#include <set>

using namespace recurve;
using namespace recurve::test;

namespace {

/// The boundary of a volume mesh with its features, and the names of the patches on the two sides of each edge.
struct Real_surface
{
  Boundary_surface surface;
  std::map<Boundary_surface::Face, std::string> patch_of;
  Feature_report report;

  explicit Real_surface(const std::filesystem::path& file)
  {
    Volume_mesh mesh = read_cgns(file);
    const Joined_zones joined = join_zones(mesh);
    const Boundary_faces boundary = find_boundary_faces(mesh, joined);
    surface = make_boundary_surface(mesh, joined, boundary, select_boundary(boundary));
    for (const auto f : surface.mesh.faces())
    {
      const Patch_face& listed = surface.face_patch[f];
      patch_of[f] = mesh.zones[listed.zone].patches[listed.patch].name;
    }
    report = detect({});
  }

  Feature_report detect(const Feature_options& options)
  {
    std::map<std::string, int> numbers;
    std::map<Boundary_surface::Face, int> number_of;
    for (const auto& [face, name] : patch_of)
      number_of[face] = numbers.try_emplace(name, static_cast<int>(numbers.size())).first->second;
    return detect_features(surface.mesh, surface.edge_is_critical, surface.vertex_is_sharp, options,
                           CGAL::parameters::edge_is_constrained_map(surface.edge_is_pinned)
                             .face_patch_map(boost::make_assoc_property_map(number_of)));
  }

  std::pair<std::string, std::string> patches_at(Boundary_surface::Edge e) const
  {
    return std::minmax(patch_of.at(surface.mesh.face(surface.mesh.halfedge(e, 0))),
                       patch_of.at(surface.mesh.face(surface.mesh.halfedge(e, 1))));
  }

  /// how many critical edges there are between patches (or inside one), and how many edges in all.
  std::pair<int, int> count(const std::string& first, const std::string& second) const
  {
    std::pair<int, int> n{0, 0};
    for (const auto e : surface.mesh.edges())
      if (patches_at(e) == std::pair<std::string, std::string>(std::minmax(first, second)))
      {
        n.first += surface.edge_is_critical[e] != 0;
        ++n.second;
      }
    return n;
  }
};

struct Precision_and_recall
{
  std::string text() const
  {
    char text[80];
    std::snprintf(text, sizeof text, "precision %.3f, recall %.3f", precision, recall);
    return text;
  }

  double precision, recall;
};

/// with all edges between different patches true, except between the pairs in `smooth`.
template <class IsTrue>
Precision_and_recall measure(const Real_surface& s, IsTrue is_true)
{
  double hits = 0, found = 0, truth = 0;
  for (const auto e : s.surface.mesh.edges())
  {
    const auto [a, b] = s.patches_at(e);
    const bool expected = a != b && is_true(a, b), is_critical = s.surface.edge_is_critical[e] != 0;
    hits += expected && is_critical;
    found += is_critical;
    truth += expected;
  }
  return {hits / found, hits / truth};
}

/// what thresholds of 20, 30 and 45 degrees would find; prints it, with what was detected, as a line each.
template <class IsTrue>
std::vector<Precision_and_recall> with_one_threshold(const char* name, Real_surface& s, IsTrue is_true)
{
  std::cout << name << ": " << measure(s, is_true).text() << '\n';
  std::vector<Precision_and_recall> results;
  for (const double threshold : {20., 30., 45.})
  {
    s.detect({.method = Feature_method::dihedral, .dihedral_angle = threshold});
    results.push_back(measure(s, is_true));
    std::cout << "  with a threshold of " << threshold << " degrees: " << results.back().text() << '\n';
  }
  return results;
}

std::optional<Real_surface> open(std::string_view name)
{
  const auto file = shared_data(name);
  return file ? std::optional<Real_surface>(*file) : std::nullopt;
}

} // namespace

TEST_CASE("real: a bolt, every edge where its CAD faces do not meet smoothly")
{
  auto s = open("surface/component8_tet.cgns");
  if (!s)
    return;
  // halves of round faces; all other faces of this part meet at 30 degrees or more, by the normals of its CAD model
  const std::set<std::pair<std::string, std::string>> smooth = {
    {"face_21", "face_4"}, {"face_15", "face_16"}, {"face_17", "face_18"}, {"face_19", "face_20"}};
  const auto is_true = [&](const std::string& a, const std::string& b) { return !smooth.contains({a, b}); };
  const auto [precision, recall] = measure(*s, is_true);
  CHECK(precision == 1);
  CHECK(recall == 1);
  for (const auto& single : with_one_threshold("component8", *s, is_true))
    CHECK((single.precision < 0.7 || single.recall < 0.9)); // no single threshold does both
}

TEST_CASE("real: a forged rod with coarse fillets, only its bores have edges")
{
  auto s = open("surface/linkrods_tet.cgns");
  if (!s)
    return;
  const std::set<std::pair<std::string, std::string>> sharp = {
    {"face_12", "face_3"}, {"face_12", "face_5"}, {"face_11", "face_8"}, {"face_10", "face_11"}};
  // by the normals of its CAD model, to 0.4 degrees; all others are fillets
  const auto is_true = [&](const std::string& a, const std::string& b) { return sharp.contains({a, b}); };
  // The mesh folds the small bore, a cylinder, along two lines from rim to rim, as steeply as its rims.
  const auto [precision, recall] = measure(*s, is_true);
  CHECK(precision == 1);
  CHECK(recall == 1);
  for (const auto& single : with_one_threshold("linkrods", *s, is_true))
    CHECK(single.precision < 0.4);
  s->detect({.smooth_patches = true});
  const auto known = measure(*s, is_true);
  CHECK(known.precision == 1);
  CHECK(known.recall == 1);
}

TEST_CASE("real: the M6 wing, trailing edge and root but nothing along the leading edge")
{
  for (const char* const name :
       {"wing/gmsh_om6_tet_coarse.cgns", "wing/gmsh_om6_hybrid_coarse.cgns", "wing/ugawg_om6_euler_adapted.cgns"})
  {
    const auto s = open(name);
    if (!s)
      return;
    CAPTURE(name);
    for (const auto& [a, b] :
         {std::pair{"te_lower", "te_upper"}, std::pair{"symmetry", "wing_upper"}, std::pair{"symmetry", "wing_lower"}})
    {
      const auto [found, all] = s->count(a, b);
      CHECK(all > 0);
      CHECK(found == all);
    }
    CHECK(s->count("wing_lower", "wing_upper").first == 0);
    for (const char* const patch : {"wing_lower", "wing_upper", "tip_lower", "tip_upper", "te_lower", "te_upper"})
      CHECK(s->count(patch, patch).first == 0);
  }
}

TEST_CASE("real: extruded aerofoils, the sharp trailing edge only")
{
  if (const auto s = open("blade/naca0012_lam_hybrid.cgns"))
  {
    CHECK(s->count("airfoil", "airfoil").first == 4); // the span has four cells
    CHECK(s->count("airfoil", "zmin") == std::pair{200, 200});
  }
  if (const auto s = open("blade/ls89_vki_blade_hex.cgns"))
  {
    CHECK(s->count("airfoil", "airfoil").first == 0);
    CHECK(s->count("airfoil", "zmax") == std::pair{240, 240});
  }
}

TEST_CASE("real: the sphere between two symmetry planes")
{
  const auto s = open("sphere/slice_2syms.cgns");
  if (!s)
    return;
  CHECK(s->count("wall", "wall").first == 0);
  CHECK(s->count("wall", "symmetry_left") == std::pair{18, 18});
}

TEST_CASE("real: fandisk, as triangles and as coarse quadrangles")
{
  for (const char* const name : {"surface/fandisk.off", "surface/fandisk_quads.off"})
  {
    const auto file = shared_data(name);
    if (!file)
      return;
    CAPTURE(name);
    Mesh mesh;
    REQUIRE(CGAL::IO::read_OFF(file->string(), mesh));
    auto critical = mesh.add_property_map<Mesh::Edge_index, bool>("c").first;
    auto steep = mesh.add_property_map<Mesh::Edge_index, bool>("d").first;
    auto sharp = mesh.add_property_map<Mesh::Vertex_index, bool>("s").first;
    detect_features(mesh, steep, sharp, {.method = Feature_method::dihedral, .dihedral_angle = 65});
    const auto report = detect_features(mesh, critical, sharp);
    for (const auto e : mesh.edges())
      CHECK((!steep[e] || critical[e]));
    // the part has two creases that fade out; and one that is shallow all along, where its step meets a plane: of 18 to
    // 19 degrees at each of its six edges
    int fading = 0;
    for (const auto& curve : report.curves)
    {
      if (curve.max_dihedral <= 65)
        CHECK((curve.edges == 6 && curve.max_dihedral > 18 && curve.max_dihedral < 20));
      fading += curve.first_end == Curve_end::terminus || curve.last_end == Curve_end::terminus;
    }
    CHECK(fading >= 1);
    CHECK(fading <= 2);
  }
}
