// Signal and exit handlers that park a thread, and the thread that ends the process in order.
// SPDX-License-Identifier: Apache-2.0
#include "tools/app/session/plugin_guard.h"

#include <cxxabi.h>
#include <dlfcn.h>
#include <execinfo.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <climits>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <new>
#include <optional>
#include <system_error>
#include <thread>
#include <typeinfo>

#include "shared/base/one_line.hpp"
#include "tools/app/base/interrupt_signals.h"
#include "tools/app/session/plugin_symbol.h"

namespace kaz::tools {
namespace {

using Steady = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr milliseconds kAnnounceAfter{1000};
constexpr milliseconds kPatience{300};  // after an interrupt
constexpr milliseconds kLongestEnd{10'000};

constexpr std::array kCrashes{SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGTRAP, SIGSYS};

enum class State { running, crashed, exited, ending, over };

// What handlers need: they may not allocate.
struct Guarded {
  std::atomic<State> state{State::over};
  pid_t process = 0;
  std::atomic<pid_t> guard_thread{0};
  int wake = -1;  // eventfd: crashed or exited is complete
  char path[PATH_MAX] = {};
  int number = 0;  // signal or status
  const char* call = "";
  char thrown[1000] = {};             // the sentence of an exception that nothing catches
  std::uint64_t offset = 0;           // of the place in the plug-in; 0: none there
  std::atomic<bool> finished{false};  // a parked thread may end the process
};
Guarded g_guarded;
alignas(16) char g_alternate_stack[1 << 16];  // of a handler after an overflow of the stack

pid_t this_thread() {
  return static_cast<pid_t>(::syscall(SYS_gettid));
}

[[noreturn]] void exit_now(int status) {
  ::syscall(SYS_exit_group, status);
  std::abort();
}

void note_place() {
  void* frames[64];
  const int count = ::backtrace(frames, static_cast<int>(std::size(frames)));
  for (int i = 0; i < count; ++i) {
    Dl_info object{};
    if (::dladdr(frames[i], &object) == 0 || object.dli_fname == nullptr ||
        std::strcmp(object.dli_fname, g_guarded.path) != 0)
      continue;
    g_guarded.offset = reinterpret_cast<std::uintptr_t>(frames[i]) -
                       reinterpret_cast<std::uintptr_t>(object.dli_fbase);
    return;
  }
}

// Parks the thread until the guard's thread has done its work. False at once where nobody guards: then it is
// not the plug-in's affair, or the guard itself has failed.
bool park(State why, const char* call, int number) {
  Guarded& g = g_guarded;
  if (g.state == State::over || ::getpid() != g.process || this_thread() == g.guard_thread)
    return false;
  State running = State::running;
  if (g.state.compare_exchange_strong(running, why)) {
    g.call = call;
    g.number = number;
    note_place();
    const std::uint64_t one = 1;
    [[maybe_unused]] const ssize_t written = ::write(g.wake, &one, sizeof one);
  }
  for (milliseconds waited{0}; waited < kLongestEnd && !g.finished; waited += milliseconds(10))
    ::poll(nullptr, 0, 10);
  return true;
}

void on_crash(int number) {
  const int saved_errno = errno;
  park(State::crashed, "", number);
  // Now as without a guard: at the return the fault repeats, or the signal that is pending comes.
  std::signal(number, SIG_DFL);
  ::raise(number);
  errno = saved_errno;
}

void on_exit_call(int status, void*) {
  before_exit("exit", status);
}

void on_quick_exit() {
  before_exit("quick_exit", 0);
}

[[noreturn]] void on_terminate() {
  if (std::current_exception() && g_guarded.state == State::running) {
    const std::string thrown = thrown_error(g_guarded.path).message + " (not caught)";
    g_guarded.thrown[thrown.copy(g_guarded.thrown, sizeof g_guarded.thrown - 1)] = '\0';
    before_exit("", 0);
  }
  std::abort();
}

std::string type_name(const std::type_info& type) {
  int status = 0;
  const std::unique_ptr<char, void (*)(void*)> text(
      abi::__cxa_demangle(type.name(), nullptr, nullptr, &status), std::free);
  return status == 0 ? text.get() : type.name();
}

// " in `function`"
std::string place() {
  const std::uint64_t offset = g_guarded.offset;
  if (offset == 0) return {};
  // What is noted is where a call returns to, or the instruction itself.
  std::string function = function_at(g_guarded.path, offset - 1);
  if (function.empty()) function = function_at(g_guarded.path, offset);
  if (!function.empty()) return " in `" + function + "`";
  char hex[32];
  std::snprintf(hex, sizeof hex, "0x%llx", static_cast<unsigned long long>(offset));
  return std::string(" at ") + hex + " (addr2line -Cfe names the function)";
}

void say(const std::string& label, const std::string& sentence) {
  const std::string line = label + ": " + one_line(sentence) + "\n";
  // No lock that a crashed thread may hold.
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, line.data(), line.size());
}

}  // namespace

void before_exit(const char* function, int status) {
  if (!park(State::exited, function, status)) return;
  exit_now(static_cast<int>(Fault::failed));  // the guard's thread has not come to its end
}

struct PluginGuard::Parts {
  explicit Parts(PluginGuardOptions o) : options(std::move(o)) {}

