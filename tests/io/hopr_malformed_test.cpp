#include "io/small_meshes.h"

#include <recurve/core/exceptions.h>
#include <recurve/io/hopr.h>
#include <recurve/mesh/join_zones.h>

#include <catch2/catch.hpp>
#include <hdf5.h>

#include <functional>
#include <limits>

using namespace recurve;
using namespace recurve::test;
using Catch::Matchers::Contains;

namespace {

void write_sound_file(const std::filesystem::path& file)
{
  Volume_mesh linear = two_zones(true);
  const Joined_zones joined = join_zones(linear);
  make_periodic(linear);
  write_hopr(elevate(std::move(linear), joined, 2), file);
}

/// changes entry (row, column) of an array of integers or reals.
template <class Number>
void set_entry(hid_t file, const char* name, hsize_t row, hsize_t column, Number value)
{
  const hid_t array = H5Dopen2(file, name, H5P_DEFAULT), space = H5Dget_space(array);
  const hsize_t start[2] = {row, column}, one[2] = {1, 1};
  const hid_t memory = H5Screate_simple(1, one, nullptr);
  H5Sselect_hyperslab(space, H5S_SELECT_SET, start, nullptr, one, nullptr);
  const hid_t type = std::is_same_v<Number, double> ? H5T_NATIVE_DOUBLE : H5T_NATIVE_INT;
  CHECK(H5Dwrite(array, type, memory, space, H5P_DEFAULT, &value) >= 0);
  H5Sclose(memory);
  H5Sclose(space);
  H5Dclose(array);
}

void set_attribute(hid_t file, const char* name, int value)
{
  const hid_t attribute = H5Aopen(file, name, H5P_DEFAULT);
  CHECK(H5Awrite(attribute, H5T_NATIVE_INT, &value) >= 0);
  H5Aclose(attribute);
}

/// an array in the place of `name` that states 2^40 rows and was never written.
void claim_many_rows(hid_t file, const char* name, hsize_t columns)
{
  H5Ldelete(file, name, H5P_DEFAULT);
  const hsize_t shape[2] = {hsize_t(1) << 40, columns};
  const hid_t space = H5Screate_simple(columns > 0 ? 2 : 1, shape, nullptr);
  const hid_t array =
    H5Dcreate2(file, name, H5T_STD_I32LE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT); // allocated late
  H5Dclose(array);
  H5Sclose(space);
}

} // namespace

TEST_CASE("what HOPR files may have wrong is named")
{
  struct Fault
  {
    std::function<void(hid_t)> damage;
    std::string words;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Fault> faults = {
    {[](hid_t f) { set_attribute(f, "Ngeo", 0); }, "Ngeo is 0"},
    {[](hid_t f) { set_attribute(f, "Ngeo", 7); }, "Ngeo is 7"},
    {[](hid_t f) { set_attribute(f, "Ngeo", 3); }, "27 nodes for a hexahedron of degree 3"},
    {[](hid_t f) { set_attribute(f, "nElems", 3); }, "nElems is 3, but the array has 2 rows"},
    {[](hid_t f) { H5Adelete(f, "nSides"); }, "no attribute nSides"},
    {[](hid_t f) { H5Ldelete(f, "SideInfo", H5P_DEFAULT); }, "no array SideInfo"},
    {[](hid_t f) { claim_many_rows(f, "ElemInfo", 6); }, "ElemInfo was never written"},
    {[](hid_t f) { claim_many_rows(f, "GlobalNodeIDs", 0); }, "GlobalNodeIDs was never written"},
    {[](hid_t f) { claim_many_rows(f, "BCNames", 0); }, "BCNames was never written"},
    {[](hid_t f) { set_entry(f, "ElemInfo", 0, 0, 103); }, "element 1: type 103 is no cell"},
    {[](hid_t f) { set_entry(f, "ElemInfo", 1, 0, 206); }, "element 2: 27 nodes for a prism of degree 2"},
    {[](hid_t f) { set_entry(f, "ElemInfo", 1, 2, 5); }, "element 2: its sides 6..12"},
    {[](hid_t f) { set_entry(f, "ElemInfo", 1, 5, 2147483647); }, "nodes 28..2147483647"},
    {[](hid_t f) { set_entry(f, "GlobalNodeIDs", 3, 0, 0); }, "row 4: number 0"},
    {[](hid_t f) { set_entry(f, "GlobalNodeIDs", 3, 0, 55); }, "number 55 is outside 1..54"},
    {[nan](hid_t f) { set_entry(f, "NodeCoords", 5, 1, nan); }, "row 6"},
    {[](hid_t f) { set_entry(f, "SideInfo", 0, 0, -24); }, "mortars"},
    {[](hid_t f) { set_entry(f, "SideInfo", 2, 2, -1); }, "mortars"},
    {[](hid_t f) { set_entry(f, "SideInfo", 1, 4, 9); }, "row 2: boundary condition 9"}};
  const Temporary_file file("damaged.h5");
  for (std::size_t m = 0; m < faults.size(); ++m)
  {
    CAPTURE(m, faults[m].words);
    std::filesystem::remove(file.path()); // a new inode: see hdf5_mutations.cpp
    write_sound_file(file.path());
    const hid_t id = H5Fopen(file.path().c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    REQUIRE(id >= 0);
    faults[m].damage(id);
    H5Fclose(id);
    CHECK_THROWS_AS(read_hopr(file.path()), Format_error);
    CHECK_THROWS_WITH(read_hopr(file.path()), Contains(faults[m].words) && Contains("damaged.h5: "));
  }
}

TEST_CASE("one node in two places is told, and the first counts")
{
  const Temporary_file file("moved.h5");
  write_sound_file(file.path());
  const hid_t id = H5Fopen(file.path().c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  for (hsize_t row = 27; row < 54; ++row) // all nodes of the second cell, those that the first has too
    set_entry(id, "NodeCoords", row, 2, 0.25);
  H5Fclose(id);
  Read_report report;
  read_hopr(file.path(), &report);
  REQUIRE(report.notes.size() == 2);
  CHECK_THAT(report.notes[0], Contains("place differently"));
  CHECK_THAT(report.notes[1], Contains("not translated")); // the periodic sides of the second cell are bent now
}

TEST_CASE("a HOPR file that is cut anywhere is refused")
{
  const Temporary_file file("cut.h5");
  write_sound_file(file.path());
  const auto whole = std::filesystem::file_size(file.path());
  for (std::uintmax_t size = 0; size < whole; size += 997)
  {
    CAPTURE(size);
    std::filesystem::remove(file.path());
    write_sound_file(file.path());
    std::filesystem::resize_file(file.path(), size);
    CHECK_THROWS_AS(read_hopr(file.path()), Format_error);
  }
}
