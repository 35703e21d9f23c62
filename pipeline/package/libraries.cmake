# What the program is linked with, in one place: `palpate --version` and the package's third-party notices are made of it.
# Licences are as Debian 12's copyright files tell them, for the parts that are used here.

# Those without a CMake package tell their version in a header.
function(palpate_header_version result header pattern)
  file(STRINGS "${header}" lines REGEX "${pattern}")
  set(parts "")
  foreach(line ${lines})
    string(REGEX REPLACE "^.*[^0-9]([0-9]+)[ \t]*(//.*)?$" "\\1" part "${line}")
    list(APPEND parts "${part}")
  endforeach()
  list(JOIN parts "." version)
  set(${result} "${version}" PARENT_SCOPE)
endfunction()
palpate_header_version(cholmod_VERSION "${CHOLMOD_INCLUDE_DIR}/cholmod_core.h" "define CHOLMOD_(MAIN|SUB|SUBSUB)_VERSION [0-9]")
file(STRINGS "${TETGEN_INCLUDE_DIR}/tetgen.h" tetgen_VERSION REGEX "Version [0-9]")
string(REGEX REPLACE "^.*Version ([0-9.]+).*$" "\\1" tetgen_VERSION "${tetgen_VERSION}")
file(STRINGS "${CBLAS_INCLUDE_DIR}/openblas_config.h" openblas_VERSION REGEX "OPENBLAS_VERSION")
string(REGEX REPLACE "^.*OpenBLAS ([0-9.]+).*$" "\\1" openblas_VERSION "${openblas_VERSION}")
pkg_check_modules(matio QUIET matio)
pkg_check_modules(netcdf QUIET netcdf)

# name|version|licence|what it is for
set(palpate_libraries
  "CGAL|${CGAL_VERSION}|GPL-3.0-or-later AND LGPL-3.0-or-later|repair and remeshing of surfaces"
  "TetGen|${tetgen_VERSION}|AGPL-3.0-or-later|tetrahedra"
  "CHOLMOD|${cholmod_VERSION}|GPL-2.0-or-later AND LGPL-2.1-or-later|sparse Cholesky factors (SuiteSparse)"
  "OpenBLAS|${openblas_VERSION}|BSD-3-Clause|dense linear algebra"
  "VTK|${VTK_VERSION}|BSD-3-Clause|VTK files"
  "matio|${matio_VERSION}|BSD-2-Clause|MATLAB files"
  "netCDF|${netcdf_VERSION}|BSD-3-Clause|Exodus files"
  "oneTBB|${TBB_VERSION}|Apache-2.0|threads"
  "Eigen|${Eigen3_VERSION}|MPL-2.0|matrices"
  "Spectra|${spectra_VERSION}|MPL-2.0|eigenvalues"
  "yaml-cpp|${yaml-cpp_VERSION}|MIT|YAML"
  "nlohmann/json|${nlohmann_json_VERSION}|MIT|JSON"
  "cereal|${cereal_VERSION}|BSD-3-Clause|results of child processes"
  "CLI11|${CLI11_VERSION}|BSD-3-Clause|the command line"
  "cpp-httplib|${httplib_VERSION}|MIT|the server of 'palpate play'"
  "fmt|${fmt_VERSION}|MIT|text"
  "spdlog|${spdlog_VERSION}|MIT|the log"
  "OpenSSL|${OPENSSL_VERSION}|Apache-2.0|SHA-256"
  "zlib|${ZLIB_VERSION_STRING}|Zlib|compressed files")
if(PALPATE_PETSC)
  file(STRINGS "${METIS_INCLUDE_DIR}/metis.h" metis_lines REGEX "define METIS_VER_(MAJOR|MINOR|SUBMINOR)")
  string(REGEX REPLACE "[^0-9]+" "." metis_VERSION "${metis_lines}")
  string(REGEX MATCH "[0-9]+\\.[0-9]+\\.[0-9]+" metis_VERSION "${metis_VERSION}")
  list(APPEND palpate_libraries "PETSc|${petsc_VERSION}|BSD-2-Clause|bodies over several processes"
    "METIS|${metis_VERSION}|Apache-2.0|the processes' shares of a body")
endif()
if(PALPATE_CAD)
  list(INSERT palpate_libraries 4 "OpenCASCADE|${OpenCASCADE_VERSION}|LGPL-2.1-only WITH OCCT-exception-1.0|STEP and IGES")
endif()

# CGAL's GPL 3 takes in the rest: CHOLMOD's "2 or later" and OpenCASCADE's LGPL 2.1 (section 3) may be had under it, and
# Apache 2.0, MPL 2.0, BSD, MIT and Zlib agree with it. Its section 13 lets AGPL code be linked, whose section 13 then
# holds for the whole.
set(palpate_binary_licence "GPL-3.0-or-later AND AGPL-3.0-or-later")

set(palpate_library_rows "")
set(palpate_notices "")
foreach(library ${palpate_libraries})
  string(REPLACE "|" ";" fields "${library}")
  list(GET fields 0 name)
  list(GET fields 1 library_version)
  list(GET fields 2 licence)
  list(GET fields 3 purpose)
  string(APPEND palpate_library_rows "    {\"${name}\", \"${library_version}\", \"${licence}\", \"${purpose}\"},\n")
  string(APPEND palpate_notices "  ${name} ${library_version}, for ${purpose}: ${licence}\n")
endforeach()
configure_file(package/libraries.h.in "${PROJECT_BINARY_DIR}/generated/pipeline/libraries.h" @ONLY)
configure_file(package/THIRD_PARTY_NOTICES.in "${PROJECT_BINARY_DIR}/generated/THIRD_PARTY_NOTICES" @ONLY)
