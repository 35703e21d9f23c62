# The model and its forces: for palpate_skeleton, for libpalpate_runtime.so and for the module for browsers.
set(shared_skeleton_sources
  blocks/block_cholesky.cpp
  blocks/block_kernels.cpp
  effects/effect.cpp
  effects/link_effects.cpp
  effects/placed_effects.cpp
  effects/placed_skin.cpp
  effects/point_sets.cpp
  links/branches.cpp
  links/full_link.cpp
  links/link_energy.cpp
  links/shear.cpp
  links/fibres/link_fibre.cpp
  links/fibres/plastic_fibre.cpp
  links/fibres/uniaxial.cpp
  links/placed/placed_links.cpp
  links/placed/placed_volumes.cpp
  loads/cavities.cpp
  loads/dent.cpp
  loads/load.cpp
  model/attach.cpp
  model/carried_point.cpp
  model/state.cpp
  model/io/json_fields.cpp
  model/io/read_model.cpp
  statics/statics.cpp)
list(TRANSFORM shared_skeleton_sources PREPEND "${CMAKE_CURRENT_LIST_DIR}/")
