# find_package(manyhands CONFIG) gives the targets manyhands::manyhands and manyhands::manyhands_learn.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/manyhands)
install(TARGETS manyhands manyhands_learn manyhands_flags EXPORT manyhandsTargets)
install(EXPORT manyhandsTargets NAMESPACE manyhands:: DESTINATION ${package_dir})
install(DIRECTORY manyhands DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN "*.h" PATTERN "*.inl")
install(DIRECTORY assets/ DESTINATION ${CMAKE_INSTALL_DATADIR}/manyhands/assets)

configure_package_config_file(cmake/manyhandsConfig.cmake.in "${PROJECT_BINARY_DIR}/manyhandsConfig.cmake"
                              INSTALL_DESTINATION ${package_dir} PATH_VARS CMAKE_INSTALL_DATADIR)
write_basic_package_version_file("${PROJECT_BINARY_DIR}/manyhandsConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/manyhandsConfig.cmake" "${PROJECT_BINARY_DIR}/manyhandsConfigVersion.cmake"
              DESTINATION ${package_dir})
