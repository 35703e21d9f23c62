# For palpate_pipeline and for the module for browsers.
set(touch_sources
  running_comparison.cpp
  set_text.cpp
  touched_model.cpp)
list(TRANSFORM touch_sources PREPEND "${CMAKE_CURRENT_LIST_DIR}/")
