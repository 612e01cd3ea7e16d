# Debian packages by cpack: liblightwell<ABI> (the library), liblightwell-dev, lightwell-tools. Included last, with preset package.
# docs/packaging.md tells how they are made and tested.
set(library_package liblightwell${LIGHTWELL_ABI})

# Each package names its licence and its changes, as Debian asks.
find_program(LIGHTWELL_GZIP gzip REQUIRED)
set(documents ${PROJECT_BINARY_DIR}/package)
file(MAKE_DIRECTORY ${documents})
file(WRITE ${documents}/copyright
"Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/
Upstream-Name: Lightwell

Files: *
Copyright: 2026 The Lightwell authors
License: Apache-2.0
 On Debian systems the text of the Apache License, Version 2.0, is in /usr/share/common-licenses/Apache-2.0.
")
# -n: neither name nor time, so that the same sources make the same file.
execute_process(COMMAND ${LIGHTWELL_GZIP} -9nc ${PROJECT_SOURCE_DIR}/CHANGELOG.md OUTPUT_FILE ${documents}/changelog.gz COMMAND_ERROR_IS_FATAL ANY)
foreach(pair "runtime;${library_package}" "dev;liblightwell-dev" "tools;lightwell-tools")
  list(GET pair 0 component)
  list(GET pair 1 package)
  install(FILES ${documents}/copyright ${documents}/changelog.gz DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${package} COMPONENT ${component})
  string(TOUPPER ${component} upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${package})
endforeach()

set(CPACK_GENERATOR DEB)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL runtime dev tools)
set(CPACK_COMPONENTS_GROUPING ONE_PER_GROUP)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_NAME} built using CMake")  # CPack's default, which gives way to each package's own
set(CPACK_PACKAGE_CONTACT "The Lightwell authors <lightwell@localhost>")
set(CPACK_PACKAGE_VENDOR Lightwell)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION libs)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
# Dependencies on other packages' libraries are read from the binaries; our own stands in the build folder.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${PROJECT_BINARY_DIR}/src)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)  # and scripts that run ldconfig
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS_POLICY ">=")  # a later library runs what was built against an earlier one of its ABI
set(CPACK_DEBIAN_ENABLE_COMPONENT_DEPENDS ON)

set(CPACK_COMPONENT_RUNTIME_DESCRIPTION "indirect light for any renderer, on any OpenCL device
A renderer hands over the G-buffers of its views and the reflective shadow
maps of its lights and gets indirect diffuse irradiance back. This package
holds the shared library; it needs an OpenCL driver.")
set(CPACK_DEBIAN_RUNTIME_PACKAGE_RECOMMENDS "pocl-opencl-icd | opencl-icd")

set(CPACK_COMPONENT_DEV_DESCRIPTION "indirect light for any renderer: development files
The C and C++ headers of Lightwell and what CMake and pkg-config need to
find it.")
set(CPACK_COMPONENT_DEV_DEPENDS runtime)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEV_PACKAGE_SHLIBDEPS OFF)

set(CPACK_COMPONENT_TOOLS_DESCRIPTION "indirect light for any renderer: command line
The program lightwell renders scenes with the library's techniques,
path-traces the truth and says how far the one is from the other. Small
scenes are included.")
set(CPACK_COMPONENT_TOOLS_DEPENDS runtime)
set(CPACK_DEBIAN_TOOLS_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_TOOLS_PACKAGE_SUGGESTS "python3-matplotlib, node-d3")
include(CPack)
