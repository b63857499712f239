# tautline_library / tautline_program / tautline_test / tautline_benchmark / tautline_fuzzer:
# one set of flags and conventions for every target of the project.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM)
  set(CMAKE_CXX_COMPILER_LAUNCHER "${CCACHE_PROGRAM}")
endif()

add_library(tautline_flags INTERFACE)
target_compile_definitions(tautline_flags INTERFACE TAUTLINE_VERSION="${PROJECT_VERSION}")
target_include_directories(tautline_flags INTERFACE "${CMAKE_SOURCE_DIR}")
target_compile_options(tautline_flags INTERFACE
  -Wall -Wextra -Wpedantic -Werror -Wshadow -Wconversion -Wsign-conversion -Wdouble-promotion
  -Wnon-virtual-dtor -Woverloaded-virtual -Wold-style-cast -Wcast-qual -Wformat=2 -Wimplicit-fallthrough
  -ffp-contract=off)  # same floating-point results on x86-64 and aarch64
target_link_options(tautline_flags INTERFACE -Wl,-z,now)  # no symbol is looked up for the first time inside the loop
if(TAUTLINE_SANITIZE)
  target_compile_options(tautline_flags INTERFACE
    -fsanitize=${TAUTLINE_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(tautline_flags INTERFACE -fsanitize=${TAUTLINE_SANITIZE})
endif()

if(TAUTLINE_BUILD_FUZZERS)
  add_custom_target(fuzzers)
  # The libraries under test carry coverage and sanitizers; the fuzzer's own main is linked by tautline_fuzzer().
  target_compile_options(tautline_flags INTERFACE
    -fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(tautline_flags INTERFACE -fsanitize=address,undefined)
endif()

# tautline_library(name SOURCES a.cpp … LINK public targets … [PRIVATE_LINK …])
function(tautline_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK;PRIVATE_LINK" ${ARGN})
  if(ARG_SOURCES)
    add_library(${name} STATIC ${ARG_SOURCES})
    target_link_libraries(${name} PRIVATE tautline_flags ${ARG_PRIVATE_LINK} PUBLIC ${ARG_LINK})
    target_include_directories(${name} PUBLIC "${CMAKE_SOURCE_DIR}")
  else()
    add_library(${name} INTERFACE)
    target_link_libraries(${name} INTERFACE ${ARG_LINK})
    target_include_directories(${name} INTERFACE "${CMAKE_SOURCE_DIR}")
  endif()
endfunction()

# tautline_program(name SOURCES … LINK …): a program that users run.
function(tautline_program name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE tautline_flags ${ARG_LINK})
endfunction()

# tautline_test(name SOURCES … LINK … [LABELS fast|slow|vm] [TIMEOUT s]): a GoogleTest binary, one ctest entry.
if(TAUTLINE_BUILD_TESTS)
  add_custom_target(vm_tests)  # all tests with the label vm
  if(CMAKE_CROSSCOMPILING)
    include("${CMAKE_SOURCE_DIR}/toolchain/cross/filters.cmake")
  endif()
endif()
function(tautline_test name)
  if(NOT TAUTLINE_BUILD_TESTS)
    return()
  endif()
  cmake_parse_arguments(ARG "" "TIMEOUT" "SOURCES;LINK;LABELS" ${ARGN})
  if(NOT ARG_LABELS)
    set(ARG_LABELS fast)
  endif()
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 300)
  endif()
  add_executable(${name} ${ARG_SOURCES})
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/test")
  target_link_libraries(${name} PRIVATE tautline_flags ${ARG_LINK} GTest::gtest GTest::gmock GTest::gtest_main)
  target_compile_definitions(${name} PRIVATE TAUTLINE_SOURCE_DIR="${CMAKE_SOURCE_DIR}")
  set(filter "${TAUTLINE_CROSS_FILTER_${name}}")
  if(filter STREQUAL "NONE")
    set_target_properties(${name} PROPERTIES EXCLUDE_FROM_ALL ON)
    return()
  elseif(filter)
    set(filter "--gtest_filter=${filter}")
  endif()
  add_test(NAME ${name} COMMAND ${name} ${filter})
  set_tests_properties(${name} PROPERTIES LABELS "${ARG_LABELS}" TIMEOUT ${ARG_TIMEOUT})
  if("vm" IN_LIST ARG_LABELS)
    # Needs a kernel with SocketCAN (./run vcan); elsewhere ctest lists it as skipped, not as passed.
    set_tests_properties(${name} PROPERTIES SKIP_REGULAR_EXPRESSION "\\[  SKIPPED \\]")
    add_dependencies(vm_tests ${name})
  endif()
endfunction()

# tautline_script_test(name script [arguments …]): a script as a test; it finds the programs through TAUTLINE_BIN.
# Not in a cross-build: scripts start programs as programs of this machine.
function(tautline_script_test name script)
  if(NOT TAUTLINE_BUILD_TESTS OR CMAKE_CROSSCOMPILING)
    return()
  endif()
  add_test(NAME ${name} COMMAND "${CMAKE_CURRENT_SOURCE_DIR}/${script}" ${ARGN})
  set_tests_properties(${name} PROPERTIES LABELS fast TIMEOUT 300
    SKIP_RETURN_CODE 77 ENVIRONMENT
    "TAUTLINE_BIN=$<TARGET_FILE_DIR:tautline>;TAUTLINE_TEST_BIN=${CMAKE_BINARY_DIR}/test;TAUTLINE_SOURCE_DIR=${CMAKE_SOURCE_DIR}")
endfunction()

# tautline_benchmark(name [OWN_MAIN] SOURCES … LINK …): a Google Benchmark program in build/<preset>/benchmark, or with
# OWN_MAIN a program that measures and prints by itself.
function(tautline_benchmark name)
  if(NOT TAUTLINE_BUILD_BENCHMARKS)
    return()
  endif()
  cmake_parse_arguments(ARG "OWN_MAIN" "" "SOURCES;LINK" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/benchmark")
  target_link_libraries(${name} PRIVATE tautline_flags ${ARG_LINK})
  if(ARG_OWN_MAIN)
    target_compile_definitions(${name} PRIVATE TAUTLINE_SOURCE_DIR="${CMAKE_SOURCE_DIR}")
  else()
    target_link_libraries(${name} PRIVATE benchmark::benchmark benchmark::benchmark_main)
  endif()
endfunction()

# tautline_fuzzer(name SOURCE f.cpp CORPUS dir LINK …): with clang and TAUTLINE_BUILD_FUZZERS a libFuzzer program; always a
# ctest entry that runs the checked-in corpus through the same entry point.
function(tautline_fuzzer name)
  cmake_parse_arguments(ARG "" "SOURCE;CORPUS" "LINK" ${ARGN})
  if(TAUTLINE_BUILD_FUZZERS)
    add_executable(${name} ${ARG_SOURCE})
    add_dependencies(fuzzers ${name})
    set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/fuzz")
    target_link_options(${name} PRIVATE -fsanitize=fuzzer)
    target_link_libraries(${name} PRIVATE tautline_flags ${ARG_LINK})
  endif()
  if(TAUTLINE_BUILD_TESTS)
    add_executable(${name}_corpus ${ARG_SOURCE} "${CMAKE_SOURCE_DIR}/common/testing/run_corpus.cpp")
    set_target_properties(${name}_corpus PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/test")
    target_link_libraries(${name}_corpus PRIVATE tautline_flags ${ARG_LINK})
    add_test(NAME ${name}_corpus COMMAND ${name}_corpus "${ARG_CORPUS}")
    set_tests_properties(${name}_corpus PROPERTIES LABELS fast TIMEOUT 300)
  endif()
endfunction()
