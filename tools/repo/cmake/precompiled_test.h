// precompiled.h for tests.
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <gtest/gtest.h>

#include "tools/repo/cmake/precompiled.h"
