// Internals of BoardGroup: one board, and a request pending on all boards.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/robot/board_group.h"

namespace kaz::host {

// Returns the names of the joints in a mask, such as "neck_pan, neck_tilt".
std::string joint_names_of(std::uint32_t joints);

struct BoardGroup::Member {
  Member(const RobotBoard& of, Clock& clock, int retries)
      : board(of),
        requester(*of.link, clock, {.address = of.address, .retries = retries}),
        relation(of.link->byte_time()) {}

  // Updates clock relation, status and restart detection from a reply.
  void relate(std::uint8_t request, const Reply& reply);

  RobotBoard board;
  Requester requester;
  ClockRelation relation;
  std::optional<std::uint32_t> last_tick;
  std::uint16_t status = 0;
  bool restarted = false;
  std::uint32_t to_be_on = 0;  // mask of the joints that were switched on
  bool to_be_off = false;      // switch_off() was called after joints were switched on
  bool link_lost = false;      // the link must be reopened
  struct State {
    Time time{};
    std::array<s16, KZ_JOINTS> angle{};
  };
  std::optional<State> before, latest;  // the board's last two states
  // Angle at time `t` on the line through the last two states. If the two states are further apart than
  // kMaxBetween, returns the latest angle.
  s16 angle_at(std::size_t joint, Time t) const;
  // Stores the board's newest state, and converts the angles in `one` to the time of the reference's latest
  // state. Call align() for the reference first.
  void align(kz_state_reply& one, const Member& reference);
};

struct BoardGroup::Exchange {
  struct Part {
    bool concerned = false;  // false: the board got a heartbeat instead of the request
    Ticket ticket = 0;
    std::optional<Reply> reply;
  };
  Request request;
  std::vector<Part> parts;  // parts of the request, in the order of the members
};

}  // namespace kaz::host
