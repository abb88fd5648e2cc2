# kaz::h8s for a project that adds this folder and nothing else of Kaz:
#
#   add_subdirectory(kaz/sim/h8s)
#   target_link_libraries(mine PRIVATE kaz::h8s)
#
# It needs C++20, tl::expected (Debian: libexpected-dev) and, to translate, asmjit (libasmjit-dev).
get_filename_component(h8s_root ${CMAKE_CURRENT_LIST_DIR}/../.. ABSOLUTE)
file(GLOB h8s_image_sources CONFIGURE_DEPENDS ${h8s_root}/shared/image/*.cpp)
list(FILTER h8s_image_sources EXCLUDE REGEX "_test\\.cpp$")
# Readers of formats name alike things alike.
set_source_files_properties(${h8s_image_sources} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
add_library(kaz_h8s STATIC ${h8s_sources} ${h8s_image_sources})
add_library(kaz::h8s ALIAS kaz_h8s)
target_compile_features(kaz_h8s PUBLIC cxx_std_20)
# No fused multiply-add: the same bits on each machine.
target_compile_options(kaz_h8s PRIVATE -ffp-contract=off -fno-semantic-interposition)
target_include_directories(kaz_h8s PUBLIC ${h8s_root})
if(h8s_translates)
  target_link_libraries(kaz_h8s PRIVATE asmjit::asmjit)
endif()
