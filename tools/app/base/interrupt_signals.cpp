// Ctrl-C and termination end a program in order.
// SPDX-License-Identifier: Apache-2.0
#include "tools/app/base/interrupt_signals.h"

#include <signal.h>

#include <array>
#include <atomic>

namespace kaz::tools {
namespace {

constexpr std::array kSignals{SIGINT, SIGTERM, SIGHUP};
std::atomic<host::Interrupt*> g_interrupt{nullptr};

void on_signal(int) {
  if (host::Interrupt* interrupt = g_interrupt.load()) interrupt->request();
}

}  // namespace

InterruptSignals::InterruptSignals(host::Interrupt& interrupt) {
  g_interrupt = &interrupt;
  struct sigaction action {};
  action.sa_handler = on_signal;
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  for (const int number : kSignals) sigaction(number, &action, nullptr);
  signal(SIGPIPE, SIG_IGN);  // a camera's reader that went away is an error of write, not our end
}

InterruptSignals::~InterruptSignals() {
  for (const int number : kSignals) signal(number, SIG_DFL);
  g_interrupt = nullptr;
}

}  // namespace kaz::tools
