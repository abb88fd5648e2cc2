// precompiled.h for the command line: with CLI11.
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <CLI/CLI.hpp>

#include "tools/cmake/precompiled.h"
