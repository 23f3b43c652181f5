#ifndef RECURVE_TESTS_IO_CGNS_FIXTURE_H
#define RECURVE_TESTS_IO_CGNS_FIXTURE_H

#include <recurve/io/cgns.h>

#include <catch2/catch.hpp>
#include <cgns_io.h>
#include <cgnslib.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <vector>

namespace recurve::test {

/// A folder that goes away with its files.
class Temporary_folder
{
public:
  Temporary_folder()
  {
    std::string name = (std::filesystem::temp_directory_path() / "recurve_test_XXXXXX").string();
    REQUIRE(mkdtemp(name.data()) != nullptr);
    path_ = name;
  }
  ~Temporary_folder()
  {
    std::error_code error;
    std::filesystem::remove_all(path_, error);
  }
  Temporary_folder(const Temporary_folder&) = delete;
  Temporary_folder& operator=(const Temporary_folder&) = delete;

  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

private:
  std::filesystem::path path_;
};

using Numbers = std::vector<cgsize_t>;

/// Writes CGNS files with libcgns itself: what the reader is tested against.
class Raw_cgns
{
public:
  explicit Raw_cgns(const std::filesystem::path& file, int type = CG_FILE_HDF5)
  {
    cg_set_file_type(type);
    REQUIRE(cg_open(file.c_str(), CG_MODE_WRITE, &number) == CG_OK);
    cg_set_file_type(CG_FILE_HDF5);
  }
  ~Raw_cgns() { cg_close(number); }
  Raw_cgns(const Raw_cgns&) = delete;
  Raw_cgns& operator=(const Raw_cgns&) = delete;

  void base(const char* name = "Base", int cell_dimension = 3, int space_dimension = 3)
  {
    REQUIRE(cg_base_write(number, name, cell_dimension, space_dimension, &base_number) == CG_OK);
  }

  void zone(const char* name, cgsize_t points, cgsize_t cells)
  {
    const std::array<cgsize_t, 3> size = {points, cells, 0};
    REQUIRE(cg_zone_write(number, base_number, name, size.data(), Unstructured, &zone_number) == CG_OK);
  }

  void structured_zone(const char* name, cgsize_t ni, cgsize_t nj, cgsize_t nk)
  {
    const std::array<cgsize_t, 9> size = {ni, nj, nk, ni - 1, nj - 1, nk - 1, 0, 0, 0};
    REQUIRE(cg_zone_write(number, base_number, name, size.data(), Structured, &zone_number) == CG_OK);
  }

  void coordinates(const std::vector<Point>& points, DataType_t type = RealDouble)
  {
    static constexpr std::array<const char*, 3> names = {"CoordinateX", "CoordinateY", "CoordinateZ"};
    for (std::size_t d = 0; d < 3; ++d)
    {
      std::vector<double> component(points.size());
      std::transform(points.begin(), points.end(), component.begin(), [d](const Point& point) { return point[d]; });
      const std::vector<float> single(component.begin(), component.end());
      int index = 0;
      const void* const data = type == RealDouble ? static_cast<const void*>(component.data()) : single.data();
      REQUIRE(cg_coord_write(number, base_number, zone_number, type, names[d], data, &index) == CG_OK);
    }
  }

  void section(const char* name, ElementType_t type, cgsize_t first, const Numbers& nodes)
  {
    int width = 0, index = 0;
    REQUIRE(cg_npe(type, &width) == CG_OK);
    const cgsize_t last = first + static_cast<cgsize_t>(nodes.size()) / width - 1;
    REQUIRE(cg_section_write(number, base_number, zone_number, name, type, first, last, 0, nodes.data(), &index) ==
            CG_OK);
  }

  /// `elements` are lists of a type and its nodes.
  void mixed_section(const char* name, cgsize_t first, const std::vector<Numbers>& elements)
  {
    Numbers connectivity, offsets = {0};
    for (const Numbers& element : elements)
    {
      connectivity.insert(connectivity.end(), element.begin(), element.end());
      offsets.push_back(static_cast<cgsize_t>(connectivity.size()));
    }
    int index = 0;
    REQUIRE(cg_poly_section_write(number, base_number, zone_number, name, MIXED, first,
                                  first + static_cast<cgsize_t>(elements.size()) - 1, 0, connectivity.data(),
                                  offsets.data(), &index) == CG_OK);
  }

  int condition(const char* name, BCType_t type, PointSetType_t set, const Numbers& values, GridLocation_t location,
                const char* family = nullptr, int index_dimension = 1)
  {
    int index = 0;
    REQUIRE(cg_boco_write(number, base_number, zone_number, name, type, set,
                          static_cast<cgsize_t>(values.size()) / index_dimension, values.data(), &index) == CG_OK);
    if (location != Vertex)
      REQUIRE(cg_boco_gridlocation_write(number, base_number, zone_number, index, location) == CG_OK);
    if (family != nullptr)
    {
      REQUIRE(cg_goto(number, base_number, "Zone_t", zone_number, "ZoneBC_t", 1, "BC_t", index, "end") == CG_OK);
      REQUIRE(cg_famname_write(family) == CG_OK);
    }
    return index;
  }

  int connection(const char* name, GridLocation_t location, const Numbers& points, const char* donor,
                 const Numbers& donor_points, GridConnectivityType_t type = Abutting1to1)
  {
    int index = 0;
    REQUIRE(cg_conn_write(number, base_number, zone_number, name, location, type, PointList,
                          static_cast<cgsize_t>(points.size()), points.data(), donor, Unstructured, PointListDonor,
                          Integer, static_cast<cgsize_t>(donor_points.size()), donor_points.data(), &index) == CG_OK);
    return index;
  }

