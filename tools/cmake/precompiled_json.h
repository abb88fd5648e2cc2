// precompiled.h for libraries that write and read JSON.
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json.hpp>

#include "tools/cmake/precompiled.h"
