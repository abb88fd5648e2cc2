// The table of I/O registers (hardware manual, register list; addresses as on the siblings).
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/chip/registers.h"

#include <algorithm>
#include <cctype>

namespace kaz::h8s {
namespace {

using enum Bank;

// In the order of addresses.
constexpr RegisterInfo kRegisters[] = {
    // clang-format off
    {"KBCOMP", 0xfee4, 1, "ADC"},
    {"ICRA", 0xfee8, 1, "INTC"}, {"ICRB", 0xfee9, 1, "INTC"}, {"ICRC", 0xfeea, 1, "INTC"},
    {"ISR", 0xfeeb, 1, "INTC"}, {"ISCRH", 0xfeec, 1, "INTC"}, {"ISCRL", 0xfeed, 1, "INTC"},
    {"DTCERA", 0xfeee, 1, "DTC"}, {"DTCERB", 0xfeef, 1, "DTC"}, {"DTCERC", 0xfef0, 1, "DTC"},
    {"DTCERD", 0xfef1, 1, "DTC"}, {"DTCERE", 0xfef2, 1, "DTC"}, {"DTVECR", 0xfef3, 1, "DTC"},
    {"ABRKCR", 0xfef4, 1, "INTC"}, {"BARA", 0xfef5, 1, "INTC"}, {"BARB", 0xfef6, 1, "INTC"},
    {"BARC", 0xfef7, 1, "INTC"},
    {"FLMCR1", 0xff80, 1, "FLASH", flshe_1}, {"FLMCR2", 0xff81, 1, "FLASH", flshe_1},
    {"PCSR", 0xff82, 1, "PWM", flshe_0}, {"EBR1", 0xff82, 1, "FLASH", flshe_1},
    {"SYSCR2", 0xff83, 1, "SYSTEM", flshe_0}, {"EBR2", 0xff83, 1, "FLASH", flshe_1},
    {"SBYCR", 0xff84, 1, "SYSTEM", flshe_0}, {"LPWRCR", 0xff85, 1, "SYSTEM", flshe_0},
    {"MSTPCRH", 0xff86, 1, "SYSTEM", flshe_0}, {"MSTPCRL", 0xff87, 1, "SYSTEM", flshe_0},
    {"SMR1", 0xff88, 1, "SCI1", iice_0}, {"BRR1", 0xff89, 1, "SCI1", iice_0},
    {"SCR1", 0xff8a, 1, "SCI1"}, {"TDR1", 0xff8b, 1, "SCI1"}, {"SSR1", 0xff8c, 1, "SCI1"},
    {"RDR1", 0xff8d, 1, "SCI1"}, {"SCMR1", 0xff8e, 1, "SCI1", iice_0},
    {"TIER", 0xff90, 1, "FRT"}, {"TCSR", 0xff91, 1, "FRT"}, {"FRC", 0xff92, 2, "FRT"},
    {"OCRA", 0xff94, 2, "FRT", ocrs_0}, {"OCRB", 0xff94, 2, "FRT", ocrs_1},
    {"TCR", 0xff96, 1, "FRT"}, {"TOCR", 0xff97, 1, "FRT"},
    {"ICRA16", 0xff98, 2, "FRT", icrs_0}, {"OCRAR", 0xff98, 2, "FRT", icrs_1},
    {"ICRB16", 0xff9a, 2, "FRT", icrs_0}, {"OCRAF", 0xff9a, 2, "FRT", icrs_1},
    {"ICRC16", 0xff9c, 2, "FRT", icrs_0}, {"OCRDM", 0xff9c, 2, "FRT", icrs_1},
    {"ICRD16", 0xff9e, 2, "FRT"},
    {"DADRA", 0xffa0, 2, "PWMX", regs_0}, {"DACR", 0xffa0, 1, "PWMX", regs_1},
    {"DADRB", 0xffa6, 2, "PWMX", regs_0}, {"DACNT", 0xffa6, 2, "PWMX", regs_1},
    {"WTCSR0", 0xffa8, 1, "WDT0"}, {"WTCNT0", 0xffa9, 1, "WDT0"},
    {"P1PCR", 0xffac, 1, "PORTS"}, {"P2PCR", 0xffad, 1, "PORTS"}, {"P3PCR", 0xffae, 1, "PORTS"},
    {"P1DDR", 0xffb0, 1, "PORTS", always, true}, {"P2DDR", 0xffb1, 1, "PORTS", always, true},
    {"P1DR", 0xffb2, 1, "PORTS"}, {"P2DR", 0xffb3, 1, "PORTS"},
    {"P3DDR", 0xffb4, 1, "PORTS", always, true}, {"P4DDR", 0xffb5, 1, "PORTS", always, true},
    {"P3DR", 0xffb6, 1, "PORTS"}, {"P4DR", 0xffb7, 1, "PORTS"},
    {"P5DDR", 0xffb8, 1, "PORTS", always, true}, {"P6DDR", 0xffb9, 1, "PORTS", always, true},
    {"P5DR", 0xffba, 1, "PORTS"}, {"P6DR", 0xffbb, 1, "PORTS"}, {"P7PIN", 0xffbe, 1, "PORTS"},
    {"IER", 0xffc2, 1, "INTC"}, {"STCR", 0xffc3, 1, "SYSTEM"}, {"SYSCR", 0xffc4, 1, "SYSTEM"},
    {"MDCR", 0xffc5, 1, "SYSTEM"}, {"BCR", 0xffc6, 1, "SYSTEM"}, {"WSCR", 0xffc7, 1, "SYSTEM"},
    {"TCR0", 0xffc8, 1, "TMR0"}, {"TCR1", 0xffc9, 1, "TMR1"}, {"TCSR0", 0xffca, 1, "TMR0"},
    {"TCSR1", 0xffcb, 1, "TMR1"}, {"TCORA0", 0xffcc, 1, "TMR0"}, {"TCORA1", 0xffcd, 1, "TMR1"},
    {"TCORB0", 0xffce, 1, "TMR0"}, {"TCORB1", 0xffcf, 1, "TMR1"}, {"TCNT0", 0xffd0, 1, "TMR0"},
    {"TCNT1", 0xffd1, 1, "TMR1"},
    {"PWOERB", 0xffd2, 1, "PWM"}, {"PWOERA", 0xffd3, 1, "PWM"}, {"PWDPRB", 0xffd4, 1, "PWM"},
    {"PWDPRA", 0xffd5, 1, "PWM"}, {"PWSL", 0xffd6, 1, "PWM"}, {"PWDR", 0xffd7, 1, "PWM"},
    {"SMR0", 0xffd8, 1, "SCI0", iice_0}, {"BRR0", 0xffd9, 1, "SCI0", iice_0},
    {"SCR0", 0xffda, 1, "SCI0"}, {"TDR0", 0xffdb, 1, "SCI0"}, {"SSR0", 0xffdc, 1, "SCI0"},
    {"RDR0", 0xffdd, 1, "SCI0"}, {"SCMR0", 0xffde, 1, "SCI0", iice_0},
    {"ADDRA", 0xffe0, 2, "ADC"}, {"ADDRB", 0xffe2, 2, "ADC"}, {"ADDRC", 0xffe4, 2, "ADC"},
    {"ADDRD", 0xffe6, 2, "ADC"}, {"ADCSR", 0xffe8, 1, "ADC"}, {"ADCR", 0xffe9, 1, "ADC"},
    {"WTCSR1", 0xffea, 1, "WDT1"}, {"WTCNT1", 0xffeb, 1, "WDT1"},
    {"TCRX", 0xfff0, 1, "TMRX", tmrx}, {"TCRY", 0xfff0, 1, "TMRY", tmry},
    {"TCSRX", 0xfff1, 1, "TMRX", tmrx}, {"TCSRY", 0xfff1, 1, "TMRY", tmry},
    {"TICRR", 0xfff2, 1, "TMRX", tmrx}, {"TCORAY", 0xfff2, 1, "TMRY", tmry},
    {"TICRF", 0xfff3, 1, "TMRX", tmrx}, {"TCORBY", 0xfff3, 1, "TMRY", tmry},
    {"TCNTX", 0xfff4, 1, "TMRX", tmrx}, {"TCNTY", 0xfff4, 1, "TMRY", tmry},
    {"TCORC", 0xfff5, 1, "TMRX", tmrx}, {"TISR", 0xfff5, 1, "TMRY", tmry},
    {"TCORAX", 0xfff6, 1, "TMRX", tmrx}, {"TCORBX", 0xfff7, 1, "TMRX", tmrx},
    {"TCONRI", 0xfffc, 1, "TMRX"}, {"TCONRO", 0xfffd, 1, "TMRX"}, {"TCONRS", 0xfffe, 1, "TMRX"},
    {"SEDGR", 0xffff, 1, "TMRX"},
    // clang-format on
};

using Peek = std::function<std::optional<std::uint8_t>(std::uint32_t)>;

bool bit(const Peek& peek, std::uint32_t address, int n) {
  return (peek(address).value_or(0) >> n & 1) != 0;
}

}  // namespace

std::span<const RegisterInfo> register_table() {
  return kRegisters;
}

const RegisterInfo* find_register(std::string_view name) {
  const auto same = [](char x, char y) {
    return std::toupper(static_cast<unsigned char>(x)) ==
           std::toupper(static_cast<unsigned char>(y));
  };
  for (const RegisterInfo& r : kRegisters) {
    if (std::equal(r.name.begin(), r.name.end(), name.begin(), name.end(), same)) return &r;
  }
  return nullptr;
}

bool selected(const RegisterInfo& r, const Peek& peek) {
  switch (r.bank) {
    case always:
      return true;
    case flshe_0:
    case flshe_1:
      return bit(peek, 0xffffc3, 3) == (r.bank == flshe_1);
    case iice_0:
    case iice_1:
      return bit(peek, 0xffffc3, 4) == (r.bank == iice_1);
    case tmrx:
    case tmry:
      return bit(peek, 0xfffffe, 7) == (r.bank == tmry);
    case ocrs_0:
    case ocrs_1:
      return bit(peek, 0xffff97, 4) == (r.bank == ocrs_1);
    case icrs_0:
    case icrs_1:
      return bit(peek, 0xffff97, 5) == (r.bank == icrs_1);
    case regs_0:
    case regs_1:
      return bit(peek, 0xffffc3, 4) && bit(peek, 0xffffa7, 0) == (r.bank == regs_1);
  }
  return false;
}

const RegisterInfo* register_at(std::uint32_t address, const Peek& peek) {
  const std::uint32_t a = address & 0xffff;
  for (const RegisterInfo& r : kRegisters) {
    if (a >= r.address && a < r.address + std::uint32_t{r.size} && selected(r, peek)) return &r;
  }
  return nullptr;
}

}  // namespace kaz::h8s
