# Fails unless CTest knows exactly the scenarios that the program lists.
execute_process(COMMAND ${PROGRAM} --list-test-names-only OUTPUT_QUIET RESULT_VARIABLE listed)
execute_process(COMMAND ${CTEST} --test-dir ${BINARY_DIR} -N -R "^scenario\\." OUTPUT_VARIABLE known)
string(REGEX MATCH "Total Tests: ([0-9]+)" unused "${known}")
math(EXPR registered "${CMAKE_MATCH_1} - 1") # without this comparison
if(NOT listed EQUAL registered OR listed EQUAL 0)
  message(FATAL_ERROR "the program lists ${listed} scenarios, CTest runs ${registered}")
endif()
message("${listed} scenarios, all registered")