  int number = 0, base_number = 0, zone_number = 0;
};

/// Changes nodes of a finished file below the level of libcgns, which would not write what is wrong.
class Node_editor
{
public:
  explicit Node_editor(const std::filesystem::path& file)
  {
    REQUIRE(cgio_open_file(file.c_str(), CGIO_MODE_MODIFY, CGIO_FILE_NONE, &handle_) == 0);
    REQUIRE(cgio_get_root_id(handle_, &root_) == 0);
  }
  ~Node_editor() { cgio_close_file(handle_); }
  Node_editor(const Node_editor&) = delete;
  Node_editor& operator=(const Node_editor&) = delete;

  double find(const std::string& path) const
  {
    if (path.empty())
      return root_;
    double id = 0;
    INFO(path);
    REQUIRE(cgio_get_node_id(handle_, root_, path.c_str(), &id) == 0);
    return id;
  }

  template <class T>
  void set(const std::string& path, const char* type, const std::vector<T>& values,
           std::vector<cgsize_t> dimensions = {}) const
  {
    if (dimensions.empty())
      dimensions = {static_cast<cgsize_t>(values.size())};
    const double id = find(path);
    REQUIRE(cgio_set_dimensions(handle_, id, type, static_cast<int>(dimensions.size()), dimensions.data()) == 0);
    REQUIRE(cgio_write_all_data(handle_, id, values.data()) == 0);
  }

  /// a new array without data, of any size: an HDF5 file grows by nothing.
  void set_unwritten(const std::string& path, const char* type, const std::vector<cgsize_t>& dimensions) const
  {
    REQUIRE(cgio_set_dimensions(handle_, find(path), type, static_cast<int>(dimensions.size()), dimensions.data()) ==
            0);
  }

  void set_text(const std::string& path, const std::string& text) const
  {
    set<char>(path, "C1", std::vector<char>(text.begin(), text.end()));
  }

  void set_version(float version) const { set<float>("/CGNSLibraryVersion", "R4", {version}); }

  void remove(const std::string& parent, const std::string& name) const
  {
    REQUIRE(cgio_delete_node(handle_, find(parent), find(parent + "/" + name)) == 0);
  }

  void rename(const std::string& parent, const std::string& name, const std::string& to) const
  {
    REQUIRE(cgio_set_name(handle_, find(parent), find(parent + "/" + name), to.c_str()) == 0);
  }

private:
  int handle_ = 0;
  double root_ = 0;
};

/// One cell of each type, sharing faces: a cube, a prism beside it, a pyramid on top of it, and a tetrahedron on the
/// prism, against the pyramid. 11 points; numbers count from 1 as in files.
struct Four_cells
{
  std::vector<Point> points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0},     {0, 1, 0},     {0, 0, 1},      {1, 0, 1},
                               {1, 1, 1}, {0, 1, 1}, {1.5, 0.5, 0}, {1.5, 0.5, 1}, {0.5, 0.5, 1.5}};
  Numbers hexahedron = {1, 2, 3, 4, 5, 6, 7, 8};
  Numbers prism = {2, 9, 3, 6, 10, 7};
  Numbers pyramid = {5, 6, 7, 8, 11};
  Numbers tetrahedron = {6, 10, 7, 11};
  Numbers quads = {1, 4, 3, 2, 1, 2, 6, 5, 3, 4, 8, 7, 1, 5, 8, 4, 2, 9, 10, 6, 9, 3, 7, 10};
  Numbers triangles = {2, 3, 9, 5, 6, 11, 7, 8, 11, 8, 5, 11, 6, 10, 11, 10, 7, 11};
};

/// writes the four cells in sections of their own (elements 1 to 4), the 6 quadrangles as elements 5 to 10 and the 6
/// triangles as elements 11 to 16.
inline void write_four_cells(Raw_cgns& raw, const char* zone = "Zone", DataType_t type = RealDouble)
{
  const Four_cells mesh;
  raw.zone(zone, 11, 4);
  raw.coordinates(mesh.points, type);
  raw.section("hexahedra", HEXA_8, 1, mesh.hexahedron);
  raw.section("prisms", PENTA_6, 2, mesh.prism);
  raw.section("pyramids", PYRA_5, 3, mesh.pyramid);
  raw.section("tetrahedra", TETRA_4, 4, mesh.tetrahedron);
  raw.section("quads", QUAD_4, 5, mesh.quads);
  raw.section("triangles", TRI_3, 11, mesh.triangles);
}

inline std::vector<Index> from_zero(const Numbers& numbers)
{
  std::vector<Index> result;
  for (const cgsize_t number : numbers)
    result.push_back(number - 1);
  return result;
}

/// whether one of the notes contains all of `texts`.
inline bool has_note(const Read_report& report, const std::vector<std::string>& texts)
{
  for (const std::string& note : report.notes)
  {
    bool has_all = true;
    for (const std::string& text : texts)
      has_all = has_all && note.find(text) != std::string::npos;
    if (has_all)
      return true;
  }
  return false;
}

/// the message with which reading fails; empty if it does not.
inline std::string read_failure(const std::filesystem::path& file)
{
  try
  {
    read_cgns(file);
  }
  catch (const Format_error& error)
  {
    return error.what();
  }
  return {};
}

} // namespace recurve::test

#endif
