# tautline_lcm_types(target [PACKAGE name] FILES a.lcm …): C++ bindings of LCM types, generated at build time with Debian's
# lcm-gen (Debian's LCM ships no CMake configuration). Headers land in <build>/lcmtypes/<package>/*.hpp and are included as
# <tautline/name_t.hpp>.
function(tautline_lcm_types target)
  cmake_parse_arguments(ARG "" "PACKAGE" "FILES" ${ARGN})
  if(NOT ARG_PACKAGE)
    set(ARG_PACKAGE tautline)
  endif()
  set(out "${CMAKE_BINARY_DIR}/lcmtypes")
  set(headers "")
  set(inputs "")
  foreach(file ${ARG_FILES})
    get_filename_component(name "${file}" NAME_WE)
    list(APPEND headers "${out}/${ARG_PACKAGE}/${name}.hpp")
    list(APPEND inputs "${CMAKE_CURRENT_SOURCE_DIR}/${file}")
  endforeach()
  add_custom_command(OUTPUT ${headers}
    COMMAND "${LCM_GEN}" -x --cpp-std c++11 --cpp-hpath "${out}" ${inputs}
    DEPENDS ${inputs} COMMENT "Generating LCM types" VERBATIM)
  add_custom_target(${target}_generate DEPENDS ${headers})
  add_library(${target} INTERFACE)
  add_dependencies(${target} ${target}_generate)
  target_include_directories(${target} SYSTEM INTERFACE "${out}")
  if(TAUTLINE_SANITIZE MATCHES "undefined")
    # LCM's own C++ header calls its handlers through pointers to members; the null check of g++ 12 stops there although
    # the object is there (the same calls run in every other build).
    target_compile_options(${target} INTERFACE -fno-sanitize=null)
  endif()
  target_link_libraries(${target} INTERFACE PkgConfig::LCM)
endfunction()

# tautline_lcm_message_table(target FUNCTION f TYPES target FILES a.lcm …): library with `MessageTable f()` of
# lcmtypes/message_table.h for types that tautline_lcm_types made.
function(tautline_lcm_message_table target)
  cmake_parse_arguments(ARG "" "FUNCTION;TYPES" "FILES" ${ARGN})
  set(script "${CMAKE_SOURCE_DIR}/toolchain/lcm_message_table.py")
  set(table "${CMAKE_CURRENT_BINARY_DIR}/${target}.cpp")
  list(TRANSFORM ARG_FILES PREPEND "${CMAKE_CURRENT_SOURCE_DIR}/" OUTPUT_VARIABLE inputs)
  add_custom_command(OUTPUT "${table}"
    COMMAND "${PYTHON3}" "${script}" ${ARG_FUNCTION} "${table}" ${inputs}
    DEPENDS "${script}" ${inputs} COMMENT "Generating the table of LCM messages" VERBATIM)
  tautline_library(${target} SOURCES "${table}" LINK ${ARG_TYPES})
endfunction()
