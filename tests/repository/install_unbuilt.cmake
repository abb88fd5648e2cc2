# Before anything is built `cmake --install` and find_package(kaz) name the commands; these work, and build no test.
# SPDX-License-Identifier: Apache-2.0
file(REMOVE_RECURSE ${BINARY})
set(build ${BINARY}/build)
set(prefix ${BINARY}/prefix)
execute_process(
  COMMAND ${CMAKE_COMMAND} -S ${SOURCE} -B ${build} -G Ninja -DKAZ_PARTS=shared -DCMAKE_BUILD_TYPE=Debug
  COMMAND_ERROR_IS_FATAL ANY OUTPUT_QUIET)

execute_process(COMMAND ${CMAKE_COMMAND} --install ${build} --prefix ${prefix}
                RESULT_VARIABLE status ERROR_VARIABLE message OUTPUT_QUIET)
if(status EQUAL 0 OR NOT message MATCHES "Nothing was installed: .*cmake --build ${build} --target kaz_product")
  message(FATAL_ERROR "an installation of nothing: ${message}")
endif()
if(EXISTS ${prefix})
  message(FATAL_ERROR "it had begun to copy")
endif()

# The component protocol, as an outside project has it.
function(consume from)
  execute_process(COMMAND ${CMAKE_COMMAND} -S ${SOURCE}/tests/repository/consumers -B ${BINARY}/consumer -G Ninja
                          -DCMAKE_PREFIX_PATH=${from} -DCOMPONENT=protocol -DLIBRARIES=kaz::protocol
                          -DPROGRAM=${SOURCE}/tests/repository/consumers/protocol.cpp
                  RESULT_VARIABLE status ERROR_VARIABLE message OUTPUT_QUIET)
  set(status ${status} PARENT_SCOPE)
  set(message "${message}" PARENT_SCOPE)
endfunction()
consume(${build})
if(status EQUAL 0 OR NOT message MATCHES "Install[ \n]+first:.*cmake --install ${build} --prefix PREFIX")
  message(FATAL_ERROR "find_package in the build folder: ${message}")
endif()

execute_process(COMMAND ${CMAKE_COMMAND} --build ${build} --target kaz_product COMMAND_ERROR_IS_FATAL ANY OUTPUT_QUIET)
file(GLOB tests ${build}/bin/*_test)
if(tests)
  message(FATAL_ERROR "what is installed needs no test, and these were built: ${tests}")
endif()
execute_process(COMMAND ${CMAKE_COMMAND} --install ${build} --prefix ${prefix} COMMAND_ERROR_IS_FATAL ANY OUTPUT_QUIET)
file(REMOVE_RECURSE ${BINARY}/consumer)
consume(${prefix})
if(NOT status EQUAL 0)
  message(FATAL_ERROR "find_package of what was installed: ${message}")
endif()
execute_process(COMMAND ${CMAKE_COMMAND} --build ${BINARY}/consumer COMMAND_ERROR_IS_FATAL ANY OUTPUT_QUIET)
execute_process(COMMAND ${BINARY}/consumer/consumer COMMAND_ERROR_IS_FATAL ANY OUTPUT_QUIET)
