// Images of programs: their readers are shared with those who flash real boards.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/image/image.h"
