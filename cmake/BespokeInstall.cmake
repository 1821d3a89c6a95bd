# The libraries with their public headers, the command, and a package for find_package(bespoke).
include(CMakePackageConfigHelpers)
set(BESPOKE_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/bespoke)

include(BespokePublicHeaders)
foreach(header IN LISTS BESPOKE_PUBLIC_HEADERS)
  get_filename_component(folder ${header} DIRECTORY)
  install(FILES ${PROJECT_SOURCE_DIR}/src/bespoke/${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/bespoke/${folder})
endforeach()

install(TARGETS ${BESPOKE_LIBRARIES} EXPORT bespokeTargets)
install(EXPORT bespokeTargets NAMESPACE bespoke:: DESTINATION ${BESPOKE_PACKAGE_DIR})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/bespokeConfigVersion.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_SOURCE_DIR}/cmake/bespokeConfig.cmake
              ${PROJECT_SOURCE_DIR}/cmake/BespokeDependencies.cmake
              ${PROJECT_BINARY_DIR}/bespokeConfigVersion.cmake
        DESTINATION ${BESPOKE_PACKAGE_DIR})
if(TARGET bespoke_command)
  install(TARGETS bespoke_command)
  install(FILES ${PROJECT_SOURCE_DIR}/tools/completion/bespoke.bash RENAME bespoke
          DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
  install(FILES ${PROJECT_SOURCE_DIR}/tools/completion/bespoke.fish
          DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d)
  install(FILES ${PROJECT_SOURCE_DIR}/tools/completion/_bespoke
          DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions)
  find_program(HELP2MAN help2man)  # the manual's page is the command's help
  if(HELP2MAN)
    set(page ${PROJECT_BINARY_DIR}/bespoke.1.gz)
    add_custom_command(OUTPUT ${page} DEPENDS bespoke_command ${PROJECT_SOURCE_DIR}/tools/manual VERBATIM
                       COMMAND ${PROJECT_SOURCE_DIR}/tools/manual $<TARGET_FILE:bespoke_command> ${page})
    add_custom_target(manual ALL DEPENDS ${page})
    install(FILES ${page} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
  endif()
endif()
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/cmake/debian/copyright DESTINATION ${CMAKE_INSTALL_DOCDIR})
