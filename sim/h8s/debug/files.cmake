# The tools for those who debug and measure: their sources and tests.
# SPDX-License-Identifier: Apache-2.0
target_sources(kaz_h8s PRIVATE
  debug/call_stack.cpp debug/coverage.cpp debug/gdb_data.cpp debug/gdb_packet.cpp debug/gdb_port.cpp
  debug/gdb_query.cpp debug/gdb_server.cpp debug/history.cpp debug/memory_checks.cpp
  debug/profile.cpp debug/profile_output.cpp debug/trace.cpp debug/triggers.cpp)
if(TARGET h8s_test)
  target_sources(h8s_test PRIVATE
    debug/gdb_test.cpp debug/history_test.cpp debug/measure_test.cpp)
endif()
