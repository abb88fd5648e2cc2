// The table of pins.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/chip/pins.h"

#include <algorithm>
#include <array>
#include <cctype>

namespace kaz::h8s {
namespace {

using std::string_view;

struct Row {
  int port, bit;
  bool input_only, weak_high;
  std::array<string_view, 7> names;  // the rest empty
};

// Ports 1, 2, 5, 6 and 7 as in the siblings' hardware manuals (pin functions); port 4, SCI1, PWX0/1
// and TMR0/1 from the family's 64-pin layout.
constexpr std::array<Row, kPins> kRows{{
    {1, 0, false, false, {"P10", "PW0", "PWX0"}},
    {1, 1, false, false, {"P11", "PW1", "PWX1"}},
    {1, 2, false, false, {"P12", "PW2"}},
    {1, 3, false, false, {"P13", "PW3"}},
    {1, 4, false, false, {"P14", "PW4"}},
    {1, 5, false, false, {"P15", "PW5"}},
    {1, 6, false, false, {"P16", "PW6"}},
    {1, 7, false, false, {"P17", "PW7"}},
    {2, 0, false, false, {"P20", "PW8"}},
    {2, 1, false, false, {"P21", "PW9"}},
    {2, 2, false, false, {"P22", "PW10"}},
    {2, 3, false, false, {"P23", "PW11", "SDA1"}},
    {2, 4, false, false, {"P24", "PW12", "SCL1"}},
    {2, 5, false, false, {"P25", "PW13", "TxD1"}},
    {2, 6, false, false, {"P26", "PW14", "RxD1"}},
    {2, 7, false, false, {"P27", "PW15", "SCK1", "CBLANK"}},
    {3, 0, false, false, {"P30"}},
    {3, 1, false, false, {"P31"}},
    {3, 2, false, false, {"P32"}},
    {3, 3, false, false, {"P33"}},
    {3, 4, false, false, {"P34"}},
    {3, 5, false, false, {"P35"}},
    {3, 6, false, false, {"P36"}},
    {3, 7, false, false, {"P37"}},
    {4, 0, false, false, {"P40", "IRQ2", "ADTRG"}},
    {4, 1, false, false, {"P41", "IRQ1"}},
    {4, 2, false, false, {"P42", "IRQ0"}},
    {4, 3, false, false, {"P43"}},
    {4, 4, false, false, {"P44"}},
    {4, 5, false, false, {"P45"}},
    {4, 6, false, false, {"P46", "PHI", "EXCL"}},
    {4, 7, false, true, {"P47", "SDA0"}},
    {5, 0, false, false, {"P50", "TxD0"}},
    {5, 1, false, false, {"P51", "RxD0"}},
    {5, 2, false, true, {"P52", "SCK0", "SCL0"}},
    {6, 0, false, false, {"P60", "FTCI", "TMIX", "CIN0", "HFBACKI", "TMCI0"}},
    {6, 1, false, false, {"P61", "FTOA", "CIN1", "VSYNCO"}},
    {6, 2, false, false, {"P62", "FTIA", "TMIY", "CIN2", "VSYNCI"}},
    {6, 3, false, false, {"P63", "FTIB", "CIN3", "VFBACKI", "TMRI0"}},
    {6, 4, false, false, {"P64", "FTIC", "CIN4", "CLAMPO", "TMO0"}},
    {6, 5, false, false, {"P65", "FTID", "CIN5", "HSYNCI", "TMCI1"}},
    {6, 6, false, false, {"P66", "FTOB", "CIN6", "CSYNCI", "TMRI1"}},
    {6, 7, false, false, {"P67", "TMOX", "CIN7", "HSYNCO", "TMO1"}},
    {7, 0, true, false, {"P70", "AN0"}},
    {7, 1, true, false, {"P71", "AN1"}},
    {7, 2, true, false, {"P72", "AN2"}},
    {7, 3, true, false, {"P73", "AN3"}},
    {7, 4, true, false, {"P74", "AN4"}},
    {7, 5, true, false, {"P75", "AN5"}},
    {7, 6, true, false, {"P76", "AN6"}},
    {7, 7, true, false, {"P77", "AN7"}},
    {0, 0, true, false, {"NMI"}},
    {0, 1, true, false, {"RES"}},
    {0, 2, true, false, {"STBY"}},
    {0, 3, true, false, {"MD0"}},
    {0, 4, true, false, {"MD1"}},
}};

constexpr auto make_table() {
  std::array<PinInfo, kPins> table{};
  for (std::size_t k = 0; k < kPins; ++k) {
    const Row& row = kRows[k];
    std::size_t count = 0;
    while (count < row.names.size() && !row.names[count].empty()) ++count;
    table[k] = {static_cast<Pin>(k),       row.port,       row.bit,
                {row.names.data(), count}, row.input_only, row.weak_high};
  }
  return table;
}
constexpr std::array<PinInfo, kPins> kTable = make_table();

bool same(string_view a, string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](char x, char y) {
    return std::tolower(static_cast<unsigned char>(x)) ==
           std::tolower(static_cast<unsigned char>(y));
  });
}

}  // namespace

std::span<const PinInfo> pin_table() {
  return kTable;
}

const PinInfo& info(Pin pin) {
  return kTable[static_cast<std::size_t>(pin)];
}

std::optional<Pin> find_pin(string_view wanted) {
  for (const PinInfo& p : kTable) {
    for (const string_view n : p.names) {
      if (same(n, wanted)) return p.pin;
    }
  }
  return std::nullopt;
}

std::optional<Pin> pin_of(int port, int bit) {
  for (const PinInfo& p : kTable) {
    if (port != 0 && p.port == port && p.bit == bit) return p.pin;
  }
  return std::nullopt;
}

string_view name(Driver driver) {
  switch (driver) {
    case Driver::nobody:
      return "nobody";
    case Driver::pull_up:
      return "pull-up";
    case Driver::board:
      return "board";
    case Driver::port:
      return "port";
    case Driver::pwm:
      return "PWM";
    case Driver::pwmx:
      return "PWMX";
    case Driver::frt:
      return "FRT";
    case Driver::tmr:
      return "8-bit timer";
    case Driver::sci:
      return "SCI";
    case Driver::clock:
      return "clock";
  }
  return "nobody";
}

}  // namespace kaz::h8s
