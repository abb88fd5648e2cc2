// Runs a part of a bench, and repeats the part if the machine was late.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "hil/bench/measurement.h"

namespace kaz::hil {

// Calls BenchJudge::timed() and passes the number of the run, beginning with 1, to `part`. A run that ends
// with an error, for example because of a signal, is not repeated. If the machine was late or the line was
// disturbed in this run, the failed measurements of the run become undecided.
Result<void> timed_part(BenchJudge& judge, const std::function<Result<void>(int run)>& part,
                        Time at_least = Time::zero(),
                        const BenchJudge::LineTrouble& line_trouble = nullptr);

// Returns a text for progress messages. For the first run, the text is `what`. For a repetition, the text
// begins with the reason: "repeated because this machine was late or the line was disturbed: round trips".
std::string run_text(const std::string& what, int run);

}  // namespace kaz::hil
