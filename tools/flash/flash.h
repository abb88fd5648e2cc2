// `kaz flash`: writes firmware to a servo board, through boot mode or the resident loader.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/base/result.hpp"
#include "tools/flash/arguments.h"

namespace kaz::tools {

// Prints the completed steps. Error messages describe the present content of the board's flash.
Result<bool> run_flash(const FlashArguments& arguments);

}  // namespace kaz::tools
