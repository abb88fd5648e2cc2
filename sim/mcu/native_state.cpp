// Ranges of a board's state, by the code in shared/servo and shared/protocol that uses it.
// SPDX-License-Identifier: Apache-2.0
#include "sim/mcu/native_state.h"

#include <algorithm>
#include <bit>
#include <iterator>

#include "shared/servo/joints.h"
#include "shared/servo/replies.h"

namespace kaz::sim {
namespace {

bool are_joints(u32 mask) {
  return (mask & ~u32{KZ_ALL_JOINTS}) == 0;
}

// A reply is about its parameter (replies.c): a joint, or a mask of joints.
bool is_possible(const kz_answer& answer) {
  switch (answer.type) {
    case KZ_TYPE_settings:
      return answer.parameter < KZ_JOINTS;
    case KZ_TYPE_joints:
      return are_joints(answer.parameter) &&
             std::popcount(answer.parameter) <= KZ_JOINTS_PER_REPLY;
    case KZ_TYPE_read_targets:
      return are_joints(answer.parameter);
    default:
      return answer.parameter == 0;
  }
}

bool is_possible(const kz_joint& joint) {
  return joint.pot_input < KZ_ANALOG && joint.mirrored <= 1 && joint.forward <= 1 &&
         joint.ramp_limit >= 1 && joint.kp >= 0 && joint.kp <= kz_scaled_kp(KZ_KP_MAX) &&
         joint.kd >= 0 && joint.kd <= kz_scaled_kd(KZ_KD_MAX);
}

bool is_possible(const kz_receiver& receiver) {
  return receiver.length <= sizeof receiver.body && receiver.state <= KZ_RECEIVE_OVERRUN;
}

bool is_possible(const kz_sender& sender) {
  constexpr u8 kStages = 8;  // of enum sender_stage
  // One that sends nothing has length 0, and `next` of its last frame.
  return sender.length <= KZ_BODY_MAX && (sender.length == 0 || sender.next <= sender.length) &&
         sender.stage < kStages;
}

// The first part of a reply of two, whose second part takes 2 bytes of each joint (kz_put_joints_rest).
bool is_prepared(const kz_servo& servo) {
  const kz_answer& answer = servo.queue[0];
  if (servo.prepared == 0) return true;
  return servo.queued > 0 && answer.reason == 0 && kz_reply_takes_two(answer.type) &&
         servo.prepared + 2 * std::popcount(answer.parameter) <= KZ_PAYLOAD_MAX;
}

}  // namespace

bool is_possible(const kz_servo& servo) {
  const auto each = [](const auto& list) {
    return std::all_of(std::begin(list), std::end(list),
                       [](const auto& one) { return is_possible(one); });
  };
  return servo.memory_next < KZ_REQUESTS_REMEMBERED && servo.replying <= 1 &&
         servo.replying + servo.queued <= KZ_QUEUE && is_prepared(servo) &&
         servo.raw_joint < KZ_JOINTS && are_joints(servo.enabled) &&
         are_joints(servo.fresh_targets) && servo.action <= KZ_ACTION_LOADER &&
         each(servo.remembered) && each(servo.queue) && each(servo.joint) &&
         is_possible(servo.receiver) && is_possible(servo.sender);
}

bool is_possible(const kz_tick_output& output) {
  return output.tx_count <= KZ_TX_PER_TICK && output.action <= KZ_ACTION_LOADER;
}

bool is_possible(const kz_store& log, int blocks, int parts) {
  return log.blocks == blocks && log.parts == parts && log.block < blocks &&
         log.line + parts <= KZ_STORE_LINES &&
         std::ranges::all_of(log.used, [](u8 used) { return used <= KZ_STORE_LINES; });
}

}  // namespace kaz::sim
