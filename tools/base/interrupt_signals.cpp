// Ctrl-C and termination end a program in order.
// SPDX-License-Identifier: Apache-2.0
#include "tools/base/interrupt_signals.h"

#include <limits.h>
#include <signal.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string_view>

namespace kaz::tools {
namespace {

constexpr std::array kSignals{SIGINT, SIGTERM, SIGHUP};
std::atomic<host::Interrupt*> g_interrupt{nullptr};
std::atomic<int> g_received{0};
std::atomic<std::int64_t> g_first_ns{0};  // when; 0: none came
// Written before signals come, and printed by their handler.
char g_verb[64] = "kaz";
char g_left_behind[1024] = "";
std::atomic<bool> g_leaves_something{false};
struct AtLast {
  char path[PATH_MAX];
  std::atomic<bool> used;
};
std::array<AtLast, 16> g_files_at_last{};
using Last = void (*)() noexcept;
std::atomic<Last> g_last{nullptr};
static_assert(std::atomic<Last>::is_always_lock_free);
static_assert(std::atomic<bool>::is_always_lock_free);
static_assert(std::atomic<int>::is_always_lock_free);
static_assert(std::atomic<std::int64_t>::is_always_lock_free);
static_assert(std::atomic<host::Interrupt*>::is_always_lock_free);

std::int64_t monotonic_ns() {
  timespec t{};
  clock_gettime(CLOCK_MONOTONIC, &t);
  return std::int64_t{t.tv_sec} * 1'000'000'000 + t.tv_nsec;
}

void print(std::string_view text) {
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, text.data(), text.size());
}

void remove_files_at_last() {
  for (const AtLast& file : g_files_at_last) {
    struct stat about {};
    if (file.used && ::stat(file.path, &about) == 0 && about.st_size == 0) ::unlink(file.path);
  }
}

void end_at_once(int number) {
  if (const Last last = g_last) last();
  remove_files_at_last();
  print("\n");
  print(g_verb);
  print(": interrupted, ended at once");
  if (g_leaves_something) {
    print("; ");
    print(g_left_behind);
  }
  print("\n");
  ::_exit(static_cast<int>(Fault::interrupted) + number);
}

void on_signal(int number) {
  const std::int64_t now = monotonic_ns();
  std::int64_t first = 0;
  if (!g_first_ns.compare_exchange_strong(first, now)) {
    constexpr std::int64_t kWindow = std::chrono::nanoseconds(kOneSignal).count();
    if (now - first >= kWindow) end_at_once(number);
    return;
  }
  g_received = number;
  host::Interrupt* const interrupt = g_interrupt.load();
  if (interrupt == nullptr) end_at_once(number);
  interrupt->request();
}

}  // namespace

void catch_signals() {
  struct sigaction action {};
  action.sa_handler = on_signal;
  // Of two that are pending the kernel would run the later one's handler inside the earlier one's.
  for (const int number : kSignals) sigaddset(&action.sa_mask, number);
  // No SA_RESTART: a wait in the kernel ends too.
  for (const int number : kSignals) {
    struct sigaction before {};
    sigaction(number, nullptr, &before);
    // Only SIGHUP: shells start background commands with SIGINT ignored, and those are to end by it.
    if (number == SIGHUP && before.sa_handler == SIG_IGN) continue;
    sigaction(number, &action, nullptr);
  }
}

void name_verb(const std::string& verb) {
  std::snprintf(g_verb, sizeof g_verb, "%s", verb.c_str());
}

std::string named_verb() {
  return g_verb;
}

void leaves_behind(const std::string& sentence) {
  g_leaves_something = false;
  std::snprintf(g_left_behind, sizeof g_left_behind, "%s", sentence.c_str());
  g_leaves_something = !sentence.empty();
}

void does_at_last(Last last) {
  g_last = last;
}

int remove_empty_file_at_last(const std::string& path) {
  for (std::size_t i = 0; i < g_files_at_last.size(); ++i) {
    AtLast& file = g_files_at_last[i];
    if (file.used || path.size() >= sizeof file.path) continue;
    std::snprintf(file.path, sizeof file.path, "%s", path.c_str());
    file.used = true;
    return static_cast<int>(i);
  }
  return -1;
}

void forget_file(int number) {
  if (number >= 0) g_files_at_last[static_cast<std::size_t>(number)].used = false;
}

int received_signal() noexcept {
  return g_received.load();
}

void forget_signal() noexcept {
  g_received = 0;
  g_first_ns = 0;
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

void InterruptSignals::forget_earlier() {
  g_interrupt = nullptr;
  g_last = nullptr;
  for (AtLast& file : g_files_at_last) file.used = false;
  g_received = 0;
  g_first_ns = 0;
}

}  // namespace kaz::tools
