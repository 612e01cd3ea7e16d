# Installation: library, headers, find_package(lightwell), pkg-config. Included once the target exists. Components, as packages have
# them: runtime (the library), dev (what builds against it), tools (the command line, in samples/).
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

install(TARGETS lightwell EXPORT lightwellTargets
        LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT runtime NAMELINK_COMPONENT dev
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT dev
        RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT runtime
        INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/lightwell DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT dev)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/lightwell COMPONENT licence)

# The library's own dependencies (OpenCL's loader) are private: its users need none of them to build.
set(package_directory ${CMAKE_INSTALL_LIBDIR}/cmake/lightwell)
install(EXPORT lightwellTargets NAMESPACE lightwell:: DESTINATION ${package_directory} FILE lightwellConfig.cmake COMPONENT dev)
# Before 1.0 a minor version may break the interface.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/lightwellConfigVersion.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/lightwellConfigVersion.cmake DESTINATION ${package_directory} COMPONENT dev)

# Paths relative to the file itself, so that the installation can be moved.
file(RELATIVE_PATH pc_to_prefix /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
string(REGEX REPLACE "/$" "" pc_to_prefix "${pc_to_prefix}")
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/lightwell.pc @ONLY CONTENT
"prefix=\${pcfiledir}/@pc_to_prefix@
libdir=\${prefix}/@CMAKE_INSTALL_LIBDIR@
includedir=\${prefix}/@CMAKE_INSTALL_INCLUDEDIR@

Name: lightwell
Description: @PROJECT_DESCRIPTION@
Version: @PROJECT_VERSION@
Libs: -L\${libdir} -llightwell
Cflags: -I\${includedir}
")
install(FILES ${PROJECT_BINARY_DIR}/lightwell.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT dev)
