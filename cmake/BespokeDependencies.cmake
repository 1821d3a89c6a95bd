# Everything the library links. Order matters: OpenVDB's module directory has a FindTBB of its own that
# clashes with TBBConfig, so TBB, Eigen and OpenMesh are found before that directory is appended.
find_package(Threads REQUIRED)
find_package(TBB CONFIG REQUIRED)
find_package(Eigen3 3.3 CONFIG REQUIRED)
find_package(OpenMesh CONFIG REQUIRED)
find_package(nlohmann_json CONFIG REQUIRED)
find_package(OpenSSL REQUIRED COMPONENTS Crypto)
list(APPEND CMAKE_MODULE_PATH
     "/usr/lib/${CMAKE_CXX_LIBRARY_ARCHITECTURE}/cmake/OpenVDB")
find_package(OpenVDB 8.0 MODULE REQUIRED COMPONENTS openvdb)
