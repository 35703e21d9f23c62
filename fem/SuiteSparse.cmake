# SuiteSparse of Debian 12 ships no CMake package: CHOLMOD, on whatever BLAS the system's alternatives point to.
find_path(CHOLMOD_INCLUDE_DIR cholmod.h PATH_SUFFIXES suitesparse REQUIRED)
find_library(CHOLMOD_LIBRARY NAMES cholmod REQUIRED)
add_library(SuiteSparse::cholmod UNKNOWN IMPORTED)
set_target_properties(SuiteSparse::cholmod PROPERTIES
  IMPORTED_LOCATION "${CHOLMOD_LIBRARY}"
  INTERFACE_INCLUDE_DIRECTORIES "${CHOLMOD_INCLUDE_DIR}")
find_library(OPENBLAS_LIBRARY NAMES openblas REQUIRED)
find_path(CBLAS_INCLUDE_DIR cblas.h PATH_SUFFIXES openblas-pthread x86_64-linux-gnu/openblas-pthread REQUIRED)
add_library(OpenBLAS::openblas UNKNOWN IMPORTED)
set_target_properties(OpenBLAS::openblas PROPERTIES
  IMPORTED_LOCATION "${OPENBLAS_LIBRARY}"
  INTERFACE_INCLUDE_DIRECTORIES "${CBLAS_INCLUDE_DIR}")
