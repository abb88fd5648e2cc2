// Runs a program that raises P30, sends a byte and sleeps, and reports what the pins do.
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "sim/h8s/chip/chip.h"

namespace h8s = kaz::h8s;

// mov.b r0l to P3DDR, P3DR, MSTPCRL, BRR0, SCR0, TDR0; read SSR0; bclr #7,@SSR0; sleep.
constexpr char kProgram[] =
    "S107000000000400F4\n"
    "S1130400F8FF38B4F80138B6F87F3887F80438D9DB\n"
    "S1130410F82038DAF84138DB28DC7FDC72700180A0\n"
    "S9030400F8\n";

int main() {
  const auto image = h8s::parse_srecord(kProgram, "example");
  h8s::Chip chip;
  if (!image || !chip.load(*image)) return std::puts("cannot load"), 1;
  chip.power_on();
  chip.on_output([&](const h8s::OutputChange& change) {
    if (change.unit != h8s::OutputChange::Unit::port || change.index != 3) return;
    const h8s::PortOutput p3 = chip.output(h8s::Port::p3);
    if (p3.level)
      std::printf("P3 = %02x at state %lld\n", p3.level, static_cast<long long>(change.at));
  });
  chip.on_transmit([](int, const h8s::TransmittedByte& byte) {
    std::printf("sent '%c' in %lld states\n", byte.value,
                static_cast<long long>(byte.end - byte.start));
  });
  const h8s::Stop stop = chip.run_until(100'000);
  std::printf("stopped: %s\n", chip.asleep() ? "asleep" : stop.report.c_str());
}
