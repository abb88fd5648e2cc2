# Packages of npm for a test, fetched when the build is configured, so that tests use no network.
# SPDX-License-Identifier: Apache-2.0

# kaz_npm_packages(OUT CONSEQUENCE): those that package-lock.json beside the caller's CMakeLists.txt names, into the
# build folder, once for each state of that file. Sets OUT to their folder, in which `installed` is a file if they are
# there; else warns that CONSEQUENCE ("the test of ... will fail"). Needs NODE and NPM, which it sets.
function(kaz_npm_packages out consequence)
  find_program(NODE NAMES node nodejs)
  find_program(NPM npm)
  set(packages ${CMAKE_CURRENT_BINARY_DIR}/npm)
  set(${out} ${packages} PARENT_SCOPE)
  set(lock ${CMAKE_CURRENT_SOURCE_DIR}/package-lock.json)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${lock})
  file(SHA256 ${lock} wanted)
  set(installed "")
  if(EXISTS ${packages}/installed)
    file(READ ${packages}/installed installed)
  endif()
  if(installed STREQUAL wanted OR NOT NODE OR NOT NPM)
    return()
  endif()
  file(REMOVE_RECURSE ${packages})
  file(COPY ${lock} ${CMAKE_CURRENT_SOURCE_DIR}/package.json DESTINATION ${packages})
  execute_process(
    COMMAND ${NPM} ci --ignore-scripts --no-audit --no-fund --prefer-offline --fetch-retries=1
    WORKING_DIRECTORY ${packages} RESULT_VARIABLE status OUTPUT_VARIABLE log ERROR_VARIABLE log)
  if(status EQUAL 0)
    file(WRITE ${packages}/installed ${wanted})
  else()
    message(WARNING "npm could not fetch packages of ${CMAKE_CURRENT_SOURCE_DIR}: ${consequence} until cmake is run "
                    "again with the network up:\n${log}")
  endif()
endfunction()
