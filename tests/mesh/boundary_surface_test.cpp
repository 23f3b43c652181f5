#include <recurve/core/exceptions.h>
#include <recurve/mesh/boundary_surface.h>

#include <support/small_meshes.h>

#include <CGAL/boost/graph/helpers.h>

#include <catch2/catch.hpp>

#include <set>

using namespace recurve;
using Catch::Contains;

namespace {

using Selection = std::vector<std::vector<std::uint8_t>>;

struct Made
{
  Volume_mesh mesh;
  Joined_zones joined;
  Boundary_faces boundary;
  Boundary_surface surface;
};

/// makes the surface of the faces whose patch (its name) and place `is_wanted` accepts.
template <class Predicate>
Made make(Volume_mesh mesh, const Predicate& is_wanted)
{
  Made made{std::move(mesh), {}, {}, {}};
  made.joined = join_zones(made.mesh);
  made.boundary = find_boundary_faces(made.mesh, made.joined);
  Selection selection;
  for (std::size_t z = 0; z < made.mesh.zones.size(); ++z)
  {
    selection.emplace_back(made.boundary.owners[z].size(), std::uint8_t(0));
    for (const Patch& patch : made.mesh.zones[z].patches)
      for (const Index face : patch.faces)
        selection[z][face] = is_wanted(patch.name, place_of(made.boundary.owners[z][face]));
  }
  made.surface = make_boundary_surface(made.mesh, made.joined, made.boundary, selection);
  return made;
}

Made make_all(Volume_mesh mesh)
{
  return make(std::move(mesh), [](const std::string&, Face_place place) { return place == Face_place::boundary; });
}

/// corners of a face as joined vertices, walked from halfedge(f) on.
std::vector<Index> walk(const Boundary_surface& surface, Boundary_surface::Face f)
{
  std::vector<Index> vertices;
  for (const auto h : halfedges_around_face(halfedge(f, surface.mesh), surface.mesh))
    vertices.push_back(surface.joined_vertex[source(h, surface.mesh)]);
  return vertices;
}

/// the same from the owner.
std::vector<Index> owner_corners(const Made& made, Boundary_surface::Face f)
{
  const Cell_face owner = made.surface.face_owner[f];
  const Zone& zone = made.mesh.zones[owner.zone];
  const Section_entry entry = find_element(zone.cells, owner.cell);
  const Section& section = zone.cells[entry.section];
  const Reference_face& face = reference_element(section.type).faces[owner.face];
  const Index* const nodes = section.nodes.data() + entry.element * corner_count(section.type);
  std::vector<Index> vertices(static_cast<std::size_t>(face.corner_count));
  for (std::size_t c = 0; c < vertices.size(); ++c)
    vertices[c] = made.joined.vertex_of_point[owner.zone][nodes[face.corners[c]]];
  return vertices;
}

/// what must hold for every surface.
void check_surface(const Made& made)
{
  const auto& surface = made.surface;
  const auto& mesh = surface.mesh;
  CHECK(CGAL::is_valid_polygon_mesh(mesh));
  const std::vector<Point> points = joined_points(made.mesh, made.joined);
  Index previous = 0;
  for (const auto v : vertices(mesh))
  {
    const Point& x = points[surface.joined_vertex[v]];
    CHECK(mesh.point(v) == Boundary_surface::Mesh::Point(x[0], x[1], x[2]));
    CHECK(surface.joined_vertex[v] >= previous);
    previous = surface.joined_vertex[v];
    // CGAL's passes find borders through the vertex's own halfedge; and the ring around it must be all of its faces.
    bool touches_border = false;
    for (const auto h : halfedges_around_target(halfedge(v, mesh), mesh))
      touches_border |= is_border(h, mesh);
    CHECK(touches_border == is_border(halfedge(v, mesh), mesh));
  }
  Index corners = 0, ring_corners = 0;
  for (const auto f : faces(mesh))
  {
    CHECK(walk(surface, f) == owner_corners(made, f));
    corners += static_cast<Index>(degree(f, mesh));
    const Patch_face& listed = surface.face_patch[f];
    const Patch& patch = made.mesh.zones[listed.zone].patches[listed.patch];
    CHECK(std::binary_search(patch.faces.begin(), patch.faces.end(), listed.face));
  }
  for (const auto v : vertices(mesh))
    for (const auto h : halfedges_around_target(halfedge(v, mesh), mesh))
      ring_corners += !is_border(h, mesh);
  CHECK(ring_corners == corners);
  for (const auto e : edges(mesh))
  {
    if (is_border(e, mesh))
      CHECK(surface.edge_is_pinned[e]);
    CHECK_FALSE(surface.edge_is_critical[e]);
  }
}

Index count_pinned(const Boundary_surface& surface)
{
  Index count = 0;
  for (const auto e : edges(surface.mesh))
    count += surface.edge_is_pinned[e];
  return count;
}

Index euler_number(const Boundary_surface& surface)
{
  return static_cast<Index>(num_vertices(surface.mesh)) - static_cast<Index>(num_edges(surface.mesh)) +
         static_cast<Index>(num_faces(surface.mesh));
}

/// volume that the surface encloses, by the divergence theorem over fans of triangles: negative if it looks inward.
double enclosed_volume(const Boundary_surface& surface)
{
  double volume = 0;
  for (const auto f : faces(surface.mesh))
  {
    std::vector<Boundary_surface::Mesh::Point> x;
    for (const auto v : vertices_around_face(halfedge(f, surface.mesh), surface.mesh))
      x.push_back(surface.mesh.point(v));
    for (std::size_t c = 2; c < x.size(); ++c)
      volume += CGAL::determinant(x[0] - CGAL::ORIGIN, x[c - 1] - CGAL::ORIGIN, x[c] - CGAL::ORIGIN) / 6;
  }
  return volume;
}

/// unit cubes at the given places (their lowest corners) as one zone in which equal corners are one point.
Volume_mesh cubes_at(const std::vector<std::array<int, 3>>& places)
{
  Volume_mesh mesh;
  Zone& zone = mesh.zones.emplace_back();
  zone.name = "cubes";
  std::map<std::array<int, 3>, Index> point_at;
  for (const auto& place : places)
  {
    std::vector<Index> points;
    for (const auto& corner : reference_element(Element_type::hexahedron).corners)
    {
      const std::array<int, 3> x = {place[0] + corner[0], place[1] + corner[1], place[2] + corner[2]};
      const auto [entry, is_new] = point_at.emplace(x, static_cast<Index>(point_at.size()));
      if (is_new)
        zone.points.push_back({double(x[0]), double(x[1]), double(x[2])});
      points.push_back(entry->second);
    }
    test::add_cell(zone, Element_type::hexahedron, points);
  }
  return mesh;
}

/// adds the inner faces of a box whose centres `is_wanted` accepts as a patch, in the order and orientation they come.
template <class Predicate>
void add_inner_patch(Zone& zone, const std::string& name, const Predicate& is_wanted)
{
  std::vector<std::vector<Index>> faces;
  for (const auto& [key, face] : test::faces_of_cells(zone))
  {
    Point centre = {};
    for (const Index point : face.points)
      for (int axis = 0; axis < 3; ++axis)
        centre[axis] += zone.points[point][axis] / double(face.points.size());
    if (face.cells == 2 && is_wanted(centre))
      faces.push_back(face.points);
  }
  test::add_patch(zone, name, faces[0].size() == 3 ? Element_type::triangle : Element_type::quadrangle, faces);
}

} // namespace

