# kaz_library and kaz_test: how every target of the tree is made, so that flags stand in one place.

# ccache, where present, makes the second build of the same source free. The two kinds of sloppiness are
# those that its manual asks for with precompiled headers; no source here uses __TIME__ or __DATE__.
find_program(KAZ_CCACHE ccache)
if(KAZ_CCACHE)
  set(launcher ${CMAKE_COMMAND} -E env CCACHE_DEPEND=1 CCACHE_SLOPPINESS=pch_defines,time_macros ${KAZ_CCACHE})
  set(CMAKE_C_COMPILER_LAUNCHER ${launcher})
  set(CMAKE_CXX_COMPILER_LAUNCHER ${launcher})
endif()

# mold, where present, links in a tenth of the time that binutils' ld takes.
include(CheckLinkerFlag)
check_linker_flag(CXX -fuse-ld=mold KAZ_MOLD)
if(KAZ_MOLD)
  add_link_options(-fuse-ld=mold)
endif()

add_library(kaz_flags INTERFACE)
# No contraction into fused multiply-add: the same source must give the same bits (docs/decisions.md).
target_compile_options(kaz_flags INTERFACE -Wall -Wextra -Wshadow -ffp-contract=off)
# Sources that are compiled together (kaz_unity) make g++ 12 warn of types of another "main" file, and of lengths
# that an inlined std::string::replace cannot have.
if(KAZ_UNITY GREATER 1 AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  target_compile_options(kaz_flags INTERFACE $<$<COMPILE_LANGUAGE:CXX>:-Wno-subobject-linkage>
                                             $<$<COMPILE_LANGUAGE:CXX>:-Wno-stringop-overflow>
                                             $<$<COMPILE_LANGUAGE:CXX>:-Wno-restrict>)
endif()
# g++ collects its garbage whenever its memory has grown by this percentage. With its default (100 here) that is an
# eighth of the time that grouped sources take; without, a compiler uses 0.7 GB instead of 0.6.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  target_compile_options(kaz_flags INTERFACE $<$<COMPILE_LANGUAGE:CXX>:--param=ggc-min-expand=1000>)
endif()
if(KAZ_WERROR)
  target_compile_options(kaz_flags INTERFACE -Werror)
endif()
if(KAZ_SANITIZE)
  target_compile_options(kaz_flags INTERFACE -fsanitize=${KAZ_SANITIZE} -fno-omit-frame-pointer
                                             -fno-sanitize-recover=all)
  # The instrumentation makes g++ 12 believe that library code uses uninitialised values, or bytes beyond an object.
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(kaz_flags INTERFACE -Wno-maybe-uninitialized -Wno-array-bounds)
  endif()
  target_link_options(kaz_flags INTERFACE -fsanitize=${KAZ_SANITIZE})
endif()
if(KAZ_COVERAGE)
  target_compile_options(kaz_flags INTERFACE --coverage)
  target_link_options(kaz_flags INTERFACE --coverage)
endif()

# KAZ_SANITIZED_COPIES: some libraries are compiled a second time, under sanitizers, and their tests linked with both
# (SANITIZED below). Not where everything is compiled so already, nor for coverage or clang's fuzzer.
set(KAZ_SANITIZED_COPIES OFF)
# Without what the address sanitizer sees itself (null) and what takes long to compile (vptr); `./tools/dev study sanitize`
# has both.
set(KAZ_SANITIZERS -fsanitize=address,undefined,float-cast-overflow -fno-sanitize=null,vptr)
set(KAZ_SANITIZED_OPTIONS -O1 -g1 -UNDEBUG ${KAZ_SANITIZERS} -fno-omit-frame-pointer -fno-sanitize-recover=all)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  list(APPEND KAZ_SANITIZED_OPTIONS $<$<COMPILE_LANGUAGE:CXX>:-Wno-maybe-uninitialized>)
endif()
if(CMAKE_BUILD_TYPE STREQUAL "Release" AND (BUILD_TESTING OR NOT DEFINED BUILD_TESTING) AND NOT KAZ_SANITIZE
   AND NOT KAZ_COVERAGE)
  set(KAZ_SANITIZED_COPIES ON)
endif()

# Precompiled headers, one for each set of compiler flags; targets reuse them. What is in them: precompiled.h.
# kaz_pch_library: product code. kaz_pch_light: product code that waits, parses and reports, compiled with -O1 in
# release builds; kaz_pch_json: the same for libraries with JSON. kaz_pch_test: tests, with GoogleTest, -O1 too.
# kaz_pch_fast_test: tests that spend their time in their own code.
find_package(Eigen3 REQUIRED NO_MODULE)
function(kaz_precompiled name)
  cmake_parse_arguments(ARG "PROGRAM" "HEADER" "LIBS;OPTIONS" ${ARGN})
  add_library(kaz_pch_${name} OBJECT ${PROJECT_SOURCE_DIR}/tools/repo/cmake/precompiled.cpp)
  target_include_directories(kaz_pch_${name} PRIVATE ${PROJECT_SOURCE_DIR})
  # Programs are compiled with -fPIE, libraries with -fPIC; g++ takes a precompiled header only with the same.
  if(ARG_PROGRAM)
    set_target_properties(kaz_pch_${name} PROPERTIES POSITION_INDEPENDENT_CODE OFF)
    target_compile_options(kaz_pch_${name} PRIVATE -fPIE)
  endif()
  target_link_libraries(kaz_pch_${name} PRIVATE kaz_flags Eigen3::Eigen ${ARG_LIBS})
  target_compile_options(kaz_pch_${name} PRIVATE ${ARG_OPTIONS})
  target_precompile_headers(kaz_pch_${name} PRIVATE
    $<$<COMPILE_LANGUAGE:CXX>:${PROJECT_SOURCE_DIR}/tools/repo/cmake/${ARG_HEADER}>)
endfunction()

# -O1: code in which no run spends its time, and test programs. g++ needs a third less time for it.
# Inlining half of std::string there, g++ 12 warns of bounds that no string exceeds.
set(KAZ_LIGHT_OPTIONS $<$<CONFIG:Release>:-O1>)
set(KAZ_TEST_OPTIONS ${KAZ_LIGHT_OPTIONS})
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  list(APPEND KAZ_LIGHT_OPTIONS $<$<COMPILE_LANGUAGE:CXX>:-Wno-array-bounds>)
endif()
kaz_precompiled(library HEADER precompiled.h)
kaz_precompiled(light HEADER precompiled.h OPTIONS ${KAZ_LIGHT_OPTIONS})
kaz_precompiled(json HEADER precompiled_json.h OPTIONS ${KAZ_LIGHT_OPTIONS})
if(BUILD_TESTING OR NOT DEFINED BUILD_TESTING)
  find_package(GTest REQUIRED)
  kaz_precompiled(test PROGRAM HEADER precompiled_test.h LIBS GTest::gtest OPTIONS ${KAZ_TEST_OPTIONS})
  kaz_precompiled(fast_test PROGRAM HEADER precompiled_test.h LIBS GTest::gtest)
endif()
if(KAZ_SANITIZED_COPIES)
  kaz_precompiled(sanitized HEADER precompiled.h OPTIONS ${KAZ_SANITIZED_OPTIONS})
endif()

# kaz_reuse_precompiled(TARGET NAME): for targets with C++ sources whose compile options are those of NAME.
function(kaz_reuse_precompiled target name)
  get_target_property(sources ${target} SOURCES)
  list(FILTER sources INCLUDE REGEX "\\.cpp$")
  if(sources)
    target_precompile_headers(${target} REUSE_FROM kaz_pch_${name})
    # precompiled.h names headers of it, also where no precompiled one is used (clang-tidy).
    target_include_directories(${target} SYSTEM PRIVATE
      $<TARGET_PROPERTY:Eigen3::Eigen,INTERFACE_INCLUDE_DIRECTORIES>)
  endif()
endfunction()

# kaz_precompiled_program(TARGET [FAST]): the same for programs without kaz_test; where no tests are built, nothing.
# Unless FAST, its own code is compiled with -O1, as a test's.
function(kaz_precompiled_program target)
  if(NOT BUILD_TESTING)
    return()
  endif()
  # The header has GoogleTest, too: g++ takes it with the same macros only.
  target_compile_options(${target} PRIVATE $<TARGET_PROPERTY:GTest::gtest,INTERFACE_COMPILE_OPTIONS>)
  if("FAST" IN_LIST ARGN)
    kaz_reuse_precompiled(${target} fast_test)
  else()
    target_compile_options(${target} PRIVATE ${KAZ_TEST_OPTIONS})
    kaz_reuse_precompiled(${target} test)
  endif()
endfunction()

# kaz_sanitized_copy(TARGET): library TARGET_sanitized, with the sources and options of TARGET and the sanitizers, linked
# with the copies of what TARGET is linked with. Sees what was added to TARGET so far: call it last in its folder.
function(kaz_sanitized_copy target)
  if(NOT KAZ_SANITIZED_COPIES)
    return()
  endif()
  get_target_property(folder ${target} SOURCE_DIR)
  get_target_property(sources ${target} SOURCES)
  set(absolute "")
  foreach(source IN LISTS sources)
    cmake_path(ABSOLUTE_PATH source BASE_DIRECTORY ${folder} NORMALIZE)
    list(APPEND absolute ${source})
  endforeach()
  add_library(${target}_sanitized STATIC ${absolute})
  foreach(property INCLUDE_DIRECTORIES INTERFACE_INCLUDE_DIRECTORIES COMPILE_DEFINITIONS INTERFACE_COMPILE_DEFINITIONS
                   COMPILE_OPTIONS)
    get_target_property(value ${target} ${property})
    if(value)
      set_target_properties(${target}_sanitized PROPERTIES ${property} "${value}")
    endif()
  endforeach()
  target_compile_options(${target}_sanitized PRIVATE ${KAZ_SANITIZED_OPTIONS})
  target_link_options(${target}_sanitized INTERFACE ${KAZ_SANITIZERS})
  kaz_sanitized_libraries(${target} libraries)
  target_link_libraries(${target}_sanitized PUBLIC ${libraries})
  get_target_property(first ${target} MANUALLY_ADDED_DEPENDENCIES)
  if(first)
    add_dependencies(${target}_sanitized ${first})
  endif()
  kaz_reuse_precompiled(${target}_sanitized sanitized)
endfunction()

# kaz_sanitized_libraries(TARGET OUT): what TARGET is linked with, each library of the tree replaced by its copy.
function(kaz_sanitized_libraries target out)
  get_target_property(libraries ${target} LINK_LIBRARIES)
  set(replaced "")
  foreach(library IN LISTS libraries)
    string(REPLACE "kaz::" "kaz_" copy ${library})
    if(TARGET ${copy}_sanitized)
      set(library ${copy}_sanitized)
    elseif(library MATCHES "^kaz::")
      message(FATAL_ERROR "${target} is SANITIZED, so ${library} has to be, too")
    endif()
    list(APPEND replaced ${library})
  endforeach()
  set(${out} "${replaced}" PARENT_SCOPE)
endfunction()

# kaz_sanitized_test(NAME): the compiled sources of test NAME, linked with sanitized copies of its libraries. Its cases,
# in four parts, are the tests sanitized.NAME.1 to 4, labelled `sanitized`: a process for each case would take longer
# to start than to run.
function(kaz_sanitized_test name)
  if(NOT KAZ_SANITIZED_COPIES)
    return()
  endif()
  add_executable(${name}_sanitized_test $<TARGET_OBJECTS:${name}_test>)
  set_target_properties(${name}_sanitized_test PROPERTIES LINKER_LANGUAGE CXX)
  kaz_sanitized_libraries(${name}_test libraries)
  target_link_libraries(${name}_sanitized_test PRIVATE ${libraries})
  get_target_property(first ${name}_test MANUALLY_ADDED_DEPENDENCIES)
  if(first)
    add_dependencies(${name}_sanitized_test ${first})
  endif()
  foreach(part RANGE 1 4)
    math(EXPR index "${part} - 1")
    add_test(NAME sanitized.${name}.${part} COMMAND ${KAZ_LAST} $<TARGET_FILE:${name}_sanitized_test>
             WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
    set_tests_properties(sanitized.${name}.${part} PROPERTIES LABELS sanitized
                         ENVIRONMENT "GTEST_TOTAL_SHARDS=4;GTEST_SHARD_INDEX=${index}")
  endforeach()
endfunction()

# kaz_library(NAME [COMPONENT name] [STRICT] [LIGHT [JSON]] [NO_PCH] [SANITIZED] SOURCES ... [PUBLIC lib ...]
#             [PRIVATE lib ...])
# Makes target kaz_NAME with the alias kaz::NAME. STRICT adds -Wconversion: for code whose result must be
# the same bit for bit on another machine. LIGHT: compiled quickly (KAZ_LIGHT_OPTIONS), since no run spends its time
# there; JSON: most of its sources use nlohmann/json. SANITIZED: a second copy of it, for tests that are SANITIZED.
# COMPONENT: of find_package(kaz COMPONENTS ...), KAZ_COMPONENT of its folder if not given; without, it is not installed.
# Headers are included by their path from the root of the tree.
function(kaz_library name)
  cmake_parse_arguments(ARG "STRICT;LIGHT;JSON;NO_PCH;SANITIZED" "COMPONENT" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  add_library(kaz_${name} STATIC ${ARG_SOURCES})
  add_library(kaz::${name} ALIAS kaz_${name})
  set_target_properties(kaz_${name} PROPERTIES EXPORT_NAME ${name})
  target_include_directories(kaz_${name} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
                                                $<BUILD_INTERFACE:${PROJECT_BINARY_DIR}/generated>
                                                $<INSTALL_INTERFACE:include/kaz>)
  target_link_libraries(kaz_${name} PRIVATE $<BUILD_INTERFACE:kaz_flags> ${ARG_PRIVATE} PUBLIC ${ARG_PUBLIC})
  # For projects that link an installed one; in the tree all is compiled so.
  target_compile_features(kaz_${name} INTERFACE $<INSTALL_INTERFACE:cxx_std_20>)
  if(ARG_STRICT)
    target_compile_options(kaz_${name} PRIVATE -Wconversion)
  endif()
  set(precompiled library)
  if(ARG_LIGHT)
    set(precompiled light)
    if(ARG_JSON)
      set(precompiled json)
    endif()
    target_compile_options(kaz_${name} PRIVATE ${KAZ_LIGHT_OPTIONS})
  endif()
  if(NOT ARG_NO_PCH)
    kaz_reuse_precompiled(kaz_${name} ${precompiled})
  endif()
  if(ARG_SANITIZED)
    cmake_language(EVAL CODE "cmake_language(DEFER CALL kaz_sanitized_copy kaz_${name})")
  endif()
  if(NOT ARG_COMPONENT)
    set(ARG_COMPONENT ${KAZ_COMPONENT})
  endif()
  if(ARG_COMPONENT)
    install(TARGETS kaz_${name} EXPORT kaz-${ARG_COMPONENT})
    set_property(GLOBAL APPEND PROPERTY KAZ_INSTALLED_LIBRARIES ${name})
    set_property(GLOBAL PROPERTY KAZ_COMPONENT_OF_${name} ${ARG_COMPONENT})
  endif()
endfunction()

# Put before a test in real time: other programs hardly keep it waiting, if the system permits that.
set(KAZ_FIRST ${PROJECT_SOURCE_DIR}/tests/real_time/first.sh -19)
execute_process(COMMAND nice -n -19 true ERROR_VARIABLE KAZ_CANNOT_COME_FIRST)
cmake_host_system_information(RESULT KAZ_CORES QUERY NUMBER_OF_LOGICAL_CORES)
# Put before a test that only computes. Where tests in real time come first, it has the usual priority: with a lower one
# it would wait for hours beside a busy program.
set(KAZ_LAST "")
if(KAZ_CANNOT_COME_FIRST)
  set(KAZ_LAST nice -n 10)
endif()

# kaz_test(NAME SOURCES ... LIBS ... [REALTIME [COMPUTES]] [FAST] [NO_PCH] [SANITIZED] [UNREGISTERED])
# One GoogleTest program NAME_test; each of its cases is a test of CTest's, with NAME as its label. None has a time
# limit of its own: CTest's ends a hang.
#   REALTIME      it mostly waits for a clock, and comes before other programs where the system permits that: then
#                 twice as many of them run side by side as there are cores, and ctest may run three times as many jobs.
#                 Where it is not permitted, one runs at a time, and other tests have a lower priority. These begin first.
#                 One that fails where the machine was too slow counts as skipped (tests/real_time/main.cpp).
#   COMPUTES      some of its programs need a whole core: those that only wait come before it
#   FAST          its own code is optimised as the product is
#   SANITIZED     also with the sanitized copies of LIBS, all of which have to be SANITIZED libraries
#   UNREGISTERED  built alone; another test runs it
function(kaz_test name)
  if(NOT BUILD_TESTING)
    return()
  endif()
  cmake_parse_arguments(ARG "COMPUTES;FAST;NO_PCH;REALTIME;SANITIZED;UNREGISTERED" "" "SOURCES;LIBS" ${ARGN})
  find_package(GTest REQUIRED)
  include(GoogleTest)
  add_executable(${name}_test ${ARG_SOURCES})
  target_include_directories(${name}_test PRIVATE ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR}/generated)
  set(main GTest::gtest_main)
  if(ARG_REALTIME)
    set(main kaz_real_time_main GTest::gtest)
  endif()
  target_link_libraries(${name}_test PRIVATE kaz_flags ${ARG_LIBS} kaz_json_testing ${main})
  set(precompiled fast_test)
  if(NOT ARG_FAST)
    set(precompiled test)
    target_compile_options(${name}_test PRIVATE ${KAZ_TEST_OPTIONS})
  endif()
  if(NOT ARG_NO_PCH)
    kaz_reuse_precompiled(${name}_test ${precompiled})
  endif()
  if(ARG_UNREGISTERED)
    return()
  endif()
  set(properties LABELS ${name})
  # Also outside of cross compiling the command that CTest puts before the program.
  set(before "")
  if(ARG_REALTIME)
    set(before ${KAZ_FIRST})
    if(ARG_COMPUTES)
      list(TRANSFORM before REPLACE "^-19$" -10)
    endif()
    set(lane 0)
    if(NOT KAZ_CANNOT_COME_FIRST)
      get_property(lane GLOBAL PROPERTY KAZ_REAL_TIME_LANE)
      math(EXPR lane "(0${lane} + 1) % (2 * ${KAZ_CORES})")
      set_property(GLOBAL PROPERTY KAZ_REAL_TIME_LANE ${lane})
    endif()
    list(APPEND properties RESOURCE_LOCK real_time_${lane} COST 1000 SKIP_RETURN_CODE 75
         ENVIRONMENT KAZ_TEST_MAY_SKIP=1)
  else()
    set(before ${KAZ_LAST})
  endif()
  set_target_properties(${name}_test PROPERTIES CROSSCOMPILING_EMULATOR "${before}")
  gtest_discover_tests(${name}_test TEST_PREFIX ${name}. PROPERTIES ${properties}
                       WORKING_DIRECTORY ${PROJECT_SOURCE_DIR} DISCOVERY_TIMEOUT 600)
  if(ARG_SANITIZED)
    cmake_language(EVAL CODE "cmake_language(DEFER CALL kaz_sanitized_test ${name})")
  endif()
endfunction()

# kaz_unity(SIZE): up to SIZE sources of a target become one for the compiler, which reads headers and templates once
# for all of them; a target's property KAZ_UNITY_SIZE is its own SIZE. unity_groups.py finds sources that share no name.
# To be called behind all targets.
function(kaz_unity size)
  set(lists "")
  set(folders ${PROJECT_SOURCE_DIR})
  while(folders)
    list(POP_FRONT folders folder)
    get_property(inner DIRECTORY ${folder} PROPERTY SUBDIRECTORIES)
    list(APPEND folders ${inner})
    get_property(targets DIRECTORY ${folder} PROPERTY BUILDSYSTEM_TARGETS)
    foreach(target IN LISTS targets)
      get_target_property(type ${target} TYPE)
      # A sanitized copy has the groups of the sources that it is made of.
      if(target MATCHES "_sanitized$")
        set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
        continue()
      endif()
      if(NOT type MATCHES "^(STATIC_LIBRARY|EXECUTABLE)$")
        continue()
      endif()
      get_target_property(sources ${target} SOURCES)
      list(FILTER sources INCLUDE REGEX "\\.cpp$")
      set(absolute "")
      foreach(source IN LISTS sources)
        cmake_path(ABSOLUTE_PATH source BASE_DIRECTORY ${folder} NORMALIZE)
        if(EXISTS ${source})
          list(APPEND absolute ${source})
        endif()
      endforeach()
      list(LENGTH absolute count)
      if(count GREATER 1)
        get_target_property(own_size ${target} KAZ_UNITY_SIZE)
        if(NOT own_size)
          set(own_size ${size})
        endif()
        string(APPEND lists "${target};${own_size};${absolute}\n")
        set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
      endif()
    endforeach()
  endwhile()
  file(WRITE ${PROJECT_BINARY_DIR}/unity_sources.txt "${lists}")
  execute_process(
    COMMAND ${Python3_EXECUTABLE} -B ${PROJECT_SOURCE_DIR}/tools/repo/cmake/unity_groups.py ${PROJECT_SOURCE_DIR}
    INPUT_FILE ${PROJECT_BINARY_DIR}/unity_sources.txt OUTPUT_VARIABLE groups COMMAND_ERROR_IS_FATAL ANY)
  string(REGEX REPLACE "\n" "|" groups "${groups}")
  string(REGEX REPLACE ";" ">" groups "${groups}")
  string(REPLACE "|" ";" groups "${groups}")
  foreach(line IN LISTS groups)
    if(line MATCHES "^(.+)>(.+)_([0-9]+)$")
      set_source_files_properties(${CMAKE_MATCH_1} TARGET_DIRECTORY ${CMAKE_MATCH_2}
                                  PROPERTIES UNITY_GROUP ${CMAKE_MATCH_2}_${CMAKE_MATCH_3})
    endif()
  endforeach()
endfunction()
