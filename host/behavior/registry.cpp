// The table of all behaviors, from behaviors.def.
// SPDX-License-Identifier: Apache-2.0
#include <vector>

#include "host/behavior/behavior.h"

namespace kaz::behavior {

std::span<const Behavior> behaviors() {
#define KAZ_BEHAVIOR(source, behavior) behavior,
  static const std::vector<Behavior> all{
#include "host/behavior/behaviors.def"
  };
#undef KAZ_BEHAVIOR
  return all;
}

Result<Behavior> find_behavior(std::string_view name) {
  std::string names;
  for (const Behavior& behavior : behaviors()) {
    if (behavior.name == name) return behavior;
    names += (names.empty() ? "" : ", ") + std::string(behavior.name);
  }
  return fail(Fault::usage,
              "there is no behavior `" + std::string(name) + "`: use one of " + names);
}

}  // namespace kaz::behavior
