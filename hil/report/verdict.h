// What became of a case or a measurement.
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kaz::hil {

// undecided: it failed while this machine was late (host/link/lateness.h) or the line was disturbed, also
// when repeated; or a warm motor is too near its limit.
enum class Verdict { passed, failed, left_out, undecided };

// "passed", "failed", "left out", "undecided"
const char* verdict_text(Verdict verdict);

}  // namespace kaz::hil
