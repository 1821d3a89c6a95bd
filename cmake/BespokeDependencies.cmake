# Everything the libraries link, for the build and, installed, for consumers of the package, who may want the core alone
# (bespoke_FIND_COMPONENTS). Order matters:
# OpenVDB's module directory has a FindTBB of its own that clashes with TBBConfig, so TBB and Eigen are
# found before that directory is appended.
include(CMakeFindDependencyMacro)
find_dependency(Threads)
find_dependency(TBB CONFIG)
find_dependency(Eigen3 3.3 CONFIG)
if(NOT bespoke_FIND_COMPONENTS STREQUAL "bespoke")
  find_dependency(OpenMesh CONFIG)
  find_dependency(meshoptimizer CONFIG)
endif()
find_dependency(nlohmann_json CONFIG)
find_dependency(OpenSSL COMPONENTS Crypto)
list(APPEND CMAKE_MODULE_PATH "/usr/lib/${CMAKE_CXX_LIBRARY_ARCHITECTURE}/cmake/OpenVDB")
# FindOpenVDB turns BUILD_SHARED_LIBS on for whoever calls it.
set(bespoke_shared_libs "${BUILD_SHARED_LIBS}")
find_dependency(OpenVDB 8.0 MODULE COMPONENTS openvdb)
set(BUILD_SHARED_LIBS "${bespoke_shared_libs}")
unset(bespoke_shared_libs)
if(bespoke_FIND_COMPONENTS STREQUAL "bespoke")
  return()
endif()
find_dependency(ZLIB)
find_dependency(EXPAT)
find_dependency(PNG)
# Without packages for CMake: their headers are found by their directories, and they are linked by their names. libzip has
# one, which on Debian wants its command line tools as well.
find_path(BESPOKE_CAIRO cairo/cairo-pdf.h REQUIRED)
find_path(BESPOKE_POLYCLIPPING polyclipping/clipper.hpp REQUIRED)
find_path(BESPOKE_ZIP zip.h REQUIRED)
mark_as_advanced(BESPOKE_CAIRO BESPOKE_POLYCLIPPING BESPOKE_ZIP)
