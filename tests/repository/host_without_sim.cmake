# Configures and builds shared, vision and host alone, without optimisation: that is not the question.
execute_process(
  COMMAND ${CMAKE_COMMAND} -S ${SOURCE} -B ${BINARY} -G Ninja -DCMAKE_BUILD_TYPE=Debug
          -DCMAKE_CXX_FLAGS_DEBUG=-O0 -DCMAKE_C_FLAGS_DEBUG=-O0
          "-DKAZ_PARTS=shared;vision;host" -DBUILD_TESTING=OFF
  COMMAND_ERROR_IS_FATAL ANY OUTPUT_QUIET)
execute_process(COMMAND ${CMAKE_COMMAND} --build ${BINARY} -j 1 COMMAND_ERROR_IS_FATAL ANY)