  void watch();
  void watch_calls();
  void announce();
  void end_deaf();
  [[noreturn]] void end(PluginEnd end);
  PluginEnd crash() const;
  PluginEnd exit_call() const;
  std::string while_loaded() const {
    return options.doing == "loaded" ? " while it was loaded" : "";
  }

  PluginGuardOptions options;
  std::thread thread;
  std::array<struct sigaction, kCrashes.size()> before{};
  stack_t stack_before{};
  std::terminate_handler terminate_before = nullptr;
  std::uint64_t count = 0;  // calls into Kaz
  Steady::time_point quiet_since = Steady::now();
  std::optional<std::uint64_t> count_at_request;
  std::optional<Steady::time_point> deaf_since;
  bool announced = false;
};

PluginEnd PluginGuard::Parts::crash() const {
  const int number = g_guarded.number;
  const std::string name = std::string("SIG") + sigabbrev_np(number);
  const std::string what = ": " + name + " (" + sigdescr_np(number) + ")";
  const std::string where = place();
  return {
      {Fault::failed, where.empty() ? "this program crashed while " + options.path + " was " +
                                          options.doing + what + ", outside of the plug-in's code"
                                    : options.path + " crashed" + while_loaded() + where + what},
      name};
}

PluginEnd PluginGuard::Parts::exit_call() const {
  if (g_guarded.thrown[0] != '\0')
    return {{options.fault,
             g_guarded.thrown + (while_loaded().empty() ? "" : "," + while_loaded()) + place()},
            "an exception"};
  const std::string call =
      std::string(g_guarded.call) + "(" + std::to_string(g_guarded.number) + ")";
  return {{options.fault, options.path + " called " + call + while_loaded() + place() +
                              ": a behavior must return, and must not end the program"},
          call};
}

// Ends the process: after a crash by the thread that crashed, so that a core dump begins there.
void PluginGuard::Parts::end(PluginEnd end) {
  const bool crashed = g_guarded.state == State::crashed;
  try {
    if (options.finish) end.error.message += options.finish(end);
    if (options.before_message) options.before_message();
  } catch (const std::exception& error) {
    end.error.message += std::string("; ") + error.what();
  }
  say(options.label, end.error.message);
  if (::ftrylockfile(stdout) == 0) ::fflush_unlocked(stdout);
  if (!crashed) exit_now(exit_status(end.error));
  g_guarded.finished = true;
  while (true) ::pause();
}

// After an interrupt that has ended every call: the plug-in goes on although they fail, or makes none.
void PluginGuard::Parts::end_deaf() {
  State running = State::running;
  if (!g_guarded.state.compare_exchange_strong(running, State::ending)) return;
  if (options.gate != nullptr) (void)options.gate->shut(milliseconds(2000));
  if (received_signal() == 0)
    end({{Fault::failed, options.path + " does not return although its calls fail"}, "its end"});
  end({{Fault::interrupted, options.path + " did not return"}, received_signal_name()});
}

void PluginGuard::Parts::announce() {
  announced = true;
  // Not while a call writes messages of its own.
  if (options.gate != nullptr && !options.gate->shut(milliseconds(0))) return;
  if (options.before_message) options.before_message();
  if (options.doing == "loaded") {
    say(options.label, "waiting for " + options.path + ", which is being loaded");
  } else {
    say(options.label, "waiting for " + options.path +
                           ", which has not called Kaz for 1 s; press Ctrl-C to end the program");
  }
  if (options.gate != nullptr) options.gate->open();
}

void PluginGuard::Parts::watch_calls() {
  const auto now = Steady::now();
  const bool in_call = options.gate != nullptr && options.gate->in_call();
  const std::uint64_t newest = options.gate != nullptr ? options.gate->count() : 0;
  if (in_call || newest != count) {
    count = newest;
    quiet_since = now;
    announced = false;
  }
  if (options.interrupt == nullptr || !options.interrupt->requested()) {
    if (!announced && now - quiet_since > kAnnounceAfter) announce();
    return;
  }
  if (!count_at_request) count_at_request = newest;
  // A call that was under way ends by the interrupt; from then on the plug-in has to return.
  if (!deaf_since && (!in_call || newest != *count_at_request)) deaf_since = now;
  if (deaf_since && now - *deaf_since > kPatience) end_deaf();
}

void PluginGuard::Parts::watch() {
  g_guarded.guard_thread = this_thread();
  while (g_guarded.state != State::over) {
    pollfd wake{g_guarded.wake, POLLIN, 0};
    const bool woken = ::poll(&wake, 1, 20) > 0;
    const State state = g_guarded.state;
    if (woken && state == State::crashed) end(crash());
    if (woken && state == State::exited) end(exit_call());
    if (state == State::running) watch_calls();
  }
}

PluginGuard::PluginGuard(PluginGuardOptions options)
    : parts_(std::make_unique<Parts>(std::move(options))) {
  Guarded& g = g_guarded;
  std::error_code none;
  const std::string full = std::filesystem::absolute(parts_->options.path, none).string();
  full.copy(g.path, sizeof g.path - 1);
  g.path[std::min(full.size(), sizeof g.path - 1)] = '\0';
  g.process = ::getpid();
  g.offset = 0;
  g.thrown[0] = '\0';
  g.finished = false;
  g.wake = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  if (g.wake < 0) throw std::system_error(errno, std::generic_category(), "eventfd");
  void* frame = nullptr;
  ::backtrace(&frame, 1);  // loads what it needs, which a handler could not

  // The newest handlers of exit() run first: before anything of this program is destroyed.
  ::on_exit(on_exit_call, nullptr);
  std::at_quick_exit(on_quick_exit);
  const stack_t stack{g_alternate_stack, 0, sizeof g_alternate_stack};
  ::sigaltstack(&stack, &parts_->stack_before);
  struct sigaction action {};
  action.sa_handler = on_crash;
  action.sa_flags = SA_ONSTACK;
  for (std::size_t i = 0; i < kCrashes.size(); ++i)
    ::sigaction(kCrashes[i], &action, &parts_->before[i]);

  parts_->terminate_before = std::set_terminate(on_terminate);
  g.state = State::running;
  sigset_t all, before;
  sigfillset(&all);
  ::pthread_sigmask(SIG_SETMASK, &all, &before);
  parts_->thread = std::thread([parts = parts_.get()] { parts->watch(); });
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

PluginGuard::~PluginGuard() {
  Guarded& g = g_guarded;
  State running = State::running;
  if (!g.state.compare_exchange_strong(running, State::over)) {
    while (true) ::pause();  // the guard's thread ends the process
  }
  const std::uint64_t one = 1;
  [[maybe_unused]] const ssize_t written = ::write(g.wake, &one, sizeof one);
  parts_->thread.join();
  g.guard_thread = 0;
  ::close(g.wake);
  for (std::size_t i = 0; i < kCrashes.size(); ++i)
    ::sigaction(kCrashes[i], &parts_->before[i], nullptr);
  ::sigaltstack(&parts_->stack_before, nullptr);
  std::set_terminate(parts_->terminate_before);
}

Error thrown_error(const std::string& who) {
  const std::type_info* const type = abi::__cxa_current_exception_type();
  const std::string what = who + " threw " + (type == nullptr ? "an exception" : type_name(*type));
  try {
    throw;
  } catch (const std::bad_alloc&) {
    return {Fault::environment, what + ": out of memory"};
  } catch (const std::exception& error) {
    return {Fault::failed, what + ": " + error.what()};
  } catch (...) {
    return {Fault::failed, what};
  }
}

Result<behavior::Behavior> guarded_behavior(const std::string& name, const std::string& label) {
  if (!behavior::names_plugin(name)) return behavior::named_behavior(name);
  const PluginGuard guard({.label = label, .path = name, .doing = "loaded", .fault = Fault::usage});
  try {
    return behavior::load_behavior(name);
  } catch (const abi::__forced_unwind&) {  // pthread_exit()
    before_exit("pthread_exit", 0);
    throw;
  } catch (...) {
    Error error = thrown_error(name);
    if (error.fault == Fault::failed) error.fault = Fault::usage;
    error.message += " while it was loaded";
    return tl::unexpected(std::move(error));
  }
}

}  // namespace kaz::tools
