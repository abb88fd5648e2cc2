# `cmake --install` puts the program, its data, the libraries and their headers where the program and
# find_package(kaz) look for them.
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

# Headers of the libraries that are installed, and of what all of them include: no test's helpers, no program's.
get_property(libraries GLOBAL PROPERTY KAZ_INSTALLED_LIBRARIES)
set(folders shared/base shared/board shared/flash shared/protocol shared/servo sim/body/motor sim/runtime vision/image)
foreach(library IN LISTS libraries)
  get_target_property(source_folder kaz_${library} SOURCE_DIR)
  get_target_property(sources kaz_${library} SOURCES)
  foreach(source IN LISTS sources)
    cmake_path(ABSOLUTE_PATH source BASE_DIRECTORY ${source_folder} NORMALIZE)
    cmake_path(GET source PARENT_PATH folder)
    cmake_path(RELATIVE_PATH folder BASE_DIRECTORY ${PROJECT_SOURCE_DIR})
    cmake_path(IS_PREFIX PROJECT_BINARY_DIR ${source} generated)  # the build folder may be in the tree
    if(IS_DIRECTORY ${PROJECT_SOURCE_DIR}/${folder} AND NOT generated)
      list(APPEND folders ${folder})
    endif()
  endforeach()
endforeach()
list(REMOVE_DUPLICATES folders)
string(REPLACE ";" "\n" lines "${folders}")
file(WRITE ${PROJECT_BINARY_DIR}/installed/header_folders.txt "${lines}\n")  # for the test of the site's API pages
foreach(folder IN LISTS folders)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/${folder}/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/kaz/${folder}
          FILES_MATCHING PATTERN "*.h" PATTERN "*.hpp" PATTERN "*.def"
          REGEX "_testing\\.h$" EXCLUDE REGEX "${folder}/.*/" EXCLUDE)
endforeach()
install(FILES ${PROJECT_BINARY_DIR}/generated/kz_limits.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/kaz)
if(TARGET kaz_interface_header)
  install(FILES ${PROJECT_BINARY_DIR}/generated/kaz_interface.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/kaz)
  set(config ${CMAKE_INSTALL_LIBDIR}/cmake/kazPlugin)
  file(RELATIVE_PATH headers /${config} /${CMAKE_INSTALL_INCLUDEDIR}/kaz)
  set(KAZ_PLUGIN_INCLUDES "\"\${CMAKE_CURRENT_LIST_DIR}/${headers}\"")
  configure_file(${PROJECT_SOURCE_DIR}/tools/repo/cmake/kazPluginConfig.cmake.in
                 ${PROJECT_BINARY_DIR}/installed/kazPluginConfig.cmake @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/installed/kazPluginConfig.cmake
                ${PROJECT_BINARY_DIR}/kazPluginConfigVersion.cmake DESTINATION ${config})
endif()

install(DIRECTORY ${PROJECT_SOURCE_DIR}/shared/robot DESTINATION ${CMAKE_INSTALL_DATADIR}/kaz)
if(TARGET kaz)
  install(TARGETS kaz)
  set(shell ${PROJECT_BINARY_DIR}/shell)
  install(FILES ${shell}/kaz DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
  install(DIRECTORY ${shell}/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 FILES_MATCHING PATTERN "*.1")
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/sim/worlds ${PROJECT_SOURCE_DIR}/sim/robots
                    ${PROJECT_SOURCE_DIR}/examples
          DESTINATION ${CMAKE_INSTALL_DATADIR}/kaz PATTERN __pycache__ EXCLUDE PATTERN build EXCLUDE)
  # The page of --view, if there was npm to build it.
  install(DIRECTORY ${PROJECT_BINARY_DIR}/view DESTINATION ${CMAKE_INSTALL_DATADIR}/kaz OPTIONAL)
