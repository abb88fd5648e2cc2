// Compares the boards' answers in a CAN log with the answers of the same requests now.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "host/link/link.h"
#include "shared/base/result.hpp"
#include "tools/replay/can_messages.h"

namespace kaz::tools {

// A frame from a board.
struct CanAnswer {
  std::size_t line = 0;  // line in the log; 0: an answer of the board now
  Time time{};           // since the first frame of the log
  std::uint32_t id = 0;
  std::vector<std::uint8_t> body;  // address, type, sequence number, fields
};

// Answers that differ in the same field are one difference. The members describe the first of these answers.
struct CanDifference {
  std::size_t line = 0;  // line in the log; 0: the log has no such answer
  Time time{};           // since the first frame of the log
  std::uint32_t id = 0;
  std::string what;                         // such as "gains_reply #12: no answer now"
  std::vector<std::uint8_t> recorded, now;  // bodies; empty: no answer
  std::size_t count = 1;                    // number of answers with this difference
};

// Largest difference of a measured field, in the unit of the message table.
struct MeasuredDifference {
  std::int64_t largest = 0;
  std::string unit;
};

struct CanComparison {
  std::size_t answers = 0;    // compared pairs of answers
  std::size_t telemetry = 0;  // telemetry frames of the log, which are not compared
  std::vector<CanDifference> differences;
  // Fields that depend on a measurement or on the time since the board's start, such as angles. Their values
  // are no differences. The board time is left out.
  std::map<std::string, MeasuredDifference> measured;
};

// Returns the valid frames of boards in the log.
std::vector<CanAnswer> answers_in(const CanMessages& log);

// Sends the requests of the log at their times, and returns the answers. Time 0 of the log is `lead` after
// the call, so that a board that starts now is ready. Reads until 200 ms after the last message of the log.
// Fails like `link`.
Result<std::vector<CanAnswer>> repeat_requests(const CanMessages& log, host::Link& link,
                                               host::Clock& clock, Time lead);

// For each board, pairs the answers in order by their sequence numbers.
CanComparison compare_answers(const std::vector<CanAnswer>& recorded,
                              const std::vector<CanAnswer>& now);

}  // namespace kaz::tools
