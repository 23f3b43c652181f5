# Finds OpenMesh, which Debian ships without a CMake package. Defines OpenMesh::Core. For tests and examples.
find_path(OpenMesh_INCLUDE_DIR OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh)
find_library(OpenMesh_LIBRARY OpenMeshCore)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(OpenMesh REQUIRED_VARS OpenMesh_LIBRARY OpenMesh_INCLUDE_DIR)
if(OpenMesh_FOUND AND NOT TARGET OpenMesh::Core)
  add_library(OpenMesh::Core UNKNOWN IMPORTED)
  set_target_properties(OpenMesh::Core PROPERTIES IMPORTED_LOCATION "${OpenMesh_LIBRARY}"
                        INTERFACE_INCLUDE_DIRECTORIES "${OpenMesh_INCLUDE_DIR}")
endif()
mark_as_advanced(OpenMesh_INCLUDE_DIR OpenMesh_LIBRARY)
