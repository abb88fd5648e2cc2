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
foreach(pattern "/include/kaz/build/" "_testing\\.h$" "_test\\.cpp$" "/tools/(app|kaz|view|fuzz)/")
  set(helpers ${installed})
  list(FILTER helpers INCLUDE REGEX ${pattern})
  if(helpers)
    message(FATAL_ERROR "installed, and for nobody outside: ${helpers}")
  endif()
endforeach()
# Whatever an installed header includes is installed.
file(GLOB_RECURSE headers ${prefix}/include/kaz/*.h ${prefix}/include/kaz/*.hpp)
foreach(header IN LISTS headers)
  file(STRINGS ${header} includes REGEX "^ *# *include \"")
  foreach(line IN LISTS includes)
    string(REGEX REPLACE "^[^\"]*\"([^\"]*)\".*" "\\1" name "${line}")
    cmake_path(GET header PARENT_PATH beside)
    if(NOT EXISTS ${prefix}/include/kaz/${name} AND NOT EXISTS ${beside}/${name})
      message(FATAL_ERROR "${header} includes ${name}, which is not installed")
    endif()
  endforeach()
endforeach()

# An outside project for each component, which must not look for what the component does not need.
set(simulation "nlohmann_json;OpenSSL;sdformat12;ZLIB;PkgConfig")
function(consume component libraries absent)
  set(disabled "")
  foreach(package IN LISTS absent)
    list(APPEND disabled -DCMAKE_DISABLE_FIND_PACKAGE_${package}=ON)
  endforeach()
  set(build ${BINARY}/consumers/${component})
  set(program ${SOURCE}/tests/repository/consumers/${component}.cpp)
  if(component STREQUAL "h8s")
    set(program ${SOURCE}/sim/h8s/example/example.cpp)
  endif()
  execute_process(COMMAND ${CMAKE_COMMAND} -S ${SOURCE}/tests/repository/consumers -B ${build} -G Ninja
                          -DCMAKE_PREFIX_PATH=${prefix} -DCOMPONENT=${component} -DPROGRAM=${program} "-DLIBRARIES=${libraries}" ${disabled} --no-warn-unused-cli
                  COMMAND_ERROR_IS_FATAL ANY OUTPUT_QUIET)
  execute_process(COMMAND ${CMAKE_COMMAND} --build ${build} COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND ${build}/consumer ${prefix}/share/kaz COMMAND_ERROR_IS_FATAL ANY)
  file(READ ${program} text)
  if(text MATCHES "arguments\\[1\\]")  # a reader starts it without one
    execute_process(COMMAND ${build}/consumer RESULT_VARIABLE status OUTPUT_VARIABLE usage)
    if(NOT status EQUAL 2 OR NOT usage MATCHES "^usage: ${component} PREFIX/share/kaz\n$")
      message(FATAL_ERROR "${component}.cpp without its argument: ${status} ${usage}")
    endif()
  endif()
endfunction()
consume(protocol kaz::protocol "Eigen3;asmjit;${simulation}")
consume(image kaz::image "Eigen3;asmjit;${simulation}")
consume(board kaz::servo "Eigen3;asmjit;${simulation}")
consume(servo_bus kaz::servo_bus "Eigen3;asmjit;OpenSSL;sdformat12;ZLIB;PkgConfig")
consume(h8s kaz::h8s "Eigen3;${simulation}")
consume(vision kaz::vision "asmjit;nlohmann_json;OpenSSL;sdformat12;ZLIB")
consume(host "kaz::behavior;kaz::link" "asmjit;OpenSSL;sdformat12;ZLIB")
consume(body kaz::body "asmjit;OpenSSL;ZLIB")
consume(bus kaz::bus "asmjit;OpenSSL;ZLIB")
consume(bench kaz::measurements "asmjit;OpenSSL;sdformat12;ZLIB")
consume(sim kaz::runtime "")
consume(lockstep kaz::lockstep "")
execute_process(COMMAND ${CMAKE_COMMAND} -S ${SOURCE}/tests/repository/consumers -B ${BINARY}/consumers/none -G Ninja
                        -DCMAKE_PREFIX_PATH=${prefix} -DCOMPONENT=wings
                RESULT_VARIABLE status ERROR_VARIABLE message OUTPUT_QUIET)
if(status EQUAL 0 OR NOT message MATCHES "kaz has no component \"wings\"; it has protocol")
  message(FATAL_ERROR "a component that is none: ${message}")
endif()
# By pkg-config, as a Makefile would.
execute_process(COMMAND sh -c "PKG_CONFIG_PATH=$(dirname $(find ${prefix} -name kaz-h8s.pc)) && export PKG_CONFIG_PATH && \
  c++ -std=c++20 ${SOURCE}/sim/h8s/example/example.cpp $(pkg-config --cflags --libs kaz-h8s) \
  -o ${BINARY}/by_pkg_config && ${BINARY}/by_pkg_config" COMMAND_ERROR_IS_FATAL ANY)
# A behavior of somebody's own, with the installed headers.
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
