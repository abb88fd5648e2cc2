# Installs the build into a scratch folder, builds an outside project against it, and runs the
# installed program far from the tree, also after it was moved.
set(prefix ${BINARY}/prefix)
file(REMOVE_RECURSE ${BINARY})
execute_process(COMMAND ${CMAKE_COMMAND} --install ${BUILD} --prefix ${prefix}
                COMMAND_ERROR_IS_FATAL ANY OUTPUT_QUIET)
file(STRINGS ${BUILD}/install_manifest.txt installed)
foreach(file IN LISTS installed)
  if(NOT file MATCHES "^${prefix}/")
    message(FATAL_ERROR "installed outside of the prefix ${prefix}: ${file}")
  endif()
endforeach()
if(EXISTS ${BUILD}/view/index.html AND NOT EXISTS ${prefix}/share/kaz/view/index.html)
  message(FATAL_ERROR "the page of --view was built and is not installed")
endif()
execute_process(COMMAND ${CMAKE_COMMAND} -S ${SOURCE}/tests/repository/consumer -B ${BINARY}/consumer -G Ninja
                        -DCMAKE_PREFIX_PATH=${prefix}
                COMMAND_ERROR_IS_FATAL ANY OUTPUT_QUIET)
execute_process(COMMAND ${CMAKE_COMMAND} --build ${BINARY}/consumer COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${BINARY}/consumer/consumer COMMAND_ERROR_IS_FATAL ANY)
# A behaviour of somebody's own, with the installed headers.
execute_process(COMMAND ${CMAKE_COMMAND} -S ${SOURCE}/examples/behavior -B ${BINARY}/behavior -G Ninja
                        -DCMAKE_PREFIX_PATH=${prefix}
                COMMAND_ERROR_IS_FATAL ANY OUTPUT_QUIET)
execute_process(COMMAND ${CMAKE_COMMAND} --build ${BINARY}/behavior COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${prefix}/bin/kaz run ${BINARY}/behavior/wave.so --mcu native WORKING_DIRECTORY ${prefix}
                COMMAND_ERROR_IS_FATAL ANY)
# Without a path into the tree, by which it would work on this machine alone.
file(STRINGS ${prefix}/bin/kaz paths REGEX "${BUILD}|${SOURCE}/")
if(paths)
  message(FATAL_ERROR "the program knows the tree: ${paths}")
endif()
file(RENAME ${prefix} ${BINARY}/moved)
file(MAKE_DIRECTORY ${BINARY}/work)
execute_process(COMMAND ${SOURCE}/tests/repository/installed.sh ${BINARY}/moved ${BINARY}/work
                COMMAND_ERROR_IS_FATAL ANY)