endif()
install(FILES ${PROJECT_SOURCE_DIR}/tools/udev/70-kaz.rules DESTINATION ${CMAKE_INSTALL_DATADIR}/kaz/udev)
install(PROGRAMS ${PROJECT_SOURCE_DIR}/tools/repo/gdb/build_gdb.sh ${PROJECT_SOURCE_DIR}/tools/repo/gdb/coff_to_elf.py
        DESTINATION ${CMAKE_INSTALL_DATADIR}/kaz/gdb)
install(FILES ${PROJECT_SOURCE_DIR}/shared/protocol/wireshark/kaz.lua
        DESTINATION ${CMAKE_INSTALL_DATADIR}/kaz/wireshark)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
if(TARGET kaz_firmware)
  install(FILES ${PROJECT_BINARY_DIR}/firmware/kaz.mot ${PROJECT_BINARY_DIR}/firmware/kaz.coff
                ${PROJECT_BINARY_DIR}/firmware/writer.bin
          DESTINATION ${CMAKE_INSTALL_DATADIR}/kaz/firmware)
endif()

# What users run, import or link, without tests: `cmake --build build/release --target kaz_product`.
add_custom_target(kaz_product)
set(built ${PROJECT_BINARY_DIR}/generated/kz_limits.h)
set(installed_targets ${libraries})
list(TRANSFORM installed_targets PREPEND kaz_)
list(APPEND installed_targets kaz kaz_ompl_planner kaz_world_module)
if(KAZ_PYTHON_DIR)
  list(APPEND installed_targets kaz_python)
endif()
foreach(target IN LISTS installed_targets)
  if(TARGET ${target})
    add_dependencies(kaz_product ${target})
    list(APPEND built $<TARGET_FILE:${target}>)
  endif()
endforeach()
foreach(target kaz_generated_headers kaz_interface_header kaz_firmware kaz_shell_files kaz_page kaz_python)
  if(TARGET ${target})
    add_dependencies(kaz_product ${target})
  endif()
endforeach()
if(TARGET kaz)
  list(APPEND built ${PROJECT_BINARY_DIR}/shell/kaz)
endif()
if(TARGET kaz_firmware)
  list(APPEND built ${PROJECT_BINARY_DIR}/firmware/kaz.mot)