TEST_CASE("the surface of a box is closed and looks outward", "[boundary_surface]")
{
  const unsigned seed = GENERATE(1u, 2u);
  for (const Element_type type : test::cell_types)
  {
    CAPTURE(element_name(type), seed);
    const Made made = make_all(test::relabelled(test::box(type, {.cubes = {3, 2, 2}}), seed));
    check_surface(made);
    const bool is_split = type == Element_type::tetrahedron;
    CHECK(num_faces(made.surface.mesh) == (is_split                      ? 64
                                           : type == Element_type::prism ? 2 * (6 + 4) + 6 * 2 * 2 - 6 - 6 + 12
                                                                         : 32));
    CHECK(num_vertices(made.surface.mesh) == 34); // 4 x 3 x 3 less the two inside
    CHECK(euler_number(made.surface) == 2);
    CHECK(enclosed_volume(made.surface) == Approx(1).epsilon(1e-12));
    CHECK(made.surface.report.components == 1);
    CHECK(made.surface.report.closed_components == 1);
    CHECK(made.surface.report.border_edges == 0);
    CHECK(made.surface.report.non_manifold_edges == 0);
    CHECK(made.surface.report.non_manifold_vertices == 0);
    CHECK(made.surface.report.notes.empty());
    CHECK(count_pinned(made.surface) == 0);
  }
}

