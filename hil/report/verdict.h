// Verdict on a case or measurement.
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kaz::hil {

// Undecided: it failed while this machine was late (host/link/lateness.h) or the line was disturbed, also
// when repeated. Or a warm motor is too close to its limit.
enum class Verdict { passed, failed, left_out, undecided };

// Returns "passed", "failed", "left out" or "undecided".
const char* verdict_text(Verdict verdict);

}  // namespace kaz::hil
