# Of this folder: for palpate_mesh, for libpalpate_runtime.so and for the module for browsers.
set(shared_mesh_sources
  core/convex_hull.cpp
  core/region.cpp
  core/surface.cpp
  text/atomic_file.cpp
  text/unfinished.cpp
  text/words.cpp
  topology/shells.cpp)
list(TRANSFORM shared_mesh_sources PREPEND "${CMAKE_CURRENT_LIST_DIR}/")
