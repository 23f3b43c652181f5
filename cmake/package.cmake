# Installs the CMake package: find_package(recurve) gives recurve::recurve and one target per floor.
include(CMakePackageConfigHelpers)
set(recurve_package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/recurve")

install(EXPORT recurve_targets NAMESPACE recurve:: FILE recurveTargets.cmake DESTINATION "${recurve_package_dir}")
configure_package_config_file(
  "${PROJECT_SOURCE_DIR}/cmake/recurveConfig.cmake.in" "${PROJECT_BINARY_DIR}/recurveConfig.cmake"
  INSTALL_DESTINATION "${recurve_package_dir}")
# Before version 1.0 a new minor version may break its callers.
write_basic_package_version_file("${PROJECT_BINARY_DIR}/recurveConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/recurveConfig.cmake" "${PROJECT_BINARY_DIR}/recurveConfigVersion.cmake"
              "${PROJECT_SOURCE_DIR}/cmake/dependencies.cmake" "${PROJECT_SOURCE_DIR}/cmake/FindCGNS.cmake"
              "${PROJECT_SOURCE_DIR}/cmake/FindCairo.cmake" "${PROJECT_SOURCE_DIR}/cmake/FindHDF5Serial.cmake"
        DESTINATION "${recurve_package_dir}")
install(FILES "${PROJECT_SOURCE_DIR}/LICENSE" DESTINATION "${CMAKE_INSTALL_DOCDIR}")
