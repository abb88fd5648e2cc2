// A part of a bench that is measured again where the machine was late, and may be cut short.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "hil/bench/measurement.h"

namespace kaz::hil {

// BenchJudge::timed(), with the number of the run, from 1. If the part ends by an error, as by a signal,
// while the machine was late or the line disturbed, what has failed in it is undecided: it would have been
// measured again.
Result<void> timed_part(BenchJudge& judge, const std::function<Result<void>(int run)>& part,
                        Time at_least = Time::zero(),
                        const BenchJudge::LineTrouble& line_trouble = nullptr);

// What a run of a part is called in the progress: "late machine or bad line, again: round trips".
std::string run_text(const std::string& what, int run);

}  // namespace kaz::hil
