# Configures shared, vision and host alone: their folders need no other.
execute_process(
  COMMAND ${CMAKE_COMMAND} -S ${SOURCE} -B ${BINARY} -G Ninja "-DKAZ_PARTS=shared;vision;host" -DBUILD_TESTING=OFF
  COMMAND_ERROR_IS_FATAL ANY OUTPUT_QUIET)
