# Debian's packages go below /usr, a package for each component; the archive holds all of it, below one folder.
if(CPACK_GENERATOR STREQUAL "DEB")
  set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
endif()
set(ENV{SOURCE_DATE_EPOCH} "${CPACK_PALPATE_EPOCH}")
