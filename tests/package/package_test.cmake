# Installs this build into a temporary prefix, builds the consumer against it with find_package and with pkg-config, and runs both.
# Configures the consumer with FetchContent from the source tree; with -DFETCH=ON that alone, built and run too, which compiles the
# library a second time. Nothing is downloaded.
#   cmake -DSOURCE=... -DBUILD=... -DWORK=... [-DFETCH=ON] -P package_test.cmake
cmake_minimum_required(VERSION 3.25)

function(run title)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${title} failed (${status}): ${ARGN}\n${output}")
  endif()
  message(STATUS "${title}: passed")
  set(output "${output}" PARENT_SCOPE)
endfunction()

function(expect_file path)
  if(NOT EXISTS "${path}")
    message(FATAL_ERROR "installation: expected ${path}")
  endif()
endfunction()

set(consumer ${CMAKE_CURRENT_LIST_DIR}/consumer)
file(REMOVE_RECURSE ${WORK})
file(MAKE_DIRECTORY ${WORK})

# As a part of another build: the library alone, no samples, no tests, no installation.
run("configure with FetchContent" ${CMAKE_COMMAND} -G Ninja -S ${consumer} -B ${WORK}/fetched
    -DCONSUMER_FETCH=ON -DFETCHCONTENT_FULLY_DISCONNECTED=ON -DFETCHCONTENT_SOURCE_DIR_LIGHTWELL=${SOURCE}
    -DCMAKE_BUILD_TYPE=Debug)
run("install rules with FetchContent" ${CMAKE_COMMAND} --install ${WORK}/fetched --prefix ${WORK}/none)
file(GLOB_RECURSE left ${WORK}/none/*)
if(left)
  message(FATAL_ERROR "as a part of another build Lightwell must install nothing, but left ${left}")
endif()
run("targets with FetchContent" ${CMAKE_COMMAND} --build ${WORK}/fetched --target help)
if(output MATCHES "lightwell_cli|studio|kernel_rig|_test:|lightwell_python" OR NOT output MATCHES "lightwell: phony")
  message(FATAL_ERROR "as a part of another build Lightwell must be its library alone, but has\n${output}")
endif()
if(FETCH)
  run("build with FetchContent" ${CMAKE_COMMAND} --build ${WORK}/fetched --parallel)
  run("run with FetchContent" ${WORK}/fetched/consumer)
  return()
endif()

# Installed.
set(prefix ${WORK}/prefix)
run("install" ${CMAKE_COMMAND} --install ${BUILD} --prefix ${prefix})
expect_file(${prefix}/include/lightwell/lightwell.h)
file(GLOB_RECURSE installed RELATIVE ${prefix} ${prefix}/*)
list(FILTER installed EXCLUDE REGEX
     "^include/lightwell/|^lib[^/]*/(.*/)?(liblightwell\\.|cmake/lightwell/|pkgconfig/lightwell)|^bin/lightwell|^share/(doc/)?lightwell/|^share/man/man1/lightwell\\.1$|^share/(bash-completion/completions/lightwell|zsh/site-functions/_lightwell|fish/vendor_completions\\.d/lightwell\\.fish)$")
if(installed)
  message(FATAL_ERROR "installation: files that are not Lightwell's: ${installed}")
endif()
expect_file(${prefix}/share/man/man1/lightwell.1)
# The name that programs ask the loader for has the number of the ABI that tests/package/abi.txt lists.
file(STRINGS ${SOURCE}/tests/package/abi.txt abi LIMIT_COUNT 1)
string(REGEX MATCH "ABI ([0-9]+)" abi "${abi}")
file(GLOB_RECURSE library ${prefix}/liblightwell.so.${CMAKE_MATCH_1})
if(NOT library)
  message(FATAL_ERROR "installation: expected liblightwell.so.${CMAKE_MATCH_1}")
endif()
run("configure with find_package" ${CMAKE_COMMAND} -G Ninja -S ${consumer} -B ${WORK}/found
    -DCMAKE_PREFIX_PATH=${prefix})
run("build with find_package" ${CMAKE_COMMAND} --build ${WORK}/found)
run("run with find_package" ${WORK}/found/consumer)
message(STATUS "${output}")
# Another major version, or a later minor one before 1.0, is refused.
execute_process(COMMAND ${CMAKE_COMMAND} -DCMAKE_PREFIX_PATH=${prefix} -P ${CMAKE_CURRENT_LIST_DIR}/version_test.cmake
                RESULT_VARIABLE status ERROR_VARIABLE errors OUTPUT_VARIABLE errors)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "version check: ${errors}")
endif()

# Without CMake.
find_program(pkg_config NAMES pkg-config)
if(pkg_config)
  file(GLOB_RECURSE pc ${prefix}/lightwell.pc)
  get_filename_component(pc_folder "${pc}" DIRECTORY)
  get_filename_component(library_folder "${library}" DIRECTORY)
  set(ENV{PKG_CONFIG_PATH} ${pc_folder})
  execute_process(COMMAND ${pkg_config} --cflags --libs lightwell OUTPUT_VARIABLE flags COMMAND_ERROR_IS_FATAL ANY)
  separate_arguments(flags UNIX_COMMAND "${flags}")
  run("build with pkg-config" cc ${consumer}/consumer.c -o ${WORK}/without_cmake ${flags} -Wl,-rpath,${library_folder})
  run("run with pkg-config" ${WORK}/without_cmake)
else()
  message(STATUS "pkg-config is not installed: that way is not tested")
endif()
