# For palpate_identify and for the module for browsers.
set(loading_sources
  creep.cpp
  history/load_history.cpp
  loads.cpp
  readings.cpp
  reduced_load.cpp)
list(TRANSFORM loading_sources PREPEND "${CMAKE_CURRENT_LIST_DIR}/")
