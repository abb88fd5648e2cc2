// Runs a part of a bench that is repeated if the machine was late, and that may be cut short.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "hil/bench/measurement.h"

namespace kaz::hil {

// Calls BenchJudge::timed() and passes the number of the run, from 1. An error, for example by a signal, may
// end the part while the machine was late or the line disturbed. The failed measurements of the part are
// then undecided, because the part would otherwise have been repeated.
Result<void> timed_part(BenchJudge& judge, const std::function<Result<void>(int run)>& part,
                        Time at_least = Time::zero(),
                        const BenchJudge::LineTrouble& line_trouble = nullptr);

// Returns the name of a run in progress messages: "late machine or bad line, again: round trips".
std::string run_text(const std::string& what, int run);

}  // namespace kaz::hil
