#include "surface/test_surfaces.h"
#include "surface/transformations.h"

#include <recurve/surface/reconstruct_surface.h>

#include <CGAL/boost/graph/properties.h>
#include <boost/property_map/property_map.hpp>
#include <catch2/catch.hpp>
#include <tbb/global_control.h>

#include <cmath>
#include <limits>
#include <numeric>

using namespace recurve;
using namespace test_surfaces;

namespace {

constexpr std::uint32_t seed = 2018;

struct Reconstruction
{
  std::vector<Local_fit> fits; ///< in the order of the faces
  Reconstruction_report report;
};

template <class NamedParameters = No_parameters, class Policies = Paper_policies>
Reconstruction reconstruct(const Mesh& mesh, int degree, const NamedParameters& params = no_parameters,
                           const Policies& policies = {})
{
  Reconstruction result;
  result.fits.resize(mesh.number_of_faces());
  const auto map = boost::make_iterator_property_map(result.fits.begin(), get(boost::face_index, mesh));
  result.report = reconstruct_surface(mesh, map, {.degree = degree}, params, policies);
  return result;
}

bool is_equal(const Local_fit& a, const Local_fit& b)
{
  return a.origin == b.origin && a.u == b.u && a.v == b.v && a.n == b.n && a.scale == b.scale && a.degree == b.degree &&
         a.coefficients == b.coefficients;
}

bool is_equal(const std::vector<Local_fit>& a, const std::vector<Local_fit>& b)
{
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const Local_fit& x, const Local_fit& y) { return is_equal(x, y); });
}

/// a grid with inner points moved about within the plane.
Polygons rough_plane(int n, bool is_triangulated)
{
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-0.3, 0.3);
  Polygons plane = grid(n, n, 1, 1, [](double, double) { return 0.0; });
  for (int j = 1; j < n; ++j)
    for (int i = 1; i < n; ++i)
    {
      Point& x = plane.points[static_cast<std::size_t>(i + j * (n + 1))];
      x[0] += uniform(random) / n;
      x[1] += uniform(random) / n;
    }
  return is_triangulated ? split_quads(plane) : plane;
}

Polygons rough_sphere(int level)
{
  Polygons sphere = icosphere(level);
  perturb_sphere(sphere, 0.15 * 1.1 / (1 << level), seed);
  return sphere;
}

/// the polynomial surface z = P(x, y) of degree `degree` with random coefficients, through z = 0 at the three corners
/// of face 0 of the triangulation, so that this face's tangent plane is z = 0.
struct Polynomial_surface
{
  int degree;
  std::array<double, 28> coefficients = {};
  std::array<Point, 3> corners = {};
  Point plane = {}; ///< linear polynomial to subtract

  Polynomial_surface(int d, const std::array<Point, 3>& face, std::mt19937& random) : degree(d), corners(face)
  {
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (int m = 0; m < coefficient_count(degree); ++m)
      coefficients[static_cast<std::size_t>(m)] = uniform(random);
    const double x1 = face[1][0] - face[0][0], y1 = face[1][1] - face[0][1];
    const double x2 = face[2][0] - face[0][0], y2 = face[2][1] - face[0][1];
    const double z1 = raw(face[1][0], face[1][1]) - raw(face[0][0], face[0][1]);
    const double z2 = raw(face[2][0], face[2][1]) - raw(face[0][0], face[0][1]);
    const double determinant = x1 * y2 - x2 * y1;
    plane = {raw(face[0][0], face[0][1]), (z1 * y2 - z2 * y1) / determinant, (x1 * z2 - x2 * z1) / determinant};
  }

  double raw(double x, double y) const
  {
    double sum = 0;
    for (int j = 0; j <= degree; ++j)
      for (int k = 0; j + k <= degree; ++k)
        sum += coefficients[static_cast<std::size_t>(coefficient_number(j, k))] * std::pow(x, j) * std::pow(y, k);
    return 0.3 * sum;
  }

  double operator()(double x, double y) const
  {
    return raw(x, y) - plane[0] - plane[1] * (x - corners[0][0]) - plane[2] * (y - corners[0][1]);
  }
};

} // namespace

