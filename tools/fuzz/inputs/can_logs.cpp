// CAN logs: lines, ISO-TP messages, and a comparison of the answers.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "tools/fuzz/inputs/input.h"
#include "tools/fuzz/inputs/targets.h"
#include "tools/replay/can_answers.h"

namespace kaz::fuzz {

Complaint try_can_log(Bytes bytes) {
  const std::string text = text_of(bytes);
  const auto frames = tools::parse_can_log("case.log", text);
  if (!frames) return judge_error(frames.error(), "case.log");
  if (!std::ranges::is_sorted(*frames, {}, &tools::CanLogFrame::time))
    return "a frame is earlier than the frame before it";
  for (const tools::CanLogFrame& frame : *frames) {
    if (frame.data.size() > 64 || frame.id > 0x1FFFFFFF) return "an invalid frame was read";
  }
  const auto log = tools::can_messages("case.log", *frames);
  if (!log) return judge_error(log.error(), "case.log");
  for (const tools::CanMessage& message : log->messages) {
    if (message.bytes.empty() || message.bytes.size() > 4095)
      return "a message has an invalid length";
  }
  const auto answers = tools::answers_in(*log);
  if (!tools::compare_answers(answers, answers).differences.empty())
    return "a comparison of answers with themselves found a difference";
  auto fewer = answers;
  if (!fewer.empty()) fewer.pop_back();
  (void)tools::compare_answers(answers, fewer);
  (void)tools::compare_answers(fewer, answers);
  return std::nullopt;
}

}  // namespace kaz::fuzz
