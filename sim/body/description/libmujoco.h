// libmujoco, loaded on first use.
// SPDX-License-Identifier: Apache-2.0
//
// Programs that read no MJCF do not load the library.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "shared/base/result.hpp"

struct mjModel_;  // <mujoco/mjmodel.h>

namespace kaz::sim {

// Compiles a model. `files`: contents, by name, of all files that the model needs. libmujoco reads no others.
// `main`: name of the MJCF in `files`. Returns Fault::environment if the library is missing. If the library
// rejects the model, returns Fault::usage with its message, which has several lines. Thread-safe.
Result<std::shared_ptr<const mjModel_>> compile_mujoco(
    const std::map<std::string, std::string>& files, const std::string& main);

}  // namespace kaz::sim
