# Every package that recurve needs, in one place. All of them are Debian 12 packages; see install_dependencies.sh.

# What the libraries link. The installed package includes this file too, with a recurve_find_package() of its own.
if(NOT COMMAND recurve_find_package)
  macro(recurve_find_package)
    find_package(${ARGV} REQUIRED)
  endmacro()
endif()
set(CGAL_DO_NOT_WARN_ABOUT_CMAKE_BUILD_TYPE TRUE)
set(CGAL_DATA_DIR "" CACHE PATH "not used: recurve reads no data of CGAL")
recurve_find_package(CGAL 5.5)
recurve_find_package(Eigen3 3.4 NO_MODULE)
recurve_find_package(Boost 1.74)
recurve_find_package(TBB)
recurve_find_package(fmt 9)
recurve_find_package(nlohmann_json 3.11)
recurve_find_package(tomlplusplus 3.3)
recurve_find_package(CGNS 3.4)
recurve_find_package(HDF5Serial)
recurve_find_package(Cairo)

# What else programs, generators and tests need.
if(RECURVE_BUILD_APPS)
  find_package(CLI11 2.1 REQUIRED)
endif()
if(RECURVE_BUILD_TESTS OR RECURVE_BUILD_GENERATORS)
  find_package(TetGen REQUIRED)
endif()
if(RECURVE_BUILD_TESTS)
  find_package(Catch2 2.13 REQUIRED)
  find_package(OpenMesh REQUIRED)
  # Oracles (VTK, h5py, numpy) are packages of Debian's own Python, which another python3 on the path would not see.
  find_program(RECURVE_PYTHON NAMES python3 PATHS /usr/bin NO_DEFAULT_PATH REQUIRED)
endif()
