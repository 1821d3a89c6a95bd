include(${CMAKE_CURRENT_LIST_DIR}/BespokeDependencies.cmake)
include(${CMAKE_CURRENT_LIST_DIR}/bespokeTargets.cmake)