TEST_CASE("a polynomial surface is reproduced over its tangent plane", "[reconstruct_surface]")
{
  std::mt19937 random(seed);
  const int degree = GENERATE(1, 2, 3, 4, 5, 6);
  CAPTURE(degree, seed);
  Polygons surface = rough_plane(14, true);
  const std::size_t face = 2 * (7 + 7 * 14);
  std::array<Point, 3> corners = {};
  for (std::size_t i = 0; i < 3; ++i)
    corners[i] = surface.points[static_cast<std::size_t>(surface.faces[face][i])];
  const Polynomial_surface exact(degree, corners, random);
  double largest_height = 0;
  for (Point& x : surface.points)
  {
    x[2] = exact(x[0], x[1]);
    largest_height = std::max(largest_height, std::abs(x[2]));
  }
  if (degree == 1)
    largest_height = 1; // a plane: heights are round-off
  const Mesh mesh = make_mesh(surface);
  const auto error_of = [&](const Local_fit& fit) {
    double error = 0;
    for (const double s : {-1.0, 0.0, 0.4, 1.0})
      for (const double t : {-0.7, 0.0, 0.9})
      {
        const Point x = fit.point(s * fit.scale, t * fit.scale);
        error = std::max(error, std::abs(x[2] - exact(x[0], x[1])));
      }
    return error;
  };
  CHECK(error_of(reconstruct(mesh, degree).fits[face]) < 1e-6 * largest_height);
  // Solved further, the rest is round-off.
  const Reconstruction_policies<> exact_policies{.solver = {.relative_bound = 1e-14}};
  CHECK(error_of(reconstruct(mesh, degree, no_parameters, exact_policies).fits[face]) < 1e-11 * largest_height);
}

TEST_CASE("a planar surface has exactly flat fits", "[reconstruct_surface]")
{
  const bool is_triangulated = GENERATE(true, false);
  const double scale = GENERATE(1e-6, 1.0, 1e6);
  const double offset = GENERATE(0.0, 1e3, 1e6);
  const int degree = GENERATE(1, 2, 4, 6);
  CAPTURE(is_triangulated, scale, offset, degree, seed);
  Polygons plane = rough_plane(10, is_triangulated);
  const Rotation rotation = random_rotation(seed);
  for (Point& x : plane.points)
    x = moved(rotated(rotation, scaled(scale, x)), {offset * scale, -offset * scale, 0.7 * offset * scale});
  const Reconstruction result = reconstruct(make_mesh(plane), degree);
  CHECK(result.report.planar_faces == result.report.faces);
  CHECK(result.report.lowered_faces == 0);
  CHECK(result.report.faces_of_degree[0] == result.report.faces);
  for (const Local_fit& fit : result.fits)
  {
    CHECK(fit.is_flat());
    CHECK(fit.coefficients == std::array<double, 28>{});
  }
}

TEST_CASE("a shallow bend is not taken for a plane", "[reconstruct_surface]")
{
  // The sagitta of a face is a hundred times the resolution of its coordinates.
  const double resolution = std::numeric_limits<double>::epsilon();
  const Mesh mesh =
    make_mesh(grid(10, 10, 1, 1, [&](double x, double y) { return 1e5 * resolution * (x * x + x * y - y * y); }));
  CHECK(reconstruct(mesh, 2).report.planar_faces == 0);
}

TEST_CASE("faces on both sides of a crease keep apart", "[reconstruct_surface]")
{
  Polygons roof = rough_plane(8, true);
  for (int j = 0; j <= 8; ++j)
    roof.points[static_cast<std::size_t>(4 + 9 * j)][0] = 0.5;
  for (Point& x : roof.points)
    x[2] = -0.3 * std::abs(x[0] - 0.5);
  Mesh mesh = make_mesh(roof);
  const auto is_critical = mesh.add_property_map<Mesh::Edge_index, bool>("e:critical", false).first;
  for (const auto e : mesh.edges())
    is_critical[e] = mesh.point(mesh.vertex(e, 0)).x() == 0.5 && mesh.point(mesh.vertex(e, 1)).x() == 0.5;
  const Reconstruction kept = reconstruct(mesh, 3, CGAL::parameters::edge_is_constrained_map(is_critical));
  CHECK(kept.report.planar_faces == kept.report.faces);
  CHECK(reconstruct(mesh, 3).report.planar_faces < kept.report.faces);
}

