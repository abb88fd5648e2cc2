// Engines of the emulator by name.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "sim/h8s/chip/options.h"

namespace kaz::bench {

// Returns the available engines, the default one first.
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

// Appends the engine to the name of a result, except for the default engine.
inline std::string named(const std::string& name, const std::string& engine) {
  return engine == engine_names().front() ? name : name + "." + engine;
}

}  // namespace kaz::bench
