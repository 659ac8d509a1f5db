# Functions that every folder's CMakeLists.txt uses. The link lists are the include walls.

# forcegate_library(NAME trace SOURCES a.cpp ... DEPS forcegate::base ... PRIVATE_DEPS hdf5 ...)
function(forcegate_library)
  cmake_parse_arguments(ARG "" "NAME" "SOURCES;DEPS;PRIVATE_DEPS" ${ARGN})
  add_library(forcegate_${ARG_NAME} STATIC ${ARG_SOURCES})
  add_library(forcegate::${ARG_NAME} ALIAS forcegate_${ARG_NAME})
  target_include_directories(forcegate_${ARG_NAME} PUBLIC ${PROJECT_SOURCE_DIR})
  target_link_libraries(forcegate_${ARG_NAME} PUBLIC ${ARG_DEPS} PRIVATE ${ARG_PRIVATE_DEPS} forcegate_options)
endfunction()

# forcegate_plugins(NAME stimuli DEPS ... PRIVATE_DEPS ...): every .cpp of the folder is a plug-in. OBJECT
# library, because self-registering objects vanish from static ones; link forcegate::NAME into the program.
function(forcegate_plugins)
  cmake_parse_arguments(ARG "" "NAME" "DEPS;PRIVATE_DEPS" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp)
  add_library(forcegate_${ARG_NAME}_objects OBJECT ${sources})
  target_include_directories(forcegate_${ARG_NAME}_objects PUBLIC ${PROJECT_SOURCE_DIR})
  target_link_libraries(forcegate_${ARG_NAME}_objects PUBLIC ${ARG_DEPS} ${ARG_PRIVATE_DEPS} PRIVATE forcegate_options)
  add_library(forcegate_${ARG_NAME} INTERFACE)
  add_library(forcegate::${ARG_NAME} ALIAS forcegate_${ARG_NAME})
  target_sources(forcegate_${ARG_NAME} INTERFACE $<TARGET_OBJECTS:forcegate_${ARG_NAME}_objects>)
  target_link_libraries(forcegate_${ARG_NAME} INTERFACE ${ARG_DEPS} ${ARG_PRIVATE_DEPS})
  add_dependencies(forcegate_${ARG_NAME} forcegate_${ARG_NAME}_objects)
endfunction()

# forcegate_unit_tests(trace DEPS ...): all *_test.cpp of the folder and below it become one GoogleTest program unit_trace.
function(forcegate_unit_tests name)
  cmake_parse_arguments(ARG "" "" "DEPS" ${ARGN})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*_test.cpp)
  if(NOT sources)
    return()
  endif()
  add_executable(unit_${name} ${sources})
  target_link_libraries(unit_${name} PRIVATE ${ARG_DEPS} GTest::gtest_main GTest::gmock forcegate_options)
  target_compile_definitions(unit_${name} PRIVATE FORCEGATE_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
                                                  FORCEGATE_BINARY_DIR="${PROJECT_BINARY_DIR}")
  gtest_discover_tests(unit_${name} TEST_PREFIX "unit.${name}." DISCOVERY_TIMEOUT 60
                       PROPERTIES LABELS unit TIMEOUT 300)
endfunction()

# forcegate_fuzzer(csv DEPS ...): tests/fuzz/fuzz_csv.cpp with LLVMFuzzerTestOneInput. In a normal build it gets a
# plain main that replays tests/fuzz/corpus/csv/* as a test; with FORCEGATE_FUZZ=ON it is a libFuzzer program.
function(forcegate_fuzzer name)
  cmake_parse_arguments(ARG "" "" "DEPS" ${ARGN})
  if(FORCEGATE_FUZZ)
    add_executable(fuzz_${name} fuzz_${name}.cpp)
    target_compile_options(fuzz_${name} PRIVATE -fsanitize=fuzzer)
    target_link_options(fuzz_${name} PRIVATE -fsanitize=fuzzer)
  else()
    add_executable(fuzz_${name} fuzz_${name}.cpp replay_main.cpp)
    add_test(NAME fuzz.replay.${name} COMMAND fuzz_${name} ${CMAKE_CURRENT_SOURCE_DIR}/corpus/${name})
    set_tests_properties(fuzz.replay.${name} PROPERTIES LABELS fuzz TIMEOUT 300)
  endif()
  target_link_libraries(fuzz_${name} PRIVATE ${ARG_DEPS} forcegate_options)
endfunction()

# forcegate_hot(a.cpp ...): what runs at every sample of a record. Same bits as -O2, some of it faster.
function(forcegate_hot)
  set_source_files_properties(${ARGN} PROPERTIES COMPILE_OPTIONS "$<$<CONFIG:RelWithDebInfo,Release>:-O3>")
endfunction()
