// `kaz flash`: puts a firmware into a servo board, through boot mode or the resident loader.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/base/result.hpp"
#include "tools/app/flash/arguments.h"

namespace kaz::tools {

// Prints what was done. Errors name what is on the board now.
Result<bool> run_flash(const FlashArguments& arguments);

}  // namespace kaz::tools
