# `cmake --install` puts the program, its data, the libraries and their headers where the program and
# find_package(kaz) look for them.
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

foreach(part IN LISTS KAZ_PARTS)
  if(part STREQUAL "tests" OR part STREQUAL "firmware")
    continue()
  endif()
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/${part} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/kaz
          FILES_MATCHING PATTERN "*.h" PATTERN "*.hpp" PATTERN "*.def"
          PATTERN testdata EXCLUDE PATTERN kaz EXCLUDE)
endforeach()
install(FILES ${PROJECT_BINARY_DIR}/generated/kz_limits.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/kaz)
if(TARGET kaz_interface_header)
  install(FILES ${PROJECT_BINARY_DIR}/generated/kaz_interface.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/kaz)
  set(config ${CMAKE_INSTALL_LIBDIR}/cmake/kazPlugin)
  file(RELATIVE_PATH headers /${config} /${CMAKE_INSTALL_INCLUDEDIR}/kaz)
  set(KAZ_PLUGIN_INCLUDES "\"\${CMAKE_CURRENT_LIST_DIR}/${headers}\"")
  configure_file(${PROJECT_SOURCE_DIR}/tools/cmake/kazPluginConfig.cmake.in
                 ${PROJECT_BINARY_DIR}/installed/kazPluginConfig.cmake @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/installed/kazPluginConfig.cmake DESTINATION ${config})
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
install(FILES ${PROJECT_SOURCE_DIR}/shared/protocol/wireshark/kaz.lua
        DESTINATION ${CMAKE_INSTALL_DATADIR}/kaz/wireshark)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
if(TARGET kaz_firmware)
  install(FILES ${PROJECT_BINARY_DIR}/firmware/kaz.mot ${PROJECT_BINARY_DIR}/firmware/kaz.coff
                ${PROJECT_BINARY_DIR}/firmware/writer.bin
          DESTINATION ${CMAKE_INSTALL_DATADIR}/kaz/firmware)
endif()

set(config ${CMAKE_INSTALL_LIBDIR}/cmake/kaz)
install(EXPORT kaz NAMESPACE kaz:: DESTINATION ${config})
configure_package_config_file(${PROJECT_SOURCE_DIR}/tools/cmake/kazConfig.cmake.in
                              ${PROJECT_BINARY_DIR}/kazConfig.cmake INSTALL_DESTINATION ${config})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/kazConfigVersion.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/kazConfig.cmake ${PROJECT_BINARY_DIR}/kazConfigVersion.cmake
        DESTINATION ${config})
