// Verdict on a case or measurement.
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kaz::hil {

// The verdict is `undecided` if all runs failed and each run was disturbed. A run is disturbed if this
// machine was late (host/link/lateness.h) or if there were errors on the line. If a motor was warm, the
// measured value may be lower than the value of a cold motor. If the value of the cold motor could change the
// verdict, the verdict is also `undecided`.
enum class Verdict { passed, failed, left_out, undecided };

// Returns "passed", "failed", "left out" or "undecided".
const char* verdict_text(Verdict verdict);

}  // namespace kaz::hil
