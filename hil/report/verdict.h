// Verdict on a case or measurement.
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kaz::hil {

// The verdict is `undecided` if each run failed and, during each run, this machine was late
// (host/link/lateness.h) or the line was disturbed. A measurement of a warm motor is also undecided if the
// value is too close to a limit.
enum class Verdict { passed, failed, left_out, undecided };

// Returns "passed", "failed", "left out" or "undecided".
const char* verdict_text(Verdict verdict);

}  // namespace kaz::hil
