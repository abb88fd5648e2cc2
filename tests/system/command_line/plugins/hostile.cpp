// A plug-in that does what a behavior must not do. Its option `does` selects the misdeed.
// SPDX-License-Identifier: Apache-2.0
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

// What ends the function or the process.
[[gnu::noinline]] void end_somehow(std::string_view what) {
  if (what == "throw") throw std::runtime_error("no more");
  if (what == "throw-int") throw 7;
  if (what == "exit") std::exit(0);
  if (what == "abort") std::abort();
  if (what == "crash") write_to_null();
  if (what == "thread-throw") std::thread([] { throw std::runtime_error("no more"); }).join();
  if (what == "overflow") overflow_stack(0);
  if (what == "loop") {
    while (g_depth == 0) {
    }
  }
}

constexpr behavior::Option kOptions[] = {
    {"does", "nothing",
     "nothing|throw|throw-int|exit|abort|crash|thread-throw|overflow|loop|"
     "empty|no-sentence|no-text|interrupted|nan|no-option|wrong-kind",
     0, 0, "what the behavior does after 0.2 s"}};

Result<Outcome> run(Context& context) {
  KAZ_TRY(behavior::hold_still(context.robot));
  context.sink.phase(context.clock.now(), "hostile", "harmless");
  KAZ_TRY(context.clock.sleep_until(context.clock.now() + from_seconds(0.2)));
  const std::string_view what = context.options.choice("does");
  context.sink.phase(context.clock.now(), "hostile", "now");
  end_somehow(what);
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
