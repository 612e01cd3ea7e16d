# Time limits of the suites from budgets.txt: three times the budget, so that a hanging suite ends and a
# busy machine does not fail one. Included last in tests/CMakeLists.txt.
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${CMAKE_CURRENT_LIST_DIR}/budgets.txt")
file(STRINGS "${CMAKE_CURRENT_LIST_DIR}/budgets.txt" lines REGEX "^[a-z]")
foreach(line IN LISTS lines)
  string(REGEX REPLACE "^([^ ]+) +([0-9]+) *$" "\\1;\\2" pair "${line}")
  list(GET pair 0 name)
  list(GET pair 1 seconds)
  set(budget_${name} ${seconds})
endforeach()
get_property(suites DIRECTORY PROPERTY TESTS)
foreach(suite IN LISTS suites)
  if(NOT DEFINED budget_${suite})
    set(budget_${suite} 60)
  endif()
  math(EXPR limit "3 * ${budget_${suite}}")
  set_tests_properties(${suite} PROPERTIES TIMEOUT ${limit})
endforeach()

# CTest runs two suites at once. Most of a suite's time is one thread that compiles kernels, so that two fill two cores; of those that
# measure times one runs at most, and of those in a simulator or another driver, which use all cores by themselves.
foreach(suite IN LISTS suites)
  get_test_property(${suite} LABELS labels)
  if("${labels}" MATCHES "oclgrind|rusticl")
    set_tests_properties(${suite} PROPERTIES RESOURCE_LOCK simulator)
  elseif(suite MATCHES "^(auto|bench|chart|cli|compute|plan|plan_cli|planner|split|stability|steering)_test$")
    set_tests_properties(${suite} PROPERTIES RESOURCE_LOCK times)
  endif()
endforeach()
