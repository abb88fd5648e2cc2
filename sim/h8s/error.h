// The error type of the emulator library, that of the images that it loads.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/image/error.h"
