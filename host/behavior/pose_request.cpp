// Reads what is asked of `pose`.
// SPDX-License-Identifier: Apache-2.0
#include "host/behavior/pose_request.h"

#include <cmath>
#include <numbers>

#include "shared/base/number_text.hpp"

namespace kaz::behavior {

Result<PoseRequest> parse_pose_request(std::string_view line) {
  constexpr std::string_view kTarget = "target ", kPlayWord = "play ";
  if (line == "stop") return PoseRequest{PoseRequest::Kind::stop, {}, 0};
  if (line == "end") return PoseRequest{PoseRequest::Kind::end, {}, 0};
  if (line.starts_with(kPlayWord))
    return PoseRequest{PoseRequest::Kind::play, std::string(line.substr(kPlayWord.size())), 0};
  const auto space = line.rfind(' ');
  if (line.starts_with(kTarget) && space > kTarget.size()) {
    const auto angle = parse_number<double>(line.substr(space + 1));
    if (angle && std::abs(*angle) <= std::numbers::pi)
      return PoseRequest{PoseRequest::Kind::target,
                         std::string(line.substr(kTarget.size(), space - kTarget.size())), *angle};
  }
  return fail(Fault::usage, "give `target JOINT RAD` (-pi to pi), `play JSON`, `stop` or `end`");
}

}  // namespace kaz::behavior
