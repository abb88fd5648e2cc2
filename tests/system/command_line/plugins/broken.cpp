// Plug-ins that `kaz run` refuses, one for each value of BROKEN.
// SPDX-License-Identifier: Apache-2.0
#define NO_FACTORY 1
#define OTHER_VERSION 2
#define OTHER_OPTIONS 3
#define MISSING_SYMBOL 4
#define NO_FUNCTION 5

#include "host/behavior/plugin.h"

namespace kaz::host {
int gone_since(int version);  // defined nowhere
}  // namespace kaz::host

namespace {

#if BROKEN == NO_FUNCTION
constexpr kaz::Result<kaz::behavior::Outcome> (*run)(kaz::behavior::Context&) = nullptr;
#else
kaz::Result<kaz::behavior::Outcome> run(kaz::behavior::Context&) {
#if BROKEN == MISSING_SYMBOL
  return kaz::behavior::Outcome{kaz::host::gone_since(1) == 0, "", {}, {}};
#else
  return kaz::behavior::Outcome{true, "this should not have run", {}, {}};
#endif
}
#endif

constinit const kaz::behavior::Behavior kBroken{"broken", "is never run", false, {}, run};

}  // namespace

#if BROKEN == NO_FACTORY
extern "C" const void* kaz_behavior_plugin_v0() {
  return &kBroken;
}
#elif BROKEN == OTHER_VERSION
extern "C" const kaz::behavior::Plugin* kaz_behavior_plugin_v1() {
  // Of another version nothing but the text may be read.
  static const char* const texts[] = {"headers of yesterday",
                                      reinterpret_cast<const char*>(&kBroken)};
  return reinterpret_cast<const kaz::behavior::Plugin*>(texts);
}
#else
KAZ_BEHAVIOR_PLUGIN(kBroken);
#endif
