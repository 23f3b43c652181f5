// Damages CGNS and HOPR files in their own terms: numbers of arrays and attributes, shapes, types, missing and doubled
// nodes; CGNS files also byte by byte. The reader reads what it gets or refuses it with a message.
//
// usage: hdf5_mutations cgns|hopr [COUNT [SEED]]
#include "fuzz_target.h"
#include "io/single_cell_mesh.h"
#include "io/small_meshes.h"

#include <recurve/io/cgns.h>
#include <recurve/io/hopr.h>
#include <recurve/mesh/join_zones.h>

#include <hdf5.h>

#include <array>
#include <limits>
#include <random>

namespace {

using namespace recurve;
using Generator = std::mt19937_64;

std::size_t below(Generator& generator, std::size_t count)
{
  return count == 0 ? 0 : static_cast<std::size_t>(generator() % count);
}

herr_t collect(hid_t, const char* name, const H5O_info_t* info, void* names)
{
  if (info->type == H5O_TYPE_DATASET)
    static_cast<std::vector<std::string>*>(names)->push_back(name);
  return 0;
}

herr_t collect_link(hid_t, const char* name, const H5L_info_t*, void* names)
{
  static_cast<std::vector<std::string>*>(names)->push_back(name);
  return 0;
}

std::vector<std::string> datasets_of(hid_t file)
{
  std::vector<std::string> names;
  H5Ovisit(file, H5_INDEX_NAME, H5_ITER_NATIVE, collect, &names);
  return names;
}

std::vector<std::string> links_of(hid_t file)
{
  std::vector<std::string> names;
  H5Lvisit(file, H5_INDEX_NAME, H5_ITER_NATIVE, collect_link, &names);
  return names;
}

constexpr std::array<std::int64_t, 11> integers = {0,         1,   -1, 2, 7, 2147483647, -2147483648LL, 4294967296LL,
                                                   1LL << 40, 400, 9};
const std::array<double, 6> reals = {
  0, -1, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e300, 1e-320};

/// changes a few numbers of an array in place.
void change_numbers(hid_t file, const std::string& name, Generator& generator)
{
  const hid_t array = H5Dopen2(file, name.c_str(), H5P_DEFAULT);
  const hid_t space = H5Dget_space(array), type = H5Dget_type(array);
  const auto count = static_cast<std::size_t>(std::max<hssize_t>(0, H5Sget_simple_extent_npoints(space)));
  if (count > 0 && count < 100000 && H5Tget_class(type) == H5T_INTEGER)
  {
    std::vector<std::int64_t> values(count);
    H5Dread(array, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    for (std::size_t times = 1 + below(generator, 3); times > 0; --times)
      values[below(generator, count)] = integers[below(generator, integers.size())];
    H5Dwrite(array, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  }
  else if (count > 0 && count < 100000 && H5Tget_class(type) == H5T_FLOAT)
  {
    std::vector<double> values(count);
    H5Dread(array, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    values[below(generator, count)] = reals[below(generator, reals.size())];
    H5Dwrite(array, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  }
  H5Tclose(type);
  H5Sclose(space);
  H5Dclose(array);
}

/// puts an array of another shape or type in the place of one, or one that claims to be huge and holds nothing.
void replace_array(hid_t file, const std::string& name, Generator& generator)
{
  H5Ldelete(file, name.c_str(), H5P_DEFAULT);
  const std::array<hid_t, 5> types = {H5T_STD_I32LE, H5T_STD_I64LE, H5T_IEEE_F64LE, H5T_IEEE_F32LE, H5T_STD_I8LE};
  const bool is_huge = below(generator, 4) == 0;
  const int dimension = 1 + static_cast<int>(below(generator, 3));
  std::array<hsize_t, 3> shape = {};
  for (hsize_t& length : shape)
    length = is_huge ? hsize_t(1) << 33 : 1 + below(generator, 12);
  const hid_t space = H5Screate_simple(is_huge ? 1 : dimension, shape.data(), nullptr);
  const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
  if (is_huge)
    H5Pset_alloc_time(properties, H5D_ALLOC_TIME_LATE);
  const hid_t array =
    H5Dcreate2(file, name.c_str(), types[below(generator, types.size())], space, H5P_DEFAULT, properties, H5P_DEFAULT);
  if (!is_huge && array >= 0)
  {
    const std::vector<std::int64_t> values(12 * 12 * 12, integers[below(generator, integers.size())]);
    H5Dwrite(array, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  }
  H5Dclose(array);
  H5Pclose(properties);
  H5Sclose(space);
}

void change_attribute(hid_t file, Generator& generator)
{
  H5O_info_t info;
  H5Oget_info(file, &info);
  if (info.num_attrs == 0)
    return;
  const hid_t attribute =
    H5Aopen_by_idx(file, ".", H5_INDEX_NAME, H5_ITER_NATIVE, below(generator, static_cast<std::size_t>(info.num_attrs)),
                   H5P_DEFAULT, H5P_DEFAULT);
  const hid_t type = H5Aget_type(attribute);
  if (H5Tget_class(type) == H5T_INTEGER)
  {
    const std::int64_t value = integers[below(generator, integers.size())];
    H5Awrite(attribute, H5T_NATIVE_INT64, &value);
  }
  H5Tclose(type);
  H5Aclose(attribute);
}

void mutate(const std::filesystem::path& path, Generator& generator)
{
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  const std::vector<std::string> names = datasets_of(file), links = links_of(file);
  if (names.empty())
  {
    H5Fclose(file);
    return;
  }
  const std::string &name = names[below(generator, names.size())], &link = links[below(generator, links.size())];
  switch (below(generator, 8))
  {
  case 0: replace_array(file, name, generator); break;
  case 1: H5Ldelete(file, link.c_str(), H5P_DEFAULT); break;
  case 2:
    H5Ldelete(file, name.c_str(), H5P_DEFAULT);
    H5Olink(file, file, name.c_str(), H5P_DEFAULT, H5P_DEFAULT); // a loop
    break;
  case 3: H5Ocopy(file, link.c_str(), file, (link + "_copy").c_str(), H5P_DEFAULT, H5P_DEFAULT); break;
  case 4: change_attribute(file, generator); break;
  default: change_numbers(file, name, generator);
  }
  H5Fclose(file);
}

void mutate_bytes(const std::filesystem::path& path, Generator& generator)
{
  std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
  const auto size = static_cast<std::size_t>(std::filesystem::file_size(path));
  for (std::size_t times = 1 + below(generator, 4); times > 0; --times)
  {
    file.seekp(static_cast<std::streamoff>(below(generator, size)));
    file.put(static_cast<char>(generator()));
  }
  file.close();
  if (below(generator, 4) == 0)
    std::filesystem::resize_file(path, below(generator, size));
}

std::vector<Curved_mesh> meshes()
{
  Volume_mesh linear = test::two_zones(true);
  const Joined_zones joined = join_zones(linear);
  test::make_periodic(linear);
  linear.families = {{"flow", "BCWall"}};
  return {elevate(linear, joined, 2), elevate(linear, joined, 1), test::single_cell_mesh(Element_type::pyramid, 3)};
}

} // namespace

int main(int argc, char** argv)
{
  const std::string format = argc > 1 ? argv[1] : "";
  const long count = argc > 2 ? std::atol(argv[2]) : 400;
  const auto seed = argc > 3 ? std::strtoull(argv[3], nullptr, 10) : std::uint64_t{20240610};
  if (format != "cgns" && format != "hopr")
    return 1;
  std::cout << count << " mutations of " << format << " files, seed " << seed << std::endl;
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  const std::filesystem::path original = test::fuzz_file("original." + format, nullptr, 0);
  Generator generator(seed);
  long refused = 0;
  const std::vector<Curved_mesh> seeds = meshes();
  for (std::size_t s = 0; s < seeds.size(); ++s)
  {
    format == "cgns" ? write_cgns(seeds[s], original) : write_hopr(seeds[s], original);
    for (long m = 0; m < count / static_cast<long>(seeds.size()); ++m)
    {
      // A new file each time: HDF5 may fail to close a damaged one, and would then take the next of its inode for it.
      const std::filesystem::path file =
        test::fuzz_file(std::to_string(s) + "_" + std::to_string(m) + "." + format, nullptr, 0);
      std::filesystem::copy_file(original, file, std::filesystem::copy_options::overwrite_existing);
      for (std::size_t times = 1 + below(generator, 2); times > 0; --times)
        mutate(file, generator);
      // Object headers of HOPR files have no checksums; damaged ones make HDF5 1.10 itself read beyond them.
      if (format == "cgns" && below(generator, 10) == 0)
        mutate_bytes(file, generator);
      alarm(30);
      bool is_read = false;
      test::must_read_or_refuse([&] {
        to_curved_mesh(format == "cgns" ? read_curved_cgns(file) : read_hopr(file));
        is_read = true;
      });
      refused += !is_read;
      std::filesystem::remove(file);
    }
  }
  std::cout << refused << " refused" << std::endl;
  return 0;
}
