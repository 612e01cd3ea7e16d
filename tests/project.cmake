# Suites about the project rather than one piece of code: packaging, documentation, foreign conventions,
# kernels under other OpenCL implementations. Included by tests/CMakeLists.txt.

# lightwell_tool_test(NAME TOOL program COMMAND ...): a suite that is skipped, and says so, without its tool.
function(lightwell_tool_test name)
  cmake_parse_arguments(TEST "" "TOOL" "COMMAND" ${ARGN})
  find_program(LIGHTWELL_TOOL_${TEST_TOOL} ${TEST_TOOL})
  if(LIGHTWELL_TOOL_${TEST_TOOL})
    add_test(NAME ${name} COMMAND ${TEST_COMMAND} WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
  else()
    add_test(NAME ${name} COMMAND ${CMAKE_COMMAND} -E echo "SKIPPED: ${TEST_TOOL} is not installed")
  endif()
  set_tests_properties(${name} PROPERTIES SKIP_REGULAR_EXPRESSION "SKIPPED:")
endfunction()

# --- documentation
add_test(NAME docs_test COMMAND ${CMAKE_COMMAND} -DSOURCE=${PROJECT_SOURCE_DIR}
         -P ${CMAKE_CURRENT_SOURCE_DIR}/docs/docs_test.cmake)
# The site builds without a warning, and its links lead somewhere; it says itself where doxygen is missing.
lightwell_tool_test(docs_site_test TOOL python3 COMMAND python3 docs/site.py ${CMAKE_CURRENT_BINARY_DIR}/site)

# The C and C++ compilers both take the public headers, with every warning an error.
add_library(header_check OBJECT docs/header_check.c docs/header_check.cpp)
target_include_directories(header_check PRIVATE ${PROJECT_SOURCE_DIR}/include)
target_compile_options(header_check PRIVATE -pedantic -Wall -Wextra -Wshadow -Wconversion -Werror
  $<$<COMPILE_LANGUAGE:C>:-std=c99>)

# README's program, as it stands there.
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/README.md)
file(READ ${PROJECT_SOURCE_DIR}/README.md readme)
if(readme MATCHES "```c\n([^`]*)```")
  file(CONFIGURE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/readme_program.c CONTENT "${CMAKE_MATCH_1}" @ONLY)
  add_library(readme_program OBJECT ${CMAKE_CURRENT_BINARY_DIR}/readme_program.c)
  target_include_directories(readme_program PRIVATE ${PROJECT_SOURCE_DIR}/include)
  target_link_libraries(readme_program PRIVATE lightwell_warnings)
else()
  message(FATAL_ERROR "README.md: expected a program between ```c and ```")
endif()

# The skeleton that docs/adding-a-technique.md shows.
lightwell_test(skeleton_test SOURCES skeleton/skeleton_test.cpp skeleton/ambient_sky.cpp LIBS kernel_rig
  LABELS unit)

# --- the library as its users get it
lightwell_tool_test(symbols_test TOOL nm COMMAND ${CMAKE_COMMAND} -DNM=nm -DLIBRARY=$<TARGET_FILE:lightwell>
  -DHEADER=${PROJECT_SOURCE_DIR}/include/lightwell/lightwell.h
  -P ${CMAKE_CURRENT_SOURCE_DIR}/package/symbols_test.cmake)
if(NOT LIGHTWELL_SANITIZE)  # a consumer without the sanitizers cannot load a library with them
  add_test(NAME package_test COMMAND ${CMAKE_COMMAND} -DSOURCE=${PROJECT_SOURCE_DIR} -DBUILD=${PROJECT_BINARY_DIR}
           -DWORK=${CMAKE_CURRENT_BINARY_DIR}/package -P ${CMAKE_CURRENT_SOURCE_DIR}/package/package_test.cmake)
  # Once more with what compiles the library again.
  add_test(NAME package_fetch_test COMMAND ${CMAKE_COMMAND} -DSOURCE=${PROJECT_SOURCE_DIR} -DBUILD=${PROJECT_BINARY_DIR} -DFETCH=ON
           -DWORK=${CMAKE_CURRENT_BINARY_DIR}/package_fetch -P ${CMAKE_CURRENT_SOURCE_DIR}/package/package_test.cmake)
  add_test(NAME deb_test COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/package/deb_test.sh ${PROJECT_SOURCE_DIR} ${CMAKE_CURRENT_BINARY_DIR}/deb)
  set_tests_properties(deb_test PROPERTIES SKIP_REGULAR_EXPRESSION "SKIPPED:")
  set_tests_properties(package_fetch_test deb_test PROPERTIES LABELS long)
