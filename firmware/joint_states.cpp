// Random inputs of the joints' loop, with corner values and values at every threshold of the loop.
// SPDX-License-Identifier: Apache-2.0
#include "firmware/joint_states.h"

#include <algorithm>
#include <cstdlib>
#include <iterator>

#include "shared/base/random.hpp"
#include "shared/servo/joint_loop.h"

namespace kaz::firmware {
namespace {

constexpr int kMin = -32768, kMax = 32767;
constexpr int kGainWithFriction = 32759;
constexpr int kFullDrive = (KZ_DUTY_MAX << KZ_DRIVE_SHIFT) - (1 << (KZ_DRIVE_SHIFT - 1));

template <class T, std::size_t N>
T one_of(Random& random, const T (&values)[N]) {
  return values[random.below(N)];
}

bool fits(std::int64_t value) {
  return value >= kMin && value <= kMax;
}

s16 clipped(std::int64_t value) {
  return static_cast<s16>(std::clamp<std::int64_t>(value, kMin, kMax));
}

u16 any_bits(Random& random) {
  return static_cast<u16>(random.next() >> 48);
}

// -n..n
int around(Random& random, int n) {
  return static_cast<int>(random.below(static_cast<std::uint32_t>(2 * n + 1))) - n;
}

// A corner value, one of any magnitude, or a uniform one.
s16 any_number(Random& random) {
  static const int corners[] = {0,        1,   -1,   2,    -2,   kMax,  kMax - 1, kMin,
                                kMin + 1, 127, -128, 255,  256,  -256,  0x4000,   -0x4000,
                                511,      512, -511, -512, 1000, -1000, 320,      -320};
  switch (random.below(3)) {
    case 0:
      return static_cast<s16>(one_of(random, corners));
    case 1:
      return static_cast<s16>(static_cast<s16>(any_bits(random)) >> random.below(16));
    default:
      return static_cast<s16>(any_bits(random));
  }
}

u16 any_unsigned(Random& random) {
  return static_cast<u16>(any_number(random));
}

u8 any_byte(Random& random) {
  return static_cast<u8>(random.next() >> 56);
}

u16 draw_code(Random& random) {
  static const u16 corners[] = {KZ_POT_LOWEST, KZ_POT_HIGHEST, 511, 512, 513};
  static const u16 invalid[] = {
      0, KZ_POT_LOWEST - 1, KZ_POT_HIGHEST + 1,      1023,      1024, 0x7FFF, 0x8000, 0xFFFF,
      2, 0x8000 + 512,      0x8000 + KZ_POT_HIGHEST, 0xFFFF - 3};
  switch (random.below(16)) {
    case 0:
    case 1:
      return one_of(random, corners);
    case 2:
      return one_of(random, invalid);
    case 3:
      return any_bits(random);
    default:
      return static_cast<u16>(KZ_POT_LOWEST + random.below(KZ_POT_HIGHEST - KZ_POT_LOWEST + 1));
  }
}

int draw_delta(Random& random) {
  static const int corners[] = {0,
                                1,
                                -1,
                                KZ_DELTA_MAX - 1,
                                KZ_DELTA_MAX,
                                KZ_DELTA_MAX + 1,
                                kMax,
                                kMin,
                                -KZ_DELTA_MAX + 1,
                                -KZ_DELTA_MAX,
                                -KZ_DELTA_MAX - 1};
  switch (random.below(4)) {
    case 0:
      return one_of(random, corners);
    case 1:
      return any_number(random);
    default:
      return around(random, 64);
  }
}

// The filtered rate that shall come out.
int draw_rate(Random& random) {
  static const int corners[] = {0, KZ_SLOW, KZ_NEAR_LIMIT, 2 * KZ_NEAR_LIMIT, 8191};
  switch (random.below(4)) {
    case 0:
      return (one_of(random, corners) + around(random, 2)) * (random.below(2) ? 1 : -1);
    case 1:
      return around(random, 4 * KZ_NEAR_LIMIT);
    default:
      return any_number(random);
  }
}

// A displacement between an angle and a limit which the rate just needs, or does not.
int draw_way(Random& random, int rate) {
  static const int corners[] = {
      0, 1, -1, 2, KZ_NEAR_LIMIT - 1, KZ_NEAR_LIMIT, 1001, kMax, 0x8000, 0xFC17, 0xFC18, 0xFFFF};
  const int speed = std::abs(rate);
  const int needed = speed < 2 * KZ_NEAR_LIMIT ? speed / 2 : speed - KZ_NEAR_LIMIT;
  switch (random.below(4)) {
    case 0:
      return one_of(random, corners);
    case 1:
      return static_cast<int>(random.below(0x10000));
    default:
      return needed + around(random, 3);
  }
}

// A drive at a place where the duty changes or saturates.
std::int64_t draw_drive(Random& random) {
  std::int64_t drive = 0;
  switch (random.below(4)) {
    case 0:
      drive = 0;
      break;
    case 1:  // full, and where a duty that did not saturate would be 255 and 256
      drive = kFullDrive + (std::int64_t{random.below(3)} << (KZ_DRIVE_SHIFT - 1));
      break;
    default:  // the middle between two duties
      drive =
          (std::int64_t{random.below(KZ_DUTY_MAX)} << KZ_DRIVE_SHIFT) + (1 << (KZ_DRIVE_SHIFT - 1));
  }
  if (random.below(2)) drive = -drive;
  return drive + around(random, 2);
}

// One joint: what it measures comes first, then the state that meets it.
class JointState {
 public:
  JointState(Random& random, kz_joint& joint) : random_(random), joint_(joint) {}

