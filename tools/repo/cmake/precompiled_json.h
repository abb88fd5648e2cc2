// precompiled.h for libraries that read or write JSON.
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json.hpp>

#include "tools/repo/cmake/precompiled.h"
