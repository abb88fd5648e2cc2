// A plug-in that does what a behaviour must not do: its option `does` says what. AT_LOAD: while it is loaded.
// SPDX-License-Identifier: Apache-2.0
#include <pthread.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <limits>
#include <stdexcept>
#include <string_view>
#include <thread>

#include "host/behavior/control_cycle.h"
#include "host/behavior/plugin.h"

namespace {

using namespace kaz;
using behavior::Context;
using behavior::Outcome;

volatile int g_depth = 0;

[[gnu::noinline]] void write_to_null() {
  volatile int* volatile nowhere = nullptr;
  *nowhere = 1;
}

[[gnu::noinline]] int overflow_stack(int depth) {  // NOLINT(misc-no-recursion)
  volatile char page[4096];
  page[0] = static_cast<char>(depth);
  g_depth = depth;
  return overflow_stack(depth + 1) + page[0];
}

[[gnu::noinline]] void leave(int status) {
  std::exit(status);
}

// What ends the function or the process.
[[gnu::noinline]] void end_somehow(std::string_view what) {
  if (what == "throw") throw std::runtime_error("no more");
  if (what == "throw-int") throw 7;
  if (what == "exit") leave(3);
  if (what == "_exit") ::_exit(0);
  if (what == "_Exit") std::_Exit(0);
  if (what == "pthread-exit") ::pthread_exit(nullptr);
  if (what == "abort") std::abort();
  if (what == "crash") write_to_null();
  if (what == "thread-throw") std::thread([] { throw std::runtime_error("no more"); }).join();
  if (what == "thread") std::thread(write_to_null).join();
  if (what == "overflow") overflow_stack(0);
  if (what == "loop") {
    while (g_depth == 0) {
    }
  }
  if (what == "sleep") {
    while (g_depth == 0) std::this_thread::sleep_for(std::chrono::seconds(100));
  }
}

constexpr behavior::Option kOptions[] = {
    {"does", "nothing",
     "nothing|throw|throw-int|exit|_exit|_Exit|pthread-exit|abort|crash|thread|thread-throw|"
     "overflow|loop|sleep|"
     "deaf|empty|no-sentence|no-text|interrupted|nan|no-option|wrong-kind",
     0, 0, "what it does after 0.2 s"}};

Result<Outcome> run(Context& context) {
  KAZ_TRY(behavior::hold_still(context.robot));
  context.sink.phase(context.clock.now(), "hostile", "harmless");
  KAZ_TRY(context.clock.sleep_until(context.clock.now() + from_seconds(0.2)));
  const std::string_view what = context.options.choice("does");
  context.sink.phase(context.clock.now(), "hostile", "now");
  end_somehow(what);
  while (what == "deaf") (void)context.robot.state();
  if (what == "empty") return Outcome{};
  if (what == "no-sentence") return fail(Fault::failed, "");
  if (what == "no-text") return Outcome{false, "\xff\xfe", {{"\xff", 1}}, "\xff"};
  if (what == "interrupted") return fail(Fault::interrupted, "interrupted");
  if (what == "no-option") return Outcome{context.options.number("times") > 0, "", {}, {}};
  if (what == "wrong-kind") return Outcome{context.options.number("does") > 0, "", {}, {}};
  if (what == "nan") {
    const host::JointTarget targets[] = {
        {host::neck_pan, std::numeric_limits<double>::quiet_NaN()}};
    KAZ_TRY(context.robot.set_targets(targets, from_seconds(1)));
  }
  return Outcome{true, "nothing was done", {}, {}};
}

#ifdef AT_LOAD
const int g_loaded = (end_somehow(AT_LOAD), 1);
#endif
#ifndef NAME
#define NAME "hostile"
#endif
constexpr behavior::Option kWrongDefault[] = {{"times", "11", "", 1, 10, "too many", true}};

constinit const behavior::Behavior kHostile{NAME, "does what it must not", false,
                                            std::string_view(NAME) == "wrong-default"
                                                ? std::span<const behavior::Option>(kWrongDefault)
                                                : std::span<const behavior::Option>(kOptions),
                                            run};

}  // namespace

#ifdef THROWS_AT_REGISTRATION
extern "C" const kaz::behavior::Plugin* kaz_behavior_plugin_v1() {
  throw std::logic_error("not today");
}
#else
KAZ_BEHAVIOR_PLUGIN(kHostile);
#endif