endif()
file(GENERATE OUTPUT ${PROJECT_BINARY_DIR}/installed/check_built.cmake
     CONTENT "set(kaz_build \"${PROJECT_BINARY_DIR}\")
set(kaz_built \"${built}\")
set(kaz_has_page $<TARGET_EXISTS:kaz_page>)
include(\"${CMAKE_CURRENT_LIST_DIR}/KazCheckBuilt.cmake\")
")

# Components: what each requires is read from the libraries themselves. A package of others has a line here, or the
# configuration stops: how CMake finds it, and what pkg-config calls it.
set(packages
  "Eigen3::Eigen|find:Eigen3|eigen3"
  "Threads::Threads|find:Threads|-pthread"
  "nlohmann_json::nlohmann_json|find:nlohmann_json|"
  "OpenSSL::Crypto|find:OpenSSL|libcrypto"
  "ZLIB::ZLIB|find:ZLIB|zlib"
  "asmjit::asmjit|find:asmjit|-lasmjit"
  "sdformat12::sdformat12|find:sdformat12|sdformat12"
  "PkgConfig::KAZ_LZ4|pkg:KAZ_LZ4:liblz4|liblz4"
  "PkgConfig::KAZ_ODE|pkg:KAZ_ODE:ode|ode"
  "PkgConfig::KAZ_QHULL|pkg:KAZ_QHULL:qhull_r|qhull_r"
  "PkgConfig::KAZ_TINYXML2|pkg:KAZ_TINYXML2:tinyxml2|tinyxml2"
  "PkgConfig::KAZ_ZSTD|pkg:KAZ_ZSTD:libzstd|libzstd")
set(components "")
foreach(library IN LISTS libraries)
  get_property(component GLOBAL PROPERTY KAZ_COMPONENT_OF_${library})
  list(APPEND components ${component})
  list(APPEND libraries_${component} ${library})
  get_target_property(linked kaz_${library} LINK_LIBRARIES)
  foreach(other IN LISTS linked)
    if(other MATCHES "^kaz::(.+)$")
      get_property(theirs GLOBAL PROPERTY KAZ_COMPONENT_OF_${CMAKE_MATCH_1})
      if(NOT theirs)
        message(FATAL_ERROR "kaz::${library} is installed and needs ${other}, which is not: give it a COMPONENT")
      endif()
      list(APPEND requires_${component} ${theirs})
    elseif(other MATCHES "::" AND NOT other MATCHES "^.<")
      set(known FALSE)
      foreach(package IN LISTS packages)
        string(REPLACE "|" ";" package "${package}")
        list(GET package 0 target)
        if(target STREQUAL other)
          list(GET package 1 find)
          list(GET package 2 pkg_config)
          list(APPEND finds_${component} ${find})
          list(APPEND pkg_configs_${component} ${pkg_config})
          set(known TRUE)
        endif()
      endforeach()
      if(NOT known)
        message(FATAL_ERROR "kaz::${library} is installed and needs ${other}: name it in ${CMAKE_CURRENT_LIST_FILE}")
      endif()
    elseif(other MATCHES "/lib([^/]+)\\.(so|a)$")
      list(APPEND pkg_configs_${component} -l${CMAKE_MATCH_1})
    elseif(other MATCHES "^[a-z]+$")
      list(APPEND pkg_configs_${component} -l${other})
    endif()
  endforeach()
endforeach()
list(REMOVE_DUPLICATES components)
set(config ${CMAKE_INSTALL_LIBDIR}/cmake/kaz)
set(KAZ_TABLE "")
file(RELATIVE_PATH KAZ_PC_PREFIX /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
foreach(component IN LISTS components)
  list(REMOVE_DUPLICATES requires_${component})
  list(REMOVE_ITEM requires_${component} ${component})
  list(REMOVE_DUPLICATES finds_${component})
  string(APPEND KAZ_TABLE "set(_kaz_requires_${component} ${requires_${component}})\n"
                          "set(_kaz_packages_${component} ${finds_${component}})\n")
  install(EXPORT kaz-${component} NAMESPACE kaz:: DESTINATION ${config})
  # kaz-h8s.pc and so on. What pkg-config has a file for is required, the rest is linked by name.
  set(KAZ_COMPONENT_NAME ${component})
  set(KAZ_PC_REQUIRES "")
  set(KAZ_PC_LIBS "")
  foreach(other IN LISTS requires_${component})
    string(APPEND KAZ_PC_REQUIRES " kaz-${other}")
  endforeach()
  foreach(library IN LISTS libraries_${component})
    string(APPEND KAZ_PC_LIBS " -lkaz_${library}")
  endforeach()
  list(REMOVE_DUPLICATES pkg_configs_${component})
  foreach(one IN LISTS pkg_configs_${component})
    if(one MATCHES "^-")
      string(APPEND KAZ_PC_LIBS " ${one}")
    else()
      string(APPEND KAZ_PC_REQUIRES " ${one}")
    endif()
  endforeach()
  list(LENGTH libraries_${component} count)
  if(count GREATER 1)  # they may need each other
    string(REGEX REPLACE "^( -lkaz_[^ ]+)+" " -Wl,--start-group\\0 -Wl,--end-group" KAZ_PC_LIBS "${KAZ_PC_LIBS}")
  endif()
  configure_file(${PROJECT_SOURCE_DIR}/tools/repo/cmake/kaz.pc.in ${PROJECT_BINARY_DIR}/installed/kaz-${component}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/installed/kaz-${component}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endforeach()
string(REPLACE ";" " " KAZ_COMPONENTS "${components}")
configure_package_config_file(${PROJECT_SOURCE_DIR}/tools/repo/cmake/kazConfig.cmake.in
                              ${PROJECT_BINARY_DIR}/kazConfig.cmake INSTALL_DESTINATION ${config})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/kazConfigVersion.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/kazConfig.cmake ${PROJECT_BINARY_DIR}/kazConfigVersion.cmake
        DESTINATION ${config})
