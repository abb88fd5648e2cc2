# kaz_library and kaz_test: how every target of the tree is made, so that flags stand in one place.

# ccache, where present, makes the second build of the same source free.
find_program(KAZ_CCACHE ccache)
if(KAZ_CCACHE)
  set(CMAKE_C_COMPILER_LAUNCHER ${KAZ_CCACHE})
  set(CMAKE_CXX_COMPILER_LAUNCHER ${KAZ_CCACHE})
endif()

add_library(kaz_flags INTERFACE)
# No contraction into fused multiply-add: the same source must give the same bits (docs/decisions.md).
target_compile_options(kaz_flags INTERFACE -Wall -Wextra -Wshadow -ffp-contract=off)
if(KAZ_WERROR)
  target_compile_options(kaz_flags INTERFACE -Werror)
endif()
if(KAZ_SANITIZE)
  target_compile_options(kaz_flags INTERFACE -fsanitize=${KAZ_SANITIZE} -fno-omit-frame-pointer
                                             -fno-sanitize-recover=all)
  # The instrumentation makes g++ 12 believe that library code uses uninitialised values.
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(kaz_flags INTERFACE -Wno-maybe-uninitialized)
  endif()
  target_link_options(kaz_flags INTERFACE -fsanitize=${KAZ_SANITIZE})
endif()
if(KAZ_COVERAGE)
  target_compile_options(kaz_flags INTERFACE --coverage)
  target_link_options(kaz_flags INTERFACE --coverage)
endif()

# kaz_library(NAME [STRICT] SOURCES ... [PUBLIC lib ...] [PRIVATE lib ...] [PCH header ...])
# Makes target kaz_NAME with the alias kaz::NAME. STRICT adds -Wconversion: for code whose result must be
# the same bit for bit on another machine. Headers are included by their path from the root of the tree.
function(kaz_library name)
  cmake_parse_arguments(ARG "STRICT" "" "SOURCES;PUBLIC;PRIVATE;PCH" ${ARGN})
  add_library(kaz_${name} STATIC ${ARG_SOURCES})
  add_library(kaz::${name} ALIAS kaz_${name})
  set_target_properties(kaz_${name} PROPERTIES EXPORT_NAME ${name})
  target_include_directories(kaz_${name} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
                                                $<BUILD_INTERFACE:${PROJECT_BINARY_DIR}/generated>
                                                $<INSTALL_INTERFACE:include/kaz>)
  target_link_libraries(kaz_${name} PRIVATE $<BUILD_INTERFACE:kaz_flags> ${ARG_PRIVATE} PUBLIC ${ARG_PUBLIC})
  if(ARG_STRICT)
    target_compile_options(kaz_${name} PRIVATE -Wconversion)
  endif()
  if(ARG_PCH)
    target_precompile_headers(kaz_${name} PRIVATE ${ARG_PCH})
  endif()
  install(TARGETS kaz_${name} EXPORT kaz)
endfunction()

# kaz_test(NAME SOURCES ... LIBS ... [SERIAL] [TIMEOUT seconds])
# One GoogleTest program NAME_test; each of its cases is a test of CTest's, with NAME as its label. SERIAL:
# nothing else runs beside it, for tests in real time.
function(kaz_test name)
  if(NOT BUILD_TESTING)
    return()
  endif()
  cmake_parse_arguments(ARG "SERIAL" "TIMEOUT" "SOURCES;LIBS" ${ARGN})
  find_package(GTest REQUIRED)
  include(GoogleTest)
  add_executable(${name}_test ${ARG_SOURCES})
  target_include_directories(${name}_test PRIVATE ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR}/generated)
  target_link_libraries(${name}_test PRIVATE kaz_flags ${ARG_LIBS} GTest::gtest_main)
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 120)
  endif()
  set(properties TIMEOUT ${ARG_TIMEOUT} LABELS ${name})
  if(ARG_SERIAL)
    list(APPEND properties RUN_SERIAL TRUE)
  endif()
  gtest_discover_tests(${name}_test TEST_PREFIX ${name}. PROPERTIES ${properties}
                       WORKING_DIRECTORY ${PROJECT_SOURCE_DIR} DISCOVERY_TIMEOUT 60)
endfunction()
