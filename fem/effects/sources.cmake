# The physics of effects, in this folder: for palpate_fem, for libpalpate_runtime.so and for the module for browsers.
set(effect_sources
  anisotropy.cpp
  built_in.cpp
  compliant_support.cpp
  contact.cpp
  gravity.cpp
  inclusion.cpp
  prestress.cpp
  registry.cpp
  stiffening.cpp)
list(TRANSFORM effect_sources PREPEND "${CMAKE_CURRENT_LIST_DIR}/")
