# Sources of the emulator, for the tree and for projects that take this folder alone.
set(h8s_sources
  chip/adc.cpp chip/boot.cpp chip/chip.cpp chip/dtc.cpp chip/flash.cpp chip/frt.cpp chip/interrupts.cpp
  chip/io.cpp chip/machine.cpp chip/memory.cpp chip/observers.cpp chip/outputs.cpp chip/pin_watch.cpp
  chip/pins.cpp chip/ports.cpp chip/power.cpp chip/pwm.cpp chip/pwmx.cpp chip/registers.cpp
  chip/report.cpp chip/run.cpp chip/sci.cpp chip/sci_receive.cpp chip/sci_transmit.cpp chip/state.cpp
  chip/timer8.cpp chip/tmr.cpp chip/tmr_xy.cpp chip/wdt.cpp
  cpu/arithmetic.cpp cpu/bits.cpp cpu/branch.cpp cpu/decode.cpp cpu/disassemble.cpp cpu/memory.cpp
  cpu/move.cpp cpu/run.cpp cpu/shift.cpp cpu/system.cpp
  debug/call_stack.cpp debug/coverage.cpp debug/gdb_data.cpp debug/gdb_packet.cpp debug/gdb_port.cpp
  debug/gdb_query.cpp debug/gdb_server.cpp debug/history.cpp debug/memory_checks.cpp debug/profile.cpp
  debug/profile_output.cpp debug/trace.cpp debug/triggers.cpp debug/vcd.cpp debug/vcd_writer.cpp
  flat/flat.cpp
  netlist/netlist.cpp netlist/parts.cpp netlist/read.cpp)
set(h8s_translator_sources
  translate/block.cpp translate/code_memory.cpp translate/emit_arithmetic.cpp translate/emit_bits.cpp
  translate/emit_branch.cpp translate/emit_control.cpp translate/emit_flags.cpp translate/emit_memory.cpp
  translate/emit_registers.cpp translate/form.cpp translate/gate.cpp translate/translator.cpp)

# The translator needs asmjit; without it every program is interpreted.
find_package(asmjit CONFIG QUIET)
set(h8s_translates FALSE)
if(asmjit_FOUND AND CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  set(h8s_translates TRUE)
  list(APPEND h8s_sources ${h8s_translator_sources})
else()
  list(APPEND h8s_sources translate/absent.cpp)
endif()
