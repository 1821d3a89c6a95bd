# The library with its public headers, the command, and a package for find_package(bespoke).
include(CMakePackageConfigHelpers)
set(BESPOKE_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/bespoke)

foreach(header
    apply/apply_mapping asset/asset asset/asset_io atomic_file error fitting/anchor_audit
    fitting/anchor_placement fitting/anchors fitting/exact_map_io fitting/fit_mapping fitting/pffd
    fitting/surface_fit fitting/unmet_vertices mapping/elastic_map mapping/mapping mesh/closest_point
    mesh/mesh_io mesh/product_io mesh/triangle_mesh parallel pipeline/derive_map pipeline/make_map
    pipeline/method_names progress quality/distortion quality/mapping_quality quality/product_quality
    quality/self_intersection quality/signed_distance quality/surface_distance rbf/csrbf rbf/global_rbf
    rbf/kernels rbf/multiscale rbf/point_grid report/inspection report/quality_report report/report
    rigid/rigid_alignment rigid/rigid_transform statistics types volume/bake volume/baked_map
    volume/certificate volume/inverse volume/pyramid)
  cmake_path(GET header PARENT_PATH directory)
  install(FILES ${PROJECT_SOURCE_DIR}/src/bespoke/${header}.h
          DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/bespoke/${directory})
endforeach()

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