TEST_CASE("a cylinder beside its flat lid", "[reconstruct_surface]")
{
  // The rim is critical: the lid stays exactly flat, and the wall, with normals of its own side, finds the cylinder.
  constexpr int around = 32, up = 8;
  Polygons can;
  for (int j = 0; j <= up; ++j)
    for (int i = 0; i < around; ++i)
    {
      const double angle = 2 * std::numbers::pi * (i + 0.5 * (j % 2)) / around;
      can.points.push_back({std::cos(angle), std::sin(angle), 0.2 * j});
    }
  const int centre = static_cast<int>(can.points.size());
  can.points.push_back({0, 0, 0.2 * up});
  const auto at = [&](int i, int j) { return i % around + j * around; };
  for (int j = 0; j < up; ++j)
    for (int i = 0; i < around; ++i)
      can.faces.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
  for (int i = 0; i < around; ++i)
    can.faces.push_back({at(i, up), at(i + 1, up), centre});
  Mesh mesh = make_mesh(can);
  const auto is_critical = mesh.add_property_map<Mesh::Edge_index, bool>("e:critical", false).first;
  for (const auto e : mesh.edges())
    is_critical[e] = int(mesh.vertex(e, 0)) / around == up && int(mesh.vertex(e, 1)) / around == up &&
                     int(mesh.vertex(e, 0)) != centre && int(mesh.vertex(e, 1)) != centre;
  const Reconstruction result = reconstruct(mesh, 4, CGAL::parameters::edge_is_constrained_map(is_critical));
  CHECK(result.report.planar_faces == around);
  const double sagitta = 1 - std::cos(std::numbers::pi / around);
  double error = 0;
  for (std::size_t f = 0; f < around * up; ++f)
  {
    const Point x = result.fits[f].point(0, 0);
    error = std::max(error, std::abs(std::hypot(x[0], x[1]) - 1));
  }
  CHECK(error < 0.02 * sagitta);
}

TEST_CASE("fits move, turn and grow with the mesh", "[reconstruct_surface]")
{
  const double scale = GENERATE(1e-6, 1.0, 1e6);
  const double offset = GENERATE(0.0, 1e6); // in units of the mesh
  const int degree = GENERATE(2, 3, 4, 6);
  CAPTURE(scale, offset, degree, seed);
  const Polygons sphere = rough_sphere(3);
  const Rotation rotation = random_rotation(seed);
  const Point way = {offset * scale, 0.5 * offset * scale, -offset * scale};
  const auto transformed = [&](const Point& x) { return moved(rotated(rotation, scaled(scale, x)), way); };
  Polygons other = sphere;
  for (Point& x : other.points)
    x = transformed(x);
  const Reconstruction first = reconstruct(make_mesh(sphere), degree);
  const Reconstruction second = reconstruct(make_mesh(other), degree);
  double difference = 0;
  for (std::size_t f = 0; f < first.fits.size(); ++f)
  {
    const Local_fit& a = first.fits[f];
    const Local_fit& b = second.fits[f];
    for (const Point& local : {Point{0, 0, 0}, Point{0.3, 0.2, 0}, Point{-0.4, 0.1, 0}})
    {
      const Point expected = transformed(a.point(local[0] * a.scale, local[1] * a.scale));
      const Point found = b.point(local[0] * b.scale, local[1] * b.scale);
      difference = std::max(difference, norm(difference_of(found, expected)) / scale);
    }
  }
  // The solver stops at 1e-8 of heights of about 0.1; coordinates at the offset 1e6 are known to 1e-10.
  CHECK(difference < (offset == 0 ? 1e-9 : 2e-9));
}

