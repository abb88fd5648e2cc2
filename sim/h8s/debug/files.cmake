# The tools for those who debug and measure: their sources and tests.
# SPDX-License-Identifier: Apache-2.0
target_sources(kaz_h8s PRIVATE
  debug/gdb_data.cpp debug/gdb_packet.cpp debug/gdb_port.cpp debug/gdb_query.cpp
  debug/gdb_server.cpp debug/history.cpp debug/triggers.cpp)
set(debug_tests debug/gdb_test.cpp debug/history_test.cpp debug/observer_test.cpp)
