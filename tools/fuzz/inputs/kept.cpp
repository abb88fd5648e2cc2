// Notes of an interrupted run, for `kaz recover --from`.
// SPDX-License-Identifier: Apache-2.0
#include "tools/fuzz/inputs/input.h"
#include "tools/fuzz/inputs/targets.h"
#include "tools/kept/kept_file.h"

namespace kaz::fuzz {

// What `kaz recover --from` would send to a board.
namespace {

Complaint try_write(const std::string& text) {
  const auto write = tools::parse_write(text, "case.json");
  if (!write) return judge_error(write.error(), "case.json");
  const auto again = tools::parse_write(tools::write_text(*write), "again");
  if (!again) return "the notes of a write cannot be read back: " + again.error().message;
  if (again->command != write->command || again->run.process != write->run.process)
    return "the notes of a write change when they are read back";
  return std::nullopt;
}

}  // namespace

Complaint try_kept(Bytes bytes) {
  if (auto wrong = try_write(text_of(bytes))) return wrong;
  const auto kept = tools::parse_kept(text_of(bytes), "case.json");
  if (!kept) return judge_error(kept.error(), "case.json");
  const host::BoardState& board = kept->board;
  if (board.address < 1 || board.address > KZ_ADDRESS_LAST) return "an invalid address";
  for (const std::uint8_t other : kept->others) {
    if (other < 1 || other > KZ_ADDRESS_LAST) return "an invalid address of another board";
  }
  const kz_heartbeat watchdog{board.watchdog_10ms, board.reaction};
  if (kz_check_heartbeat(&watchdog) != KZ_IN_BOUNDS) return "a watchdog that the board refuses";
  for (const host::KeptJoint& joint : board.joints) {
    const kz_gains gains{1, joint.kp, joint.kd, joint.dead_band, joint.friction};
    const kz_limits limits{1, joint.ramp, joint.lower, joint.upper};
    if (kz_check_gains(&gains) != KZ_IN_BOUNDS || kz_check_limits(&limits) != KZ_IN_BOUNDS ||
        joint.lower > joint.upper)
      return "settings that the board refuses";
  }
  const auto again = tools::parse_kept(tools::kept_text(*kept), "again");
  if (!again) return "written data cannot be read back: " + again.error().message;
  if (again->board != board || again->others != kept->others)
    return "the state changes when it is written and read back";
  return std::nullopt;
}

}  // namespace kaz::fuzz
