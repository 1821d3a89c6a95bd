option(BESPOKE_UNITY "Compile each directory of a target as one unit" OFF)

# bespoke_units(TARGET): with BESPOKE_UNITY, the sources of each of the target's directories are compiled as one unit,
# so that headers are read once a directory: a clean build takes half of the time. An edit compiles its directory, 7 to
# 55 s in place of 1 to 11. Names in anonymous namespaces must therefore differ within a directory; a source that has options
# of its own stays alone.
function(bespoke_units target)
  if(NOT BESPOKE_UNITY)
    return()
  endif()
  get_target_property(sources ${target} SOURCES)
  foreach(source IN LISTS sources)
    if(source MATCHES "\\.cpp$")
      get_filename_component(folder "${source}" DIRECTORY)
      string(MAKE_C_IDENTIFIER "unit_${folder}" group)
      set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${group})
    endif()
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # It takes sources for headers here, whose classes must hold no type of an anonymous namespace.
    target_compile_options(${target} PRIVATE -Wno-subobject-linkage)
    if(CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
      # More false alarms on `"literal" + std::string` (GCC bug 105329), which sources of their own are spared.
      target_compile_options(${target} PRIVATE -Wno-stringop-overflow -Wno-array-bounds)
    endif()
  endif()
endfunction()
