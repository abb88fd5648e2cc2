// No drive where a joint is off or beyond a limit, no command past limit or ramp.
// SPDX-License-Identifier: Apache-2.0
#include "hil/fuzz/tick_judge.h"

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <iterator>

#include "shared/board/table.h"
#include "shared/protocol/bytes.h"

namespace kaz::hil::fuzz {
namespace {

struct Wiring {
  const char* name;
  int pwm, port, bit, sign;
};
constexpr Wiring kWiring[KZ_JOINTS] = {
#define KZ_JOINT(index, name, pwm, port, bit, mux, input, sign, pot_centre) \
  {#name, pwm, port, bit, sign},
#include "shared/board/joints.def"
#undef KZ_JOINT
};

constexpr int kLookedAfterMs = 4;

int port_of(const kz_tick_output& output, int port) {
  switch (port) {
    case 3:
      return output.p3;
    case 4:
      return output.p4;
    case 5:
      return output.p5;
    default:
      return output.p6;
  }
}

bool drivers_on(const kz_tick_output& output) {
  return (output.p4 & KZ_P4_ENABLE) != 0;
}

}  // namespace

std::array<int, KZ_JOINTS> drives_of(const kz_tick_output& output) {
  std::array<int, KZ_JOINTS> drives{};
  if (!drivers_on(output)) return drives;
  for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
    const Wiring& wire = kWiring[j];
    const int counts = wire.pwm < 16 ? output.pw[wire.pwm] : output.tmo[wire.pwm - 16];
    const bool forward = (port_of(output, wire.port) >> wire.bit & 1) != 0;
    drives[j] = (forward ? counts : -counts) * wire.sign;
  }
  return drives;
}

void TickJudge::wrong(const kz_servo& servo, int joint, const std::string& what) {
  if (violation_) return;
  std::string text = std::string("tick ").append(std::to_string(servo.tick)).append(": ");
  if (joint >= 0) {
    const kz_joint& state = servo.joint[joint];
    text.append(kWiring[joint].name).append(" ").append(what);
    text.append(" (angle ").append(std::to_string(state.angle));
    text.append(", command ").append(std::to_string(state.command));
    text.append(", limits ").append(std::to_string(state.lower)).append("..");
    text.append(std::to_string(state.upper)).append(")");
  } else {
    text.append(what);
  }
  violation_ = text;
}

void TickJudge::tick(const kz_tick_input& input, const kz_servo& servo,
                     const kz_tick_output& output) {
  ++ticks_;
  if (output.tx_count > KZ_TX_PER_TICK || output.tx_count > input.tx_room)
    wrong(servo, -1, "the tick sends more bytes than there is room for");
  judge_requests(input, servo);
  judge_outputs(servo, output);
  for (int j = 0; j < KZ_JOINTS; ++j) judge_joint(servo, j);
  started_ = true;
  note_features(servo);
}

// All motors are off in the tick in which a `stop` ends, also one to all boards, or an `enable` of none that
// is not refused. A later frame of the same tick may switch some on again.
void TickJudge::judge_requests(const kz_tick_input& input, const kz_servo& servo) {
  if (!started_) {
    kz_receiver_init(&receiver_);
    refusals_ = servo.refusals;
  }
  bool stopped = false, off = false;
  if (input.rx_count == 0) {
    kz_receiver_silent(&receiver_);
  } else {
    receiver_.silent_ms = 0;
  }
  for (int i = 0; i < std::min<int>(input.rx_count, KZ_RX_PER_TICK); ++i) {
    if (kz_receive(&receiver_, input.rx[i], input.rx_flags[i]) != KZ_RECEIVE_FRAME) continue;
    const u8 address = receiver_.body[KZ_BODY_ADDRESS], type = receiver_.body[KZ_BODY_TYPE];
    if (address != servo.address && address != KZ_ADDRESS_ALL) continue;
    const int fields = receiver_.length - KZ_HEADER_SIZE;
    if (type == KZ_TYPE_enable || type == KZ_TYPE_raw_drive) stopped = off = false;
    stopped |= type == KZ_TYPE_stop && fields == 0;
    off |= type == KZ_TYPE_enable && fields == KZ_SIZE_enable &&
           kz_get_u32(receiver_.body + KZ_HEADER_SIZE) == 0;
  }
  const bool on = servo.enabled != 0 || servo.raw_ms != 0;
  if (on && stopped) wrong(servo, -1, "motors are on after `stop`");
  if (on && off && servo.refusals == refusals_)
    wrong(servo, -1, "motors are on after `enable` with an empty mask");
  refusals_ = servo.refusals;
}

void TickJudge::judge_outputs(const kz_servo& servo, const kz_tick_output& output) {
  const auto drives = drives_of(output);
  const bool raw = servo.raw_ms != 0;
  if (servo.shutdown != KZ_SHUTDOWN_NONE && !servo.holding &&
      (servo.enabled != 0 || drivers_on(output)))
    wrong(servo, -1, "motors are on despite shutdown " + std::to_string(servo.shutdown));
  if ((servo.enabled & ~static_cast<u32>(KZ_ALL_JOINTS)) != 0)
    wrong(servo, -1, "nonexistent joints are on");
  if (raw && servo.enabled != 0) wrong(servo, -1, "raw drive while joints are on");
  if (servo.enabled == 0 && !raw) {
    if (drivers_on(output)) wrong(servo, -1, "all joints are off, but the motor drivers are on");
    const bool any =
        std::any_of(std::begin(output.pw), std::end(output.pw), [](u8 v) { return v; }) ||
        output.tmo[0] != 0 || output.tmo[1] != 0;
    if (any) wrong(servo, -1, "all joints are off, but a motor is driven");
  }
  for (int j = 0; j < KZ_JOINTS; ++j) {
    const int drive = drives[static_cast<std::size_t>(j)];
    const bool on = (servo.enabled >> j & 1) != 0 || (raw && servo.raw_joint == j);
    if (drive != 0 && !on)
      wrong(servo, j, "is off, but its motor is driven with " + std::to_string(drive));
    judge_limit(servo, j, drive);
  }
}

// The loop looks every 4 ms whether a joint can reach a limit before it looks again; only a reading
// that
// jumps as no joint does can surprise it. Drive against the motion is a brake, not a drive out.
void TickJudge::judge_limit(const kz_servo& servo, int number, int drive) {
  const kz_joint& joint = servo.joint[number];
  Before& before = before_[static_cast<std::size_t>(number)];
  // Drives were computed before this tick's requests, so by the limits before them.
  const int lower = started_ ? std::min<int>(joint.lower, before.lower) : joint.lower;
  const int upper = started_ ? std::max<int>(joint.upper, before.upper) : joint.upper;
  // Where both limits are one no drive leads back inside: none is judged.
  const bool above = joint.angle >= upper && lower != upper;
  const bool below = joint.angle <= lower && lower != upper;
  before.above_ticks = above ? before.above_ticks + 1 : 0;
  before.below_ticks = below ? before.below_ticks + 1 : 0;
  if (drive > 0 && joint.rate >= 0 && before.above_ticks > kLookedAfterMs)
    wrong(servo, number, "is driven farther beyond its upper limit");
  if (drive < 0 && joint.rate <= 0 && before.below_ticks > kLookedAfterMs)
    wrong(servo, number, "is driven farther beyond its lower limit");
}

void TickJudge::judge_joint(const kz_servo& servo, int number) {
  const kz_joint& joint = servo.joint[number];
  const kz_board_joint& board = kz_board_joints[number];
  Before& before = before_[static_cast<std::size_t>(number)];
  if (joint.lower > joint.upper || joint.lower < board.lower || joint.upper > board.upper)
    wrong(servo, number, "has soft limits outside its mechanical limits");
  const bool on = (servo.enabled >> number & 1) != 0;
  if (on != (joint.on != 0))
    wrong(servo, number, "is on in one place of the state and off in another");
  if (started_ && on && before.on) {
    const int step = joint.command - before.command;
    before.ramp = std::max<int>(before.ramp, joint.ramp_limit);
    if (std::abs(step) > before.ramp)
      wrong(servo, number,
            "has a command that moved by " + std::to_string(step) +
                " in one tick, but the ramp limit is " + std::to_string(before.ramp));
    // The command moves before this tick's requests, so by the limits before them.
    const int lower = std::min<int>(joint.lower, before.lower);
    const int upper = std::max<int>(joint.upper, before.upper);
    if ((joint.command > upper && step > 0) || (joint.command < lower && step < 0))
      wrong(servo, number, "has a command that moves farther beyond its limits");
  }
  if (!on || joint.ramp_left == 0) before.ramp = joint.ramp_limit;
  before.on = on;
  before.command = joint.command;
  before.lower = joint.lower;
  before.upper = joint.upper;
}

void TickJudge::note_features(const kz_servo& servo) {
  const auto on = static_cast<std::uint32_t>(std::bit_width(
      static_cast<unsigned>(std::popcount(static_cast<std::uint32_t>(servo.enabled)))));
  std::uint32_t at_limit = 0, faulty_pots = 0;
  for (const kz_joint& joint : servo.joint) {
    at_limit |= joint.angle >= joint.upper || joint.angle <= joint.lower;
    faulty_pots |= joint.pot_bad_ms != 0;
  }
  const std::uint32_t under_way =
      static_cast<std::uint32_t>(servo.queued) << 1 | static_cast<std::uint32_t>(servo.replying);
  features_.insert(0x10000000u | static_cast<std::uint32_t>(servo.shutdown) << 16 | on << 12 |
                   (servo.holding ? 0x800u : 0u) | at_limit << 10 | faulty_pots << 9 |
                   (servo.raw_ms != 0 ? 0x100u : 0u) | (servo.refuse_busy ? 0x80u : 0u) |
                   under_way);
  const std::uint16_t counts[] = {servo.overruns,     servo.idle,         servo.too_long,
                                  servo.too_short,    servo.bad_stuffing, servo.line_errors,
                                  servo.missed_ticks, servo.repetitions};
  std::uint32_t seen = 0;
  for (std::size_t i = 0; i < std::size(counts); ++i) seen |= (counts[i] != 0 ? 1u : 0u) << i;
  features_.insert(0x11000000u | seen);
}

}  // namespace kaz::hil::fuzz
