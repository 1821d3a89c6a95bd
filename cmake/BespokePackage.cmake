# A Debian package of what BespokeInstall installs: cpack --config build/release/CPackConfig.cmake
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "the bespoke authors <bespoke@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(contents "the command and the library")
if(BESPOKE_PYTHON)
  set(contents "the command, the library and the module for Python")
  # The extension module is of one version of Python.
  math(EXPR next_minor "${Python3_VERSION_MINOR} + 1")
  set(CPACK_DEBIAN_PACKAGE_DEPENDS
      "python3 (>= 3.${Python3_VERSION_MINOR}), python3 (<< 3.${next_minor}), python3-numpy")
endif()
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION
"From two models and points that correspond it makes a map of the space around
the one onto the space around the other, proves that the map does not fold,
stores it in one OpenVDB file, and carries dresses, glasses, gloves, shoes and
other products across it. The package holds
${contents}.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR})
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# For programs that link the library.
set(CPACK_DEBIAN_PACKAGE_SUGGESTS
    "libopenvdb-dev, libopenmesh-dev, libmeshoptimizer-dev, libeigen3-dev, libtbb-dev, nlohmann-json3-dev, libssl-dev, zlib1g-dev, libexpat1-dev, libcairo2-dev, libpolyclipping-dev, libzip-dev, libpng-dev")
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
    OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
# The tags of lintian that stay, each with its reason.
install(FILES ${PROJECT_SOURCE_DIR}/cmake/debian/lintian_overrides RENAME bespoke
        DESTINATION ${CMAKE_INSTALL_DATADIR}/lintian/overrides)
include(CPack)
