# For palpate_runtime, for libpalpate_runtime.so and for the module for browsers.
set(runtime_kernels
  kernels/full_links.cpp
  kernels/motion.cpp
  kernels/paper_links.cpp
  kernels/skinning.cpp)
set(runtime_sources
  body_motion.cpp
  walk_order.cpp
  contacts/contacts.cpp
  contacts/creep.cpp
  contacts/springs.cpp
  forces/carried.cpp
  forces/fibres.cpp
  forces/force_field.cpp
  forces/link_tables.cpp
  forces/point_effects.cpp
  forces/poses.cpp
  solver/learnt_curvature.cpp
  solver/modes.cpp
  solver/solver.cpp
  tools/stiffened_matrix.cpp
  tools/tendons.cpp
  tools/tools.cpp
  # Not part of any step.
  body_construction.cpp
  body_inputs.cpp)
list(TRANSFORM runtime_kernels PREPEND "${CMAKE_CURRENT_LIST_DIR}/")
list(TRANSFORM runtime_sources PREPEND "${CMAKE_CURRENT_LIST_DIR}/")
list(APPEND runtime_sources ${runtime_kernels})
