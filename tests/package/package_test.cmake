# Installs this build into a temporary prefix and builds the consumer against it with find_package, then
# builds the consumer with FetchContent from the source tree; runs both. Nothing is downloaded.
#   cmake -DSOURCE=... -DBUILD=... -DWORK=... -P package_test.cmake
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

# Installed.
set(prefix ${WORK}/prefix)
run("install" ${CMAKE_COMMAND} --install ${BUILD} --prefix ${prefix})
expect_file(${prefix}/include/lightwell/lightwell.h)
file(GLOB_RECURSE installed RELATIVE ${prefix} ${prefix}/*)
list(FILTER installed EXCLUDE REGEX
     "^include/lightwell/|^lib[^/]*/(.*/)?(liblightwell\\.|cmake/lightwell/|pkgconfig/lightwell)|^bin/lightwell|^share/(doc/)?lightwell/")
if(installed)
  message(FATAL_ERROR "installation: files that are not Lightwell's: ${installed}")
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

# As a part of another build: the library alone, no samples, no tests, no installation.
run("configure with FetchContent" ${CMAKE_COMMAND} -G Ninja -S ${consumer} -B ${WORK}/fetched
    -DCONSUMER_FETCH=ON -DFETCHCONTENT_FULLY_DISCONNECTED=ON -DFETCHCONTENT_SOURCE_DIR_LIGHTWELL=${SOURCE}
    -DCMAKE_BUILD_TYPE=Debug)
run("build with FetchContent" ${CMAKE_COMMAND} --build ${WORK}/fetched --parallel)
run("run with FetchContent" ${WORK}/fetched/consumer)
run("install rules with FetchContent" ${CMAKE_COMMAND} --install ${WORK}/fetched --prefix ${WORK}/none)
file(GLOB_RECURSE left ${WORK}/none/*)
if(left)
  message(FATAL_ERROR "as a part of another build Lightwell must install nothing, but left ${left}")
endif()
