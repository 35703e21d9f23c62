# The physics of effects, in this folder: for palpate_fem, for libpalpate_runtime.so and for the module for browsers.
set(effect_sources
  built_in.cpp
  registry.cpp
  local/known_locality.cpp
  local/local_force.cpp
  local/local_springs.cpp
  local/locality.cpp
  material/anisotropy.cpp
  material/damage.cpp
  material/growth.cpp
  material/inclusion.cpp
  material/prestress.cpp
  material/stiffening.cpp
  local/stiffness_map.cpp
  point/compliant_support.cpp
  point/contact.cpp
  point/gravity.cpp
  ../rig/round_shapes.cpp
  ../rig/tendon_terms.cpp)
list(TRANSFORM effect_sources PREPEND "${CMAKE_CURRENT_LIST_DIR}/")
