# The library with its public headers, the command, and a package for find_package(bespoke).
include(CMakePackageConfigHelpers)
set(BESPOKE_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/bespoke)

# The tree says who may use a header: those under detail/ belong to the rooms they stand in.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/src/bespoke DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
        FILES_MATCHING PATTERN "*.h" PATTERN "detail" EXCLUDE)

install(TARGETS bespoke EXPORT bespokeTargets)
install(EXPORT bespokeTargets NAMESPACE bespoke:: DESTINATION ${BESPOKE_PACKAGE_DIR})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/bespokeConfigVersion.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_SOURCE_DIR}/cmake/bespokeConfig.cmake
              ${PROJECT_SOURCE_DIR}/cmake/BespokeDependencies.cmake
              ${PROJECT_BINARY_DIR}/bespokeConfigVersion.cmake
        DESTINATION ${BESPOKE_PACKAGE_DIR})
if(TARGET bespoke_command)
  install(TARGETS bespoke_command)
endif()