  // The code that its potentiometer shows.
  u16 draw() {
    draw_bystanders();
    const u16 code = draw_code(random_);
    draw_measurement(code);
    draw_control();
    draw_ramp();
    draw_limits();
    if (random_.below(3) == 0) aim_at_drive();
    exclude();
    return code;
  }

 private:
  // Fields that the loop does not read: it must leave them, or write them without looking.
  void draw_bystanders() {
    joint_.heat = static_cast<u32>(random_.next());
    joint_.ramp_limit = any_bits(random_);
    joint_.stall_angle = static_cast<s16>(any_bits(random_));
    joint_.target_ms = any_bits(random_);
    joint_.friction = any_byte(random_);
    joint_.load = any_byte(random_);
    joint_.stalled = any_byte(random_);
    joint_.duty = any_byte(random_);
    joint_.forward = any_byte(random_);
  }

  void draw_measurement(u16 code) {
    static const u8 times[] = {
        1,   2,  KZ_POT_FAULT_MS - 2, KZ_POT_FAULT_MS - 1, KZ_POT_FAULT_MS, KZ_POT_FAULT_MS + 1,
        254, 255};
    if (random_.below(2)) {
      joint_.pot_centre = static_cast<s16>(around(random_, 4000));
      joint_.pot_scale =
          static_cast<s16>((16000 + around(random_, 1600)) * (random_.below(2) ? 1 : -1));
    } else {
      joint_.pot_centre = any_number(random_);
      joint_.pot_scale = any_number(random_);
    }
    joint_.pot_bad_ms = random_.below(3)   ? 0
                        : random_.below(3) ? one_of(random_, times)
                                           : any_byte(random_);
    const std::int64_t share = (std::int64_t{code} - 512) * 64;
    angle_ = static_cast<s16>(joint_.pot_centre + ((share * joint_.pot_scale * 2) >> 16));

    int delta = draw_delta(random_);
    joint_.angle = static_cast<s16>(angle_ - delta);
    delta = static_cast<s16>(delta);
    if (joint_.pot_bad_ms != 0) delta = 0;
    delta = std::clamp(delta, -KZ_DELTA_MAX, KZ_DELTA_MAX);
    // rate - rate / 8 reaches every number: 8 q + s gives 7 q + s.
    rate_ = draw_rate(random_);
    const int decayed = rate_ - 8 * delta;
    const int quotient = decayed >= 0 ? decayed / 7 : -((6 - decayed) / 7);
    const int before = 8 * quotient + (decayed - 7 * quotient);
    joint_.rate = fits(before) ? static_cast<s16>(before) : any_number(random_);
    rate_ = joint_.rate - (joint_.rate >> 3) + 8 * delta;
  }

  void draw_control() {
    static const u8 reasons[] = {0,
                                 0,
                                 KZ_CONSTRAINED_NEAR_LIMIT,
                                 KZ_CONSTRAINED_NEAR_LIMIT,
                                 KZ_CONSTRAINED_BY_FRICTION,
                                 KZ_CONSTRAINED_NEAR_LIMIT | KZ_CONSTRAINED_BY_FRICTION};
    static const u8 switches[] = {1, 1, 1, 1, 1, 0};
    static const u16 frictions[] = {0, 0, 0, 1, 255, 256, 30 << 8, 255 << 8, 0xFFFF};
    joint_.mirrored = random_.below(8) ? static_cast<u8>(random_.below(2)) : any_byte(random_);
    joint_.constrained = random_.below(16) ? one_of(random_, reasons) : any_byte(random_);
    joint_.on = random_.below(16) ? one_of(random_, switches) : any_byte(random_);
    joint_.kp = random_.below(2) ? static_cast<s16>(random_.below(4097)) : any_number(random_);
    joint_.kd = random_.below(2) ? static_cast<s16>(random_.below(4097)) : any_number(random_);
    joint_.friction_drive = random_.below(4) ? one_of(random_, frictions) : any_bits(random_);
    const int error = random_.below(2) ? around(random_, 300) : any_number(random_);
    aim_at_error(error);
    draw_dead_band();
    joint_.target = any_number(random_);
  }

  // The command shall be off the angle by this, as far as the type allows.
  void aim_at_error(int error) {
    command_ = clipped(angle_ + error);
    error_ = command_ - angle_;
    joint_.command = static_cast<s16>(command_);
  }

  void draw_dead_band() {
    switch (random_.below(4)) {
      case 0:
      case 1:
        joint_.dead_band = 0;
        break;
      case 2:
        joint_.dead_band = static_cast<u16>(std::max(0, std::abs(error_) + around(random_, 1)));
        break;
      default:
        joint_.dead_band = any_unsigned(random_);
    }
  }

