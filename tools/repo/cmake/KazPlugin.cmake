# Plug-ins with behaviors (docs/howto/own-behavior.md) and modules need the id of the headers that they are compiled
# with, and plug-ins the package kazPlugin, which finds these headers in the build tree. KazInstall installs both.
include_guard(GLOBAL)
set(KAZ_INTERFACE_HEADER ${PROJECT_BINARY_DIR}/generated/kaz_interface.h)
file(GLOB_RECURSE interface_headers CONFIGURE_DEPENDS
  ${PROJECT_SOURCE_DIR}/host/*.h ${PROJECT_SOURCE_DIR}/host/*.def ${PROJECT_SOURCE_DIR}/vision/*.h
  ${PROJECT_SOURCE_DIR}/shared/*.h ${PROJECT_SOURCE_DIR}/shared/*.hpp ${PROJECT_SOURCE_DIR}/shared/*.def
  ${PROJECT_SOURCE_DIR}/sim/body/description/*.h)  # the last: of the WorldModel that a module returns
list(FILTER interface_headers EXCLUDE REGEX "_testing\\.h")
list(APPEND interface_headers ${PROJECT_SOURCE_DIR}/shared/robot/kaz/kaz.urdf)  # kz_limits.h is made from it
set(interface_script ${PROJECT_SOURCE_DIR}/tools/repo/gen/source_id.py)
find_package(Python3 REQUIRED COMPONENTS Interpreter)
add_custom_command(
  OUTPUT ${KAZ_INTERFACE_HEADER}
  COMMAND Python3::Interpreter -B ${interface_script} interface ${PROJECT_SOURCE_DIR} ${KAZ_INTERFACE_HEADER}
          ${interface_headers}
  DEPENDS ${interface_script} ${interface_headers}
  COMMENT "Interface id of plug-ins" VERBATIM)
add_custom_target(kaz_interface_header DEPENDS ${KAZ_INTERFACE_HEADER})
add_dependencies(kaz_interface_header kaz_generated_headers)

set(KAZ_PLUGIN_INCLUDES "\"${PROJECT_SOURCE_DIR}\" \"${PROJECT_BINARY_DIR}/generated\"")
configure_file(${PROJECT_SOURCE_DIR}/tools/repo/cmake/kazPluginConfig.cmake.in
               ${PROJECT_BINARY_DIR}/kazPluginConfig.cmake @ONLY)
# Behind this first, coarse check the program compares the id of the headers when it loads a plug-in.
include(CMakePackageConfigHelpers)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/kazPluginConfigVersion.cmake COMPATIBILITY SameMinorVersion)

# A module, which programs load when they need it (shared/base/module.hpp). Its copy of `library` stays hidden.
function(kaz_module target source library)
  add_library(${target} MODULE ${source})
  target_link_libraries(${target} PRIVATE kaz_flags ${library})
  target_link_options(${target} PRIVATE "LINKER:--exclude-libs,ALL")
  add_dependencies(${target} kaz_interface_header)
endfunction()