TEST_CASE("numbers of vertices and faces do not matter", "[reconstruct_surface]")
{
  const int degree = GENERATE(2, 5);
  const bool has_quads = GENERATE(true, false);
  CAPTURE(degree, has_quads, seed);
  Polygons sphere = has_quads ? cubed_sphere(8) : icosphere(3);
  perturb_sphere(sphere, 0.02, seed);
  const Renumbered other = renumbered(sphere, seed);
  const Reconstruction first = reconstruct(make_mesh(sphere), degree);
  const Reconstruction second = reconstruct(make_mesh(other.polygons), degree);
  double difference = 0;
  for (std::size_t f = 0; f < first.fits.size(); ++f)
  {
    const Local_fit& a = first.fits[f];
    const Local_fit& b = second.fits[other.new_faces[f]];
    for (const Point& local : {Point{0, 0, 0}, Point{0.3, 0.2, 0}, Point{-0.4, 0.1, 0}})
      difference = std::max(difference, norm(difference_of(a.point(local[0] * a.scale, local[1] * a.scale),
                                                           b.point(local[0] * b.scale, local[1] * b.scale))));
  }
  CHECK(difference < 1e-9); // the solver stops at 1e-8 of heights of about 0.1
}

TEST_CASE("the number of threads changes no bit", "[reconstruct_surface]")
{
  const Mesh mesh = make_mesh(rough_sphere(4));
  const auto on_threads = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return reconstruct(mesh, 4).fits;
  };
  const std::vector<Local_fit> alone = on_threads(1);
  CHECK(is_equal(alone, on_threads(2)));
  CHECK(is_equal(alone, on_threads(7)));
}

TEST_CASE("reconstruction leaves the mesh alone and repeats itself", "[reconstruct_surface]")
{
  const Polygons sphere = rough_sphere(2);
  const Mesh mesh = make_mesh(sphere);
  const auto properties = mesh.properties<Mesh::Vertex_index>().size() + mesh.properties<Mesh::Edge_index>().size() +
                          mesh.properties<Mesh::Halfedge_index>().size() + mesh.properties<Mesh::Face_index>().size();
  const Reconstruction first = reconstruct(mesh, 3);
  const Reconstruction second = reconstruct(mesh, 3);
  CHECK(is_equal(first.fits, second.fits));
  CHECK(properties == mesh.properties<Mesh::Vertex_index>().size() + mesh.properties<Mesh::Edge_index>().size() +
                        mesh.properties<Mesh::Halfedge_index>().size() + mesh.properties<Mesh::Face_index>().size());
  for (const auto v : mesh.vertices())
    CHECK(to_point(mesh.point(v)) == sphere.points[v.idx()]);
}

TEST_CASE("given vertex normals are used", "[reconstruct_surface]")
{
  Mesh mesh = make_mesh(rough_sphere(3));
  const auto normals = mesh.add_property_map<Mesh::Vertex_index, Kernel::Vector_3>("v:normal").first;
  for (const auto v : mesh.vertices())
    normals[v] = mesh.point(v) - CGAL::ORIGIN;
  const Reconstruction own = reconstruct(mesh, 2);
  const Reconstruction given = reconstruct(mesh, 2, CGAL::parameters::vertex_normal_map(normals));
  CHECK_FALSE(is_equal(own.fits, given.fits));
  for (std::size_t f = 0; f < own.fits.size(); ++f)
    CHECK(norm(difference_of(own.fits[f].point(0, 0), given.fits[f].point(0, 0))) < 1e-4);
  // Against the faces, every point but the corners is left out: what remains is the plane of the face.
  for (const auto v : mesh.vertices())
    normals[v] = CGAL::ORIGIN - mesh.point(v);
  const Reconstruction reversed = reconstruct(mesh, 2, CGAL::parameters::vertex_normal_map(normals));
  CHECK(reversed.report.planar_faces == reversed.report.faces);
}

