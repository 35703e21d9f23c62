# TetGen ships no CMake package: the library, and the define that its header wants from library users.
find_path(TETGEN_INCLUDE_DIR tetgen.h REQUIRED)
find_library(TETGEN_LIBRARY NAMES tet REQUIRED)
add_library(TetGen::tetgen UNKNOWN IMPORTED)
set_target_properties(TetGen::tetgen PROPERTIES
  IMPORTED_LOCATION "${TETGEN_LIBRARY}"
  INTERFACE_INCLUDE_DIRECTORIES "${TETGEN_INCLUDE_DIR}"
  INTERFACE_COMPILE_DEFINITIONS TETLIBRARY)