TEST_CASE("the surface of cells of all types, and of two zones, is closed", "[boundary_surface]")
{
  SECTION("all types")
  {
    const Made made = make_all(test::mixed_box());
    check_surface(made);
    CHECK(euler_number(made.surface) == 2);
    CHECK(enclosed_volume(made.surface) == Approx(3));
  }
  SECTION("two zones: the interface is no part of it")
  {
    for (const Element_type type : test::cell_types)
    {
      const Made made = make_all(test::relabelled(test::two_zone_box(type, type, 3), 4));
      check_surface(made);
      CHECK(euler_number(made.surface) == 2);
      CHECK(enclosed_volume(made.surface) == Approx(2));
      CHECK(made.surface.report.closed_components == 1);
      CHECK(count_pinned(made.surface) == 0);
    }
  }
}

TEST_CASE("the border of a selection is pinned", "[boundary_surface]")
{
  const Made made = make(test::box(Element_type::hexahedron, {.cubes = {3, 3, 1}}),
                         [](const std::string& patch, Face_place) { return patch == "z_max"; });
  check_surface(made);
  CHECK(num_faces(made.surface.mesh) == 9);
  CHECK(made.surface.report.border_edges == 12);
  CHECK(made.surface.report.closed_components == 0);
  CHECK(count_pinned(made.surface) == 12);
  for (const auto f : faces(made.surface.mesh))
    CHECK(made.mesh.zones[0].patches[made.surface.face_patch[f].patch].name == "z_max");
}

TEST_CASE("nothing selected is an empty surface", "[boundary_surface]")
{
  const Made made = make(test::box(Element_type::hexahedron), [](const std::string&, Face_place) { return false; });
  check_surface(made);
  CHECK(num_vertices(made.surface.mesh) == 0);
  CHECK(made.surface.report.components == 0);
}

TEST_CASE("bodies that share an edge come apart there", "[boundary_surface]")
{
  const Made made = make_all(cubes_at({{0, 0, 0}, {1, 1, 0}}));
  check_surface(made);
  CHECK(num_vertices(made.surface.mesh) == 16);
  CHECK(num_edges(made.surface.mesh) == 24);
  CHECK(made.surface.report.components == 2);
  CHECK(made.surface.report.closed_components == 2);
  CHECK(made.surface.report.non_manifold_edges == 1);
  CHECK(made.surface.report.non_manifold_vertices == 2);
  CHECK(made.surface.report.border_edges == 0);
  CHECK(count_pinned(made.surface) == 2); // both edges of the graph that stand on it
  REQUIRE(made.surface.report.notes.size() == 3);
  CHECK_THAT(made.surface.report.notes[0], Contains("4 faces") && Contains("(1, 1, 0)") && Contains("(1, 1, 1)"));
  CHECK_THAT(made.surface.report.notes[1], Contains("non-manifold vertex") && Contains("(1, 1, "));
}

