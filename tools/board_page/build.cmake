# Builds the page: the board by emscripten, then TypeScript and vite. Only what has changed.
# SPDX-License-Identifier: Apache-2.0
#
# cmake -D EMCC=.. -D NPM=.. -D NINJA=.. -D ROOT=.. -D IN=.. -D TO=.. -D TABLE=.. -D GENERATED=.. -D FIRMWARE=..
#       -D EXPECTED=.. -D EIGEN=.. -P build.cmake
# TO gets index.html, which is the whole page, and board_script.js, the tests' program for node.
set(page ${CMAKE_CURRENT_LIST_DIR}/page)
set(wasm ${IN}/wasm)
set(npm ${IN}/npm)

foreach(input ${FIRMWARE}/kaz.mot ${FIRMWARE}/kaz.coff ${GENERATED}/board_params.h ${GENERATED}/kz_limits.h ${TABLE})
  if(NOT EXISTS ${input})
    message(FATAL_ERROR "${input} is not there: build the target board_page_html, which makes it first")
  endif()
endforeach()

# Debian's emscripten keeps no compiled libraries and is configured not to compile any: those that the page needs are
# kept in the build folder.
get_filename_component(emcc ${EMCC} REALPATH)
set(toolchain /usr/share/emscripten/cmake/Modules/Platform/Emscripten.cmake)
if(NOT EXISTS ${toolchain})
  get_filename_component(toolchain ${emcc}/../cmake/Modules/Platform/Emscripten.cmake ABSOLUTE)
endif()
set(ENV{EM_CACHE} ${IN}/emscripten-cache)
# Empty, which means no; set(ENV{...} "") would leave it out, and Debian's configuration says yes.
set(unfrozen ${CMAKE_COMMAND} -E env EM_FROZEN_CACHE=)
# Where Debian's node finds node-acorn by itself, and one of another source does not.
set(ENV{NODE_PATH} /usr/share/nodejs)
if(DEFINED ENV{KAZ_JOBS})
  set(ENV{EMCC_CORES} $ENV{KAZ_JOBS})
  set(jobs -j $ENV{KAZ_JOBS})
endif()

function(run what)
  execute_process(COMMAND ${unfrozen} ${ARGN} RESULT_VARIABLE status)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "The page of the board is not built: ${what} failed (above)")
  endif()
endfunction()
function(run_quietly what)
  execute_process(COMMAND ${ARGN} WORKING_DIRECTORY ${npm} RESULT_VARIABLE status OUTPUT_VARIABLE log ERROR_VARIABLE log)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "The page of the board is not built: ${what} failed:\n${log}")
  endif()
endfunction()

if(NOT EXISTS ${wasm}/build.ninja)
  message("configuring for emscripten; the first build also compiles its C++ library: some minutes")
endif()
run("configuring for emscripten" ${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR}/wasm -B ${wasm} -G Ninja --log-level=WARNING
    -D CMAKE_MAKE_PROGRAM=${NINJA} -D CMAKE_BUILD_TYPE=Release -D CMAKE_TOOLCHAIN_FILE=${toolchain}
    -D KAZ_GENERATED=${GENERATED} -D KAZ_FIRMWARE=${FIRMWARE} -D KAZ_EXPECTED=${EXPECTED} -D KAZ_EIGEN=${EIGEN})
run("emscripten" ${NINJA} -C ${wasm} ${jobs})

# Packages as package-lock.json names them.
file(MAKE_DIRECTORY ${npm}/src/view)
set(files index.html package.json package-lock.json tsconfig.json vite.config.js)
foreach(file IN LISTS files)
  file(COPY ${page}/${file} DESTINATION ${npm})
endforeach()
file(SHA256 ${npm}/package-lock.json wanted)
set(installed "")
if(EXISTS ${npm}/installed)
  file(READ ${npm}/installed installed)
endif()
if(NOT installed STREQUAL wanted)
  message("fetching npm packages")
  run_quietly("npm, which needs the network," ${NPM} ci --ignore-scripts --no-audit --no-fund --prefer-offline
              --fetch-retries=1)
  file(WRITE ${npm}/installed ${wanted})
endif()

# What of the page of --view is used here too.
file(REMOVE_RECURSE ${npm}/src)
file(COPY ${page}/src DESTINATION ${npm})
foreach(file plot.ts ros1.ts style.css)
  file(COPY ${ROOT}/tools/view/page/src/${file} DESTINATION ${npm}/src/view)
endforeach()
configure_file(${TABLE} ${npm}/src/protocol.json COPYONLY)
configure_file(${wasm}/board.js ${npm}/src/board.js COPYONLY)

# One digest of all inputs: nothing is done twice.
file(GLOB_RECURSE sources ${npm}/src/*)
list(SORT sources)
set(digests "")
foreach(file IN LISTS sources files)
  cmake_path(ABSOLUTE_PATH file BASE_DIRECTORY ${npm})
  file(SHA256 ${file} digest)
  string(APPEND digests "${file} ${digest}\n")
endforeach()
set(built "")
if(EXISTS ${TO}/index.html AND EXISTS ${IN}/page.inputs)
  file(READ ${IN}/page.inputs built)
endif()
file(MAKE_DIRECTORY ${TO})
if(NOT built STREQUAL digests)
  message("type check and vite")
  run_quietly("the type check or vite" ${NPM} run build)
  file(COPY_FILE ${npm}/dist/index.html ${TO}/index.html.new)
  file(RENAME ${TO}/index.html.new ${TO}/index.html)
  file(WRITE ${IN}/page.inputs "${digests}")
endif()
file(COPY_FILE ${wasm}/board_script.js ${TO}/board_script.js ONLY_IF_DIFFERENT)
file(SIZE ${TO}/index.html size)
math(EXPR kilobytes "${size} / 1000")
message("${TO}/index.html: ${kilobytes} kB, the whole page")
