// Ctrl-C and termination end a program in order.
// SPDX-License-Identifier: Apache-2.0
#include "tools/app/base/interrupt_signals.h"

#include <signal.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <nlohmann/json.hpp>
#include <string_view>

namespace kaz::tools {
namespace {

constexpr std::array kSignals{SIGINT, SIGTERM, SIGHUP};
std::atomic<host::Interrupt*> g_interrupt{nullptr};
std::atomic<int> g_received{0};
static_assert(std::atomic<int>::is_always_lock_free);
static_assert(std::atomic<host::Interrupt*>::is_always_lock_free);

void end_at_once(int number) {
  constexpr std::string_view kSentence = "\nkaz: interrupted, ended at once\n";
  [[maybe_unused]] const ssize_t written =
      ::write(STDERR_FILENO, kSentence.data(), kSentence.size());
  ::_exit(static_cast<int>(Fault::interrupted) + number);
}

void on_signal(int number) {
  int none = 0;
  const bool first = g_received.compare_exchange_strong(none, number);
  host::Interrupt* const interrupt = g_interrupt.load();
  if (!first || interrupt == nullptr) end_at_once(number);
  interrupt->request();
}

}  // namespace

void catch_signals() {
  struct sigaction action {};
  action.sa_handler = on_signal;
  // No SA_RESTART: a wait in the kernel ends too.
  for (const int number : kSignals) {
    struct sigaction before {};
    sigaction(number, nullptr, &before);
    // Only SIGHUP: shells start background commands with SIGINT ignored, and those are to end by it.
    if (number == SIGHUP && before.sa_handler == SIG_IGN) continue;
    sigaction(number, &action, nullptr);
  }
}

int received_signal() noexcept {
  return g_received.load();
}

const char* received_signal_name() noexcept {
  switch (received_signal()) {
    case SIGINT:
      return "SIGINT";
    case SIGTERM:
      return "SIGTERM";
    case SIGHUP:
      return "SIGHUP";
    default:
      return "no signal";
  }
}

int exit_status(const Error& error) {
  const int status = static_cast<int>(error.fault);
  return error.fault == Fault::interrupted ? status + received_signal() : status;
}

void mark_interrupted(nlohmann::ordered_json& result) {
  result["interrupted"] = true;
  result["signal"] = received_signal_name();
}

InterruptSignals::InterruptSignals(host::Interrupt& interrupt) : outer_(g_interrupt.load()) {
  g_interrupt = &interrupt;
  catch_signals();
  signal(SIGPIPE, SIG_IGN);  // a camera's reader that went away is an error of write, not our end
  if (received_signal() != 0) interrupt.request();
}

InterruptSignals::~InterruptSignals() {
  g_interrupt = outer_;
}

void InterruptSignals::forget_parent() {
  g_interrupt = nullptr;
  g_received = 0;
}

}  // namespace kaz::tools