TEST_CASE("a strip one face wide stays near its faces", "[reconstruct_surface]")
{
  // Half a turn of a cylinder, one face wide: nothing tells the curvature across, so there must be none.
  const int degree = GENERATE(2, 3, 4, 5, 6);
  CAPTURE(degree);
  const Polygons strip = [] {
    Polygons flat = grid(24, 1, std::numbers::pi, 0.1, [](double, double) { return 0.0; });
    for (Point& x : flat.points)
      x = {std::cos(x[0]), x[1], std::sin(x[0])};
    for (auto& face : flat.faces)
      std::reverse(face.begin(), face.end());
    return flat;
  }();
  const Reconstruction result = reconstruct(make_mesh(strip), degree);
  const double sagitta = 1 - std::cos(std::numbers::pi / 48);
  CHECK(result.report.lowered_faces == 0);
  double error = 0;
  for (const Local_fit& fit : result.fits)
    for (const double s : {-0.5, 0.0, 0.5})
      for (const double t : {-0.4, 0.0, 0.4})
      {
        const Point x = fit.point(s * fit.scale, t * fit.scale);
        error = std::max(error, std::abs(std::hypot(x[0], x[2]) - 1));
      }
  CHECK(error < sagitta);
}

TEST_CASE("a fit that fails is lowered and counted", "[reconstruct_surface]")
{
  struct Failing_solver
  {
    int first_good_degree = 0;
    double value = 0;
    void operator()(const Weighted_points& points, int degree, std::span<double> coefficients) const
    {
      Conjugate_residual()(points, degree, coefficients);
      if (degree > first_good_degree)
        coefficients[0] = value;
    }
  };
  using Policies = Reconstruction_policies<Paper_stencil, Paper_weighting, Failing_solver>;
  const Mesh mesh = make_mesh(rough_sphere(1));
  const auto run = [&](int good, double value) {
    return reconstruct(mesh, 4, no_parameters, Policies{.solver = {good, value}}).report;
  };
  const Index faces = static_cast<Index>(mesh.number_of_faces());

  const Reconstruction_report infinite = run(2, std::numeric_limits<double>::infinity());
  CHECK(infinite.faces_of_degree[2] == faces);
  CHECK(infinite.lowered_faces == faces);
  REQUIRE(static_cast<Index>(infinite.lowerings.size()) == faces);
  CHECK(infinite.lowerings[5].face == 5);
  CHECK(infinite.lowerings[5].degree == 2);
  CHECK(infinite.lowerings[5].reason == Lowering_reason::not_finite);

  const Reconstruction_report far = run(3, 500);
  CHECK(far.faces_of_degree[3] == faces);
  CHECK(far.lowerings[7].reason == Lowering_reason::displacement);

  const Reconstruction_report hopeless = run(0, std::numeric_limits<double>::quiet_NaN());
  CHECK(hopeless.faces_of_degree[0] == faces);
  CHECK(hopeless.planar_faces == 0);
  CHECK(hopeless.lowered_faces == faces);
}

TEST_CASE("the bound on displacements is a choice", "[reconstruct_surface]")
{
  const Mesh mesh = make_mesh(icosphere(1));
  std::vector<Local_fit> fits(mesh.number_of_faces());
  const auto map = boost::make_iterator_property_map(fits.begin(), get(boost::face_index, mesh));
  const auto lowered = [&](double bound) {
    return reconstruct_surface(mesh, map, {.degree = 4, .largest_displacement = bound}).lowered_faces;
  };
  CHECK(lowered(1) == 0);
  CHECK(lowered(1e-3) == 80); // a sphere this coarse has sagittas of a tenth of its faces
}

TEST_CASE("reports add up", "[reconstruct_surface]")
{
  const Reconstruction a = reconstruct(make_mesh(rough_sphere(1)), 2);
  const Reconstruction b = reconstruct(make_mesh(rough_plane(3, false)), 2);
  Reconstruction_report sum = a.report;
  sum += b.report;
  CHECK(sum.faces == 80 + 9);
  CHECK(sum.planar_faces == 9);
  CHECK(sum.faces_of_degree[2] == 80);
  CHECK(sum.faces_of_degree[0] == 9);
}

