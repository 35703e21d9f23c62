# find_package(palpate): the libraries and headers, see samples/consumer. Packages are made by packages.cmake.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(package_folder "${CMAKE_INSTALL_LIBDIR}/cmake/palpate")

set(libraries common cgal mesh fem skeleton runtime identify)
if(PALPATE_CAD)
  list(APPEND libraries cad)
endif()
foreach(library ${libraries})
  set_target_properties(palpate_${library} PROPERTIES EXPORT_NAME ${library})
  install(TARGETS palpate_${library} EXPORT palpateTargets COMPONENT development)
endforeach()
set_target_properties(palpate_runtime_shared PROPERTIES EXPORT_NAME runtime_shared)
install(TARGETS palpate_runtime_shared EXPORT palpateTargets LIBRARY COMPONENT runtime NAMELINK_COMPONENT development)
install(EXPORT palpateTargets NAMESPACE palpate:: DESTINATION "${package_folder}" COMPONENT development)
foreach(folder mesh fem skeleton identify)
  install(DIRECTORY "${PROJECT_SOURCE_DIR}/${folder}" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/palpate" COMPONENT development
    FILES_MATCHING PATTERN "*.h")
endforeach()

configure_package_config_file("${PROJECT_SOURCE_DIR}/pipeline/package/palpateConfig.cmake.in"
  "${PROJECT_BINARY_DIR}/palpateConfig.cmake" INSTALL_DESTINATION "${package_folder}")
write_basic_package_version_file("${PROJECT_BINARY_DIR}/palpateConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/palpateConfig.cmake" "${PROJECT_BINARY_DIR}/palpateConfigVersion.cmake"
  mesh/meshing/TetGen.cmake fem/SuiteSparse.cmake DESTINATION "${package_folder}" COMPONENT development)
include(pipeline/package/packages.cmake)
