# Packages for Debian 12, and an archive that runs from wherever it is unpacked:
#   cmake --build build --target packages      build/packages/*.deb, *.tar.gz
# They hold no path and no time of the build: the same sources on the same system make the same bytes.
set(PALPATE_MAINTAINER "The Palpate developers <developers@palpate.invalid>" CACHE STRING "Whom packages name: Name <address>")

# Times in packages are SOURCE_DATE_EPOCH, or that of the last commit.
set(palpate_epoch "$ENV{SOURCE_DATE_EPOCH}")
if(NOT palpate_epoch)
  execute_process(COMMAND git log -1 --format=%ct WORKING_DIRECTORY "${PROJECT_SOURCE_DIR}"
    OUTPUT_VARIABLE palpate_epoch OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
endif()
if(NOT palpate_epoch)
  set(palpate_epoch 1767225600)  # a source without a history: the year of the copyright
endif()
execute_process(COMMAND date -uRd "@${palpate_epoch}" OUTPUT_VARIABLE palpate_date OUTPUT_STRIP_TRAILING_WHITESPACE
  COMMAND_ERROR_IS_FATAL ANY)

file(READ "${PROJECT_SOURCE_DIR}/LICENSE" licence_text)
string(REGEX REPLACE "^.*(Permission is hereby.*)$" "\\1" licence_text "${licence_text}")
string(STRIP "${licence_text}" licence_text)
string(REPLACE "\n\n" "\n.\n" licence_text "${licence_text}")
string(REPLACE "\n" "\n " licence_text " ${licence_text}")
set(debian_files "${PROJECT_BINARY_DIR}/generated/debian")
configure_file(pipeline/package/debian/copyright.in "${debian_files}/copyright" @ONLY)

# component;package: what each is documented with.
set(palpate_components program palpate runtime libpalpate-runtime0 development libpalpate-dev)
if(PALPATE_PYTHON)
  list(APPEND palpate_components python python3-palpate)
endif()
list(LENGTH palpate_components count)
math(EXPR last "${count} - 2")
foreach(i RANGE 0 ${last} 2)
  list(SUBLIST palpate_components ${i} 2 pair)
  list(GET pair 0 component)
  list(GET pair 1 package)
  configure_file(pipeline/package/debian/changelog.in "${debian_files}/${package}/changelog.Debian" @ONLY)
  string(TOUPPER ${component} COMPONENT)
  set(CPACK_DEBIAN_${COMPONENT}_PACKAGE_NAME ${package})
  list(APPEND CPACK_COMPONENTS_ALL ${component})
endforeach()
install(FILES README.md CHANGELOG.md CITATION.cff "${PROJECT_BINARY_DIR}/generated/THIRD_PARTY_NOTICES"
  DESTINATION "${CMAKE_INSTALL_DATADIR}/doc/palpate" COMPONENT program)
install(DIRECTORY samples/dragonskin-beam DESTINATION "${CMAKE_INSTALL_DATADIR}/doc/palpate/examples" COMPONENT program
  PATTERN "*.png" EXCLUDE)

set(CPACK_PACKAGE_VENDOR "The Palpate developers")
set(CPACK_PACKAGE_CONTACT "${PALPATE_MAINTAINER}")
set(CPACK_PACKAGE_FILE_NAME "palpate-${PROJECT_VERSION}-${CMAKE_SYSTEM_NAME}-${CMAKE_SYSTEM_PROCESSOR}")
set(CPACK_PACKAGE_DIRECTORY "${PROJECT_BINARY_DIR}/packages")
set(CPACK_GENERATOR DEB TGZ)
set(CPACK_STRIP_FILES ON)
set(CPACK_THREADS 0)
set(CPACK_VERBATIM_VARIABLES ON)
set(CPACK_PROJECT_CONFIG_FILE "${PROJECT_SOURCE_DIR}/pipeline/package/generators.cmake")
set(CPACK_PRE_BUILD_SCRIPTS "${PROJECT_SOURCE_DIR}/pipeline/package/staged.cmake")
# For staged.cmake.
set(CPACK_PALPATE_EPOCH "${palpate_epoch}")
set(CPACK_PALPATE_COMPONENTS "${palpate_components}")
set(CPACK_PALPATE_DEBIAN "${debian_files}")
set(CPACK_PALPATE_OVERRIDES "${PROJECT_SOURCE_DIR}/pipeline/package/debian")
set(CPACK_PALPATE_CHANGELOG "${PROJECT_SOURCE_DIR}/CHANGELOG.md")

set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_MAINTAINER "${PALPATE_MAINTAINER}")
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
foreach(COMPONENT PROGRAM RUNTIME PYTHON)
  set(CPACK_DEBIAN_${COMPONENT}_PACKAGE_SHLIBDEPS ON)
endforeach()
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAM_DESCRIPTION "calibrate deformable models from measurements
 Palpate fills a CAD or organ mesh with spheres along its medial axis, joins
 them by elastic links, and finds the stiffness of every link by particle
 filter, so that the model deforms as finite elements say, or as it was
 measured. It says which physical effect a model lacks, adds it, and tells the
 error before and after. Models are played in real time.")
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS_POLICY ">=")
set(CPACK_DEBIAN_RUNTIME_PACKAGE_CONTROL_EXTRA "${PROJECT_SOURCE_DIR}/pipeline/package/debian/triggers")
set(CPACK_DEBIAN_RUNTIME_DESCRIPTION "play calibrated deformable models in real time (library)
 libpalpate_runtime plays models of spheres and links, which palpate
 calibrates, at haptic rates: forces or positions in, forces and the skin out.
 It needs the C and C++ libraries alone.")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "libpalpate-runtime0 (= ${PROJECT_VERSION}-1), libeigen3-dev, libcgal-dev, libtet1.5-dev, libvtk9-dev, libsuitesparse-dev, libopenblas-dev, libtbb-dev, libyaml-cpp-dev, nlohmann-json3-dev, libfmt-dev, zlib1g-dev")
if(PALPATE_CAD)
  string(APPEND CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS ", libocct-data-exchange-dev")
endif()
set(CPACK_DEBIAN_DEVELOPMENT_DESCRIPTION "play and calibrate deformable models (headers and libraries)
 What a program needs to play models of palpate (libpalpate_runtime, for C and
 C++), or to mesh, calibrate and diagnose by palpate's own libraries: headers,
 static libraries, and a package for CMake.")
if(PALPATE_PYTHON)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  string(REGEX REPLACE "^3\\." "" next_minor "${PALPATE_PYTHON_VERSION}")
  math(EXPR next_minor "${next_minor} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3 (>= ${PALPATE_PYTHON_VERSION}), python3 (<< 3.${next_minor}), python3-numpy")
  set(CPACK_DEBIAN_PYTHON_DESCRIPTION "calibrate deformable models from measurements (Python)
 The commands of palpate as functions of Python, on objects with numpy arrays:
 meshes, measurement sets, models that are played and stepped, verdicts.")
endif()
include(CPack)

# `package` of Ninja would build all tests first.
set(packaged palpate palpate_runtime_shared palpate_identify palpate_runtime)
if(PALPATE_PYTHON)
  list(APPEND packaged palpate_python)
endif()
add_custom_target(packages COMMAND "${CMAKE_CPACK_COMMAND}" --config "${PROJECT_BINARY_DIR}/CPackConfig.cmake"
  DEPENDS ${packaged} USES_TERMINAL VERBATIM)