TEST_CASE("bodies that share a vertex come apart there", "[boundary_surface]")
{
  const Made made = make_all(cubes_at({{0, 0, 0}, {1, 1, 1}}));
  check_surface(made);
  CHECK(num_vertices(made.surface.mesh) == 16);
  CHECK(made.surface.report.closed_components == 2);
  CHECK(made.surface.report.non_manifold_edges == 0);
  CHECK(made.surface.report.non_manifold_vertices == 1);
  CHECK(count_pinned(made.surface) == 0);
  CHECK_THAT(made.surface.report.notes.at(0), Contains("(1, 1, 1)"));
}

TEST_CASE("a body that touches itself stays a manifold", "[boundary_surface]")
{
  SECTION("a ring closed by an edge")
  {
    const Made made = make_all(cubes_at({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 2, 0}, {0, 2, 0}, {0, 1, 0}}));
    check_surface(made);
    CHECK(made.surface.report.non_manifold_edges == 1);
    CHECK(enclosed_volume(made.surface) == Approx(7));
  }
  SECTION("a cube with a void that reaches its surface in an edge")
  {
    std::vector<std::array<int, 3>> places;
    for (int k = 0; k < 3; ++k)
      for (int j = 0; j < 3; ++j)
        for (int i = 0; i < 3; ++i)
          if (std::array{i, j, k} != std::array{1, 1, 1} && std::array{i, j, k} != std::array{0, 0, 1})
            places.push_back({i, j, k});
    const Made made = make_all(cubes_at(places));
    check_surface(made);
    CHECK(made.surface.report.non_manifold_edges == 1);
    CHECK(enclosed_volume(made.surface) == Approx(25));
  }
}

TEST_CASE("a sheet inside the volume is one-sided and consistent", "[boundary_surface]")
{
  const Element_type type = GENERATE(Element_type::hexahedron, Element_type::tetrahedron);
  const unsigned seed = GENERATE(1u, 2u, 3u);
  CAPTURE(seed);
  Volume_mesh mesh = test::box(type, {.cubes = {4, 4, 4}});
  add_inner_patch(mesh.zones[0], "sheet", [](const Point& x) {
    return x[2] == 0.5 && x[0] > 0.25 && x[0] < 0.75 && x[1] > 0.25 && x[1] < 0.75;
  });
  const Made made = make(test::relabelled(mesh, seed), [](const std::string&, Face_place) { return true; });
  check_surface(made);
  CHECK(made.surface.report.components == 2);
  CHECK(made.surface.report.closed_components == 1);
  CHECK(made.surface.report.border_edges == 8);
  CHECK(made.surface.report.non_manifold_edges == 0);
  CHECK(made.surface.report.non_manifold_vertices == 0);
  CHECK(count_pinned(made.surface) == 8);
  std::set<bool> looks_up;
  for (const auto f : faces(made.surface.mesh))
    if (made.mesh.zones[0].patches[made.surface.face_patch[f].patch].name == "sheet")
    {
      const auto h = halfedge(f, made.surface.mesh);
      const auto& x = made.surface.mesh.point(source(h, made.surface.mesh));
      const auto& y = made.surface.mesh.point(target(h, made.surface.mesh));
      const auto& z = made.surface.mesh.point(target(next(h, made.surface.mesh), made.surface.mesh));
      looks_up.insert(CGAL::cross_product(y - x, z - x).z() > 0);
    }
  CHECK(looks_up.size() == 1);
}

TEST_CASE("a sheet that ends at the wall leaves the wall whole", "[boundary_surface]")
{
  Volume_mesh mesh = test::box(Element_type::hexahedron, {.cubes = {2, 2, 2}});
  add_inner_patch(mesh.zones[0], "sheet", [](const Point& x) { return x[2] == 0.5; });
  const Made made = make(mesh, [](const std::string&, Face_place) { return true; });
  check_surface(made);
  CHECK(num_faces(made.surface.mesh) == 24 + 4);
  CHECK(made.surface.report.components == 2);
  CHECK(made.surface.report.closed_components == 1);
  CHECK(made.surface.report.non_manifold_edges == 8); // T-junctions all around
  CHECK(made.surface.report.non_manifold_vertices == 8);
  CHECK(made.surface.report.border_edges == 0);
  CHECK(count_pinned(made.surface) == 16);
}