TEST_CASE("degenerate surfaces have documented outcomes", "[reconstruct_surface]")
{
  const int degree = GENERATE(1, 2, 6);
  CAPTURE(degree);
  SECTION("no face")
  {
    CHECK(reconstruct(Mesh(), degree).report.faces == 0);
  }
  SECTION("one triangle is its own plane")
  {
    const Reconstruction one = reconstruct(make_mesh({{{0, 0, 0}, {1, 0, 0.5}, {0, 1, 0.2}}, {{0, 1, 2}}}), degree);
    CHECK(one.report.planar_faces == 1);
  }
  SECTION("two triangles at an angle: too few points, but no nonsense")
  {
    const Polygons tent{{{0, 0, 0}, {1, 0, 0}, {0.5, 1, -0.3}, {0.5, -1, -0.3}}, {{0, 1, 2}, {1, 0, 3}}};
    const Reconstruction two = reconstruct(make_mesh(tent), degree);
    for (const Local_fit& fit : two.fits)
      CHECK(std::abs(fit.height(0, 0)) < 0.3);
    CHECK(two.report.poor_stencils == (degree == 1 ? 0 : 2));
  }
  SECTION("faces without area stay straight, and their neighbours are fitted")
  {
    Polygons sphere = rough_sphere(2);
    const auto collapsed = static_cast<std::size_t>(sphere.faces[0][0]);
    sphere.points[collapsed] = sphere.points[static_cast<std::size_t>(sphere.faces[0][1])];
    const Reconstruction result = reconstruct(make_mesh(sphere), degree);
    CHECK(result.report.lowered_faces == 2); // the two faces of the collapsed edge
    for (const Lowering& lowering : result.report.lowerings)
      CHECK(lowering.reason == Lowering_reason::no_normal);
    CHECK(result.fits[0].is_flat());
    CHECK(result.fits[0].displacement({1, 2, 3}) == Point{0, 0, 0});
    for (const Local_fit& fit : result.fits)
      CHECK(std::isfinite(norm(fit.point(0, 0))));
  }
  SECTION("a needle of aspect ratio 1e8 and a collapsed quad")
  {
    const Polygons faces{{{0, 0, 0}, {1, 0, 0}, {0.5, 1e-8, 0}, {2, 0, 0.1}, {1, 1, 0}}, {{0, 1, 2}, {1, 3, 4, 2}}};
    for (const Local_fit& fit : reconstruct(make_mesh(faces), degree).fits)
      CHECK(std::isfinite(norm(fit.point(0, 0))));
  }
}

TEST_CASE("reconstruct_surface refuses wrong input before it writes anything", "[reconstruct_surface]")
{
  const Mesh mesh = make_mesh(rough_sphere(1));
  CHECK_THROWS_AS(reconstruct(mesh, 0), Input_error);
  CHECK_THROWS_AS(reconstruct(mesh, 7), Input_error);
  std::vector<Local_fit> fits(mesh.number_of_faces());
  const auto map = boost::make_iterator_property_map(fits.begin(), get(boost::face_index, mesh));
  CHECK_THROWS_AS(reconstruct_surface(mesh, map, {.largest_displacement = 0}), Input_error);
  Mesh broken = mesh;
  broken.point(Mesh::Vertex_index(17)) = Point_3(0, std::numeric_limits<double>::quiet_NaN(), 0);
  try
  {
    reconstruct(broken, 2);
    FAIL("no exception");
  }
  catch (const Input_error& error)
  {
    CHECK(std::string(error.what()).find("vertex 17") != std::string::npos);
  }
}

TEST_CASE("progress runs from 0 to 1 and can stop the work", "[reconstruct_surface]")
{
  const Mesh mesh = make_mesh(rough_sphere(2));
  std::vector<Local_fit> fits(mesh.number_of_faces());
  const auto map = boost::make_iterator_property_map(fits.begin(), get(boost::face_index, mesh));
  std::vector<double> fractions;
  reconstruct_surface(mesh, map, {.degree = 2, .progress = [&](std::string_view, double fraction) {
                                    fractions.push_back(fraction);
                                    return true;
                                  }});
  CHECK(fractions.front() == 0);
  CHECK(fractions.back() == 1);
  CHECK_THROWS_AS(
    reconstruct_surface(mesh, map, {.degree = 2, .progress = [](std::string_view, double) { return false; }}),
    Cancelled);
}
