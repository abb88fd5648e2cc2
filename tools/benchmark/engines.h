// Engines of the emulator by name.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "sim/h8s/chip/options.h"

namespace kaz::bench {

// Returns the names of the available engines. The first name is the default engine.
inline std::vector<std::string> engine_names() {
  if (h8s::translator_available()) return {"translator", "interpreter", "reference"};
  return {"interpreter", "reference"};
}

inline h8s::Options options_of(const std::string& engine) {
  h8s::Options options;
  options.engine = engine == "translator"    ? h8s::Engine::translator
                   : engine == "interpreter" ? h8s::Engine::interpreter
                                             : h8s::Engine::reference;
  return options;
}

// Returns the name of a result with the engine's name appended. The default engine's name is not appended.
inline std::string named(const std::string& name, const std::string& engine) {
  return engine == engine_names().front() ? name : name + "." + engine;
}

}  // namespace kaz::bench