TEST_CASE("sheets that cross come apart along the line", "[boundary_surface]")
{
  Volume_mesh mesh = test::box(Element_type::hexahedron, {.cubes = {4, 4, 4}});
  add_inner_patch(mesh.zones[0], "flat", [](const Point& x) { return x[2] == 0.5; });
  add_inner_patch(mesh.zones[0], "upright", [](const Point& x) { return x[1] == 0.5; });
  const Made made =
    make(mesh, [](const std::string& patch, Face_place) { return patch == "flat" || patch == "upright"; });
  check_surface(made);
  CHECK(num_faces(made.surface.mesh) == 32);
  CHECK(made.surface.report.non_manifold_edges == 4);
  CHECK(made.surface.report.non_manifold_vertices == 5);
}

TEST_CASE("an interface that both zones list is taken once, from one side", "[boundary_surface]")
{
  Volume_mesh mesh = test::two_zone_box(Element_type::tetrahedron, Element_type::tetrahedron, 3);
  for (Zone& zone : mesh.zones)
    test::add_hull_patches(zone, [](const Point& x) { return x[0] == 1 ? "seam" : ""; });
  const Made made =
    make(test::relabelled(mesh, 9), [](const std::string& patch, Face_place) { return patch == "seam"; });
  check_surface(made);
  CHECK(num_faces(made.surface.mesh) == 18);
  CHECK(made.surface.report.repeated_faces == 18);
  CHECK(made.surface.report.components == 1);
  CHECK(made.surface.report.border_edges == 12);
  for (const auto f : faces(made.surface.mesh))
    CHECK(made.surface.face_owner[f].zone == 0);
}

TEST_CASE("an interface that each zone lists in part looks one way", "[boundary_surface]")
{
  Volume_mesh mesh = test::two_zone_box(Element_type::hexahedron, Element_type::hexahedron, 4);
  test::add_hull_patches(mesh.zones[0], [](const Point& x) { return x[0] == 1 && x[1] < 0.5 ? "seam" : ""; });
  test::add_hull_patches(mesh.zones[1], [](const Point& x) { return x[0] == 1 && x[1] > 0.5 ? "seam" : ""; });
  const Made made = make(mesh, [](const std::string& patch, Face_place) { return patch == "seam"; });
  check_surface(made);
  CHECK(num_faces(made.surface.mesh) == 16);
  CHECK(made.surface.report.turned_faces == 8);
  CHECK(made.surface.report.components == 1);
  CHECK(made.surface.report.non_manifold_edges == 0);
}

TEST_CASE("the maps follow a surface that is moved", "[boundary_surface]")
{
  Made made = make_all(test::box(Element_type::hexahedron));
  const std::vector<Index> before = walk(made.surface, Boundary_surface::Face(3));
  std::vector<Boundary_surface> kept;
  kept.push_back(std::move(made.surface));
  kept.emplace_back();
  kept.emplace_back();
  CHECK(walk(kept[0], Boundary_surface::Face(3)) == before);
  kept[0].edge_is_critical[Boundary_surface::Edge(5)] = 1;
  CHECK(kept[0].edge_is_critical[Boundary_surface::Edge(5)] == 1);
}

TEST_CASE("a selection of another mesh is refused", "[boundary_surface]")
{
  Volume_mesh mesh = test::box(Element_type::hexahedron);
  const Joined_zones joined = join_zones(mesh);
  const Boundary_faces boundary = find_boundary_faces(mesh, joined);
  Selection selection = select_boundary(boundary);
  CHECK_NOTHROW(make_boundary_surface(mesh, joined, boundary, selection));
  selection[0].pop_back();
  CHECK_THROWS_AS(make_boundary_surface(mesh, joined, boundary, selection), Input_error);
  selection.clear();
  CHECK_THROWS_AS(make_boundary_surface(mesh, joined, boundary, selection), Input_error);
  CHECK_THROWS_AS(make_boundary_surface(mesh, {}, boundary, select_boundary(boundary)), Input_error);
}
