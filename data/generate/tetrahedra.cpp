#include <generate/tetrahedra.h>

#include <generate/mesh_builder.h>
#include <recurve/core/exceptions.h>

#include <tetgen.h>

namespace recurve::generate {

namespace {

void set_points(const Triangulated_boundary& boundary, tetgenio& in)
{
  in.numberofpoints = static_cast<int>(boundary.points.size());
  in.pointlist = new REAL[3 * boundary.points.size()]; // tetgenio deletes its arrays
  for (std::size_t m = 0; m < boundary.points.size(); ++m)
    for (int i = 0; i < 3; ++i)
      in.pointlist[3 * m + i] = boundary.points[m][i];
}

void set_facets(const Triangulated_boundary& boundary, tetgenio& in)
{
  in.numberoffacets = static_cast<int>(boundary.triangles.size());
  in.facetlist = new tetgenio::facet[boundary.triangles.size()];
  in.facetmarkerlist = new int[boundary.triangles.size()];
  for (std::size_t t = 0; t < boundary.triangles.size(); ++t)
  {
    in.facetmarkerlist[t] = boundary.patch_of_triangle[t] + 1; // 0 is TetGen's "no marker"
    tetgenio::facet& facet = in.facetlist[t];
    tetgenio::init(&facet);
    facet.numberofpolygons = 1;
    facet.polygonlist = new tetgenio::polygon[1];
    tetgenio::polygon& polygon = facet.polygonlist[0];
    tetgenio::init(&polygon);
    polygon.numberofvertices = 3;
    polygon.vertexlist = new int[3];
    for (int c = 0; c < 3; ++c)
      polygon.vertexlist[c] = static_cast<int>(boundary.triangles[t][c]);
  }
}

void set_holes(const Triangulated_boundary& boundary, tetgenio& in)
{
  in.numberofholes = static_cast<int>(boundary.holes.size());
  in.holelist = new REAL[3 * boundary.holes.size()];
  for (std::size_t h = 0; h < boundary.holes.size(); ++h)
    for (int i = 0; i < 3; ++i)
      in.holelist[3 * h + i] = boundary.holes[h][i];
}

Volume_mesh mesh_of(const tetgenio& out, const std::vector<Named_patch>& patches, const std::string& zone_name)
{
  Mesh_builder builder(zone_name);
  for (const Named_patch& patch : patches)
    builder.set_patch_kind(patch.name, patch.kind);
  for (Index m = 0; m < out.numberofpoints; ++m)
    builder.add_point({out.pointlist[3 * m], out.pointlist[3 * m + 1], out.pointlist[3 * m + 2]});
  for (Index t = 0; t < out.numberoftetrahedra; ++t)
  {
    const int* const c = out.tetrahedronlist + 4 * t;
    builder.add_cell(Element_type::tetrahedron, std::array<Index, 4>{c[0], c[1], c[2], c[3]});
  }
  for (Index f = 0; f < out.numberoftrifaces; ++f)
    if (out.trifacemarkerlist[f] > 0)
    {
      const int* const c = out.trifacelist + 3 * f;
      builder.add_face(patches[out.trifacemarkerlist[f] - 1].name, std::array<Index, 3>{c[0], c[1], c[2]});
    }
  return builder.build();
}

} // namespace

void Triangulated_boundary::add_triangle(int patch, Index a, Index b, Index c)
{
  triangles.push_back({a, b, c});
  patch_of_triangle.push_back(patch);
}

void Triangulated_boundary::add_quadrangle(int patch, Index a, Index b, Index c, Index d)
{
  add_triangle(patch, a, b, c);
  add_triangle(patch, a, c, d);
}

Volume_mesh fill_with_tetrahedra(const Triangulated_boundary& boundary, const std::string& zone_name,
                                 double radius_edge_ratio)
{
  tetgenio in, out;
  set_points(boundary, in);
  set_facets(boundary, in);
  set_holes(boundary, in);
  // p: fill a boundary; q: quality; Y: keep the boundary as it is; Q: say nothing.
  std::string switches = "pYQq" + std::to_string(radius_edge_ratio);
  try
  {
    tetrahedralize(switches.data(), &in, &out);
  }
  catch (int code)
  {
    throw Input_error("TetGen could not fill the boundary of " + zone_name + ": its code is " + std::to_string(code));
  }
  return mesh_of(out, boundary.patches, zone_name);
}

} // namespace recurve::generate
