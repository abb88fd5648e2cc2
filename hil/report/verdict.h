// What became of a case or a measurement.
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kaz::hil {

enum class Verdict { passed, failed, left_out };

// "passed", "failed", "left out"
const char* verdict_text(Verdict verdict);

}  // namespace kaz::hil