  // A ramp whose next step leads to the command chosen, from wherever that is.
  void draw_ramp() {
    static const u16 few[] = {1, 2, 3, 0xFFFF};
    joint_.ramp_left = random_.below(2)   ? 0
                       : random_.below(2) ? one_of(random_, few)
                                          : any_unsigned(random_);
    joint_.ramp_time = any_unsigned(random_);
    joint_.ramp_rest = any_unsigned(random_);
    joint_.ramp_room = random_.below(2) ? static_cast<u16>(joint_.ramp_rest + around(random_, 1))
                                        : any_unsigned(random_);
    joint_.ramp_whole =
        random_.below(2) ? static_cast<u16>(around(random_, 60)) : any_unsigned(random_);
    joint_.ramp_extra =
        random_.below(4) ? static_cast<u16>(random_.below(2) ? 1 : -1) : any_unsigned(random_);
    if (joint_.ramp_left == 0) return;
    int step = joint_.ramp_whole;
    if (joint_.ramp_rest >= joint_.ramp_room) step += joint_.ramp_extra;
    joint_.command = static_cast<s16>(command_ - step);
  }

  void draw_limits() {
    joint_.upper = draw_limit(1);
    joint_.lower = draw_limit(-1);
  }

  s16 draw_limit(int side) {
    switch (random_.below(8)) {
      case 0:  // at the angle
        return clipped(angle_ + around(random_, 2));
      case 1:  // where the command goes
        return clipped(command_ + around(random_, 1));
      case 2:  // where it comes from
        return clipped(joint_.command + around(random_, 1));
      case 3:
        return any_number(random_);
      case 4:
        return static_cast<s16>(side > 0 ? kMax : kMin);
      default:
        return clipped(angle_ + side * draw_way(random_, rate_));
    }
  }

  // Rate in excess of what the remaining distance to the limit allows; negative: slower.
  int excess() const {
    const int distance = std::max(0, rate_ > 0 ? joint_.upper - angle_ : angle_ - joint_.lower);
    return std::abs(rate_) - (distance + std::min(distance, KZ_NEAR_LIMIT));
  }

  // Chooses gains for half an error of 1 or -1 such that the drive is what was drawn.
  void aim_at_drive() {
    static const int errors[] = {2, 3, -1, -2};
    const int step = command_ - joint_.command;
    const int error = one_of(random_, errors);
    aim_at_error(error);
    if (error_ != error) return;
    joint_.command = static_cast<s16>(command_ - step);
    if (random_.below(4)) joint_.dead_band = 0;
    std::int64_t drive = draw_drive(random_);
    if (std::abs(rate_) > KZ_SLOW && random_.below(2)) {  // the one that a limit brakes with
      drive = std::int64_t{excess()} * KZ_BRAKE * (rate_ > 0 ? -1 : 1) + around(random_, 1);
    } else if (random_.below(4)) {
      joint_.friction_drive = 0;
    }
    if (joint_.constrained != 0) {
      const std::int64_t friction = std::int64_t{joint_.friction_drive} << (KZ_DRIVE_SHIFT - 8);
      drive -= error > 0 ? friction : -friction;
    }
    const std::int64_t kd = rate_ == 0 ? 0 : -drive / rate_;
    const std::int64_t kp = (drive + rate_ * kd) * (error > 0 ? 1 : -1);
    if (!fits(kd) || !fits(kp)) return;
    joint_.kd = static_cast<s16>(kd);
    joint_.kp = static_cast<s16>(kp);
  }

  void exclude() {
    const bool rubs = joint_.dead_band != 0 || joint_.friction_drive != 0;
    if (joint_.on > 1 && joint_.constrained == 0 && rubs) joint_.on = 1;
    if (joint_.constrained != 0 && joint_.friction_drive != 0) {
      joint_.kp = std::clamp<s16>(joint_.kp, -kGainWithFriction, kGainWithFriction);
      joint_.kd = std::clamp<s16>(joint_.kd, -kGainWithFriction, kGainWithFriction);
    }
  }

  Random& random_;
  kz_joint& joint_;
  // What the loop computes first: angle and rate of this tick; and the command that a ramp leads to.
  s16 angle_ = 0;
  int rate_ = 0;
  int command_ = 0, error_ = 0;
};

}  // namespace

void draw_loop_input(std::uint64_t seed, std::uint64_t call, LoopInput& input) {
  Random random(mix64(mix64(seed) ^ call));
  // Each joint has an input of its own, wherever the first one is; now and then two share one.
  const u8 first = any_byte(random);
  const u8 stride = any_byte(random) | 1;
  for (int i = 0; i < KZ_JOINTS; ++i) {
    kz_joint& joint = input.joint[static_cast<std::size_t>(i)];
    joint.pot_input = random.below(32) ? static_cast<u8>(first + i * stride) : any_byte(random);
    input.analog[joint.pot_input] = JointState(random, joint).draw();
  }
}

}  // namespace kaz::firmware