endif()
lightwell_tool_test(abi_test TOOL python3 COMMAND python3 ${CMAKE_CURRENT_SOURCE_DIR}/package/abi_test.py)
if(TARGET lightwell_cli)
  lightwell_tool_test(completion_test TOOL python3 COMMAND python3 ${CMAKE_CURRENT_SOURCE_DIR}/cli/completion_test.py $<TARGET_FILE:lightwell_cli>
    Complete Manual)
  lightwell_tool_test(completion_shells_test TOOL python3 COMMAND python3 ${CMAKE_CURRENT_SOURCE_DIR}/cli/completion_test.py
    $<TARGET_FILE:lightwell_cli> Shells)
  set_tests_properties(completion_test PROPERTIES LABELS cli)
  set_tests_properties(completion_shells_test PROPERTIES LABELS long)
endif()

# --- the Python package, beside the library that was just built
if(TARGET lightwell_python AND NOT LIGHTWELL_SANITIZE)  # Python itself is not instrumented
  include(${PROJECT_SOURCE_DIR}/samples/python/find_python.cmake)
  lightwell_find_python(LIGHTWELL_TEST_PYTHON cffi numpy)
endif()
if(LIGHTWELL_TEST_PYTHON)
  add_executable(same_frame python/same_frame.c)
  target_link_libraries(same_frame PRIVATE lightwell lightwell_warnings)
  set(python_environment ${CMAKE_COMMAND} -E env LIGHTWELL_SAME_FRAME=$<TARGET_FILE:same_frame>)
  add_test(NAME python_test COMMAND ${python_environment} PYTHONPATH=${PROJECT_BINARY_DIR}/python ${LIGHTWELL_TEST_PYTHON} -B
           -m unittest discover -s ${CMAKE_CURRENT_SOURCE_DIR}/python)
  add_test(NAME wheel_test COMMAND ${python_environment} bash ${CMAKE_CURRENT_SOURCE_DIR}/python/wheel_test.sh ${PROJECT_SOURCE_DIR}
           ${CMAKE_CURRENT_BINARY_DIR}/wheel ${LIGHTWELL_TEST_PYTHON})
  set_tests_properties(wheel_test PROPERTIES LABELS long SKIP_REGULAR_EXPRESSION "SKIPPED:")
else()
  add_test(NAME python_test COMMAND ${CMAKE_COMMAND} -E echo "SKIPPED: needs Python 3 with NumPy and cffi (python3-numpy, python3-cffi), and a build without sanitizers")
  set_tests_properties(python_test PROPERTIES SKIP_REGULAR_EXPRESSION "SKIPPED:")
endif()
set_tests_properties(python_test PROPERTIES LABELS api)

# docs/getting-started.md's program: exit code 0 means that its answer is right.
add_executable(minimal ${PROJECT_SOURCE_DIR}/samples/minimal.c)
target_link_libraries(minimal PRIVATE lightwell lightwell_warnings)
set_target_properties(minimal PROPERTIES C_STANDARD 99 C_EXTENSIONS OFF)
add_test(NAME getting_started_test COMMAND minimal)
# The program of docs/points.md.
add_executable(points ${PROJECT_SOURCE_DIR}/samples/points.c)
target_link_libraries(points PRIVATE lightwell lightwell_warnings m)
add_test(NAME points_sample_test COMMAND points)
# A host's own queue and images in OpenCL; docs/integration.md.
add_executable(adopt_queue ${PROJECT_SOURCE_DIR}/samples/adopt_queue.cpp)
target_link_libraries(adopt_queue PRIVATE lightwell lightwell_warnings OpenCL::OpenCL)
add_test(NAME adopt_queue_test COMMAND adopt_queue)

# --- a frame that shares no convention and no code with us
lightwell_test(foreign_test SOURCES foreign/foreign_test.cpp LIBS lightwell LABELS images)
add_test(NAME foreign_test_uploads COMMAND foreign_test)
set_tests_properties(foreign_test_uploads PROPERTIES LABELS images ENVIRONMENT LIGHTWELL_UNIFIED_MEMORY=0)
target_compile_definitions(foreign_test PRIVATE
  LIGHTWELL_FOREIGN_FRAME="${CMAKE_CURRENT_SOURCE_DIR}/foreign/frame")

# --- benchmarks: each runs once here; docs/performance.md says how to measure
if(LIGHTWELL_BUILD_BENCH)
  find_package(benchmark REQUIRED)
  add_executable(lightwell_bench bench/bench.cpp bench/static_vpl_cases.cpp)
  target_link_libraries(lightwell_bench PRIVATE lightwell lightwell_warnings benchmark::benchmark)
  add_test(NAME bench_test COMMAND lightwell_bench --benchmark_min_time=0.001)
  set_tests_properties(bench_test PROPERTIES FAIL_REGULAR_EXPRESSION "ERROR OCCURRED")
endif()
