// Answers requests of the protocol by a bus of servos.
// SPDX-License-Identifier: Apache-2.0
#include "host/bus/bus_board.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "shared/base/angle.hpp"
#include "shared/protocol/bytes.h"
#include "shared/servo/tick.h"

namespace kaz::host {

using servo_bus::BusServo;

namespace {

constexpr int kMostMissing = 3;                                // readings in a row
constexpr Time kFresh = std::chrono::milliseconds(2);          // of readings
constexpr Time kStream = std::chrono::milliseconds(50);        // shorter moves are one of many
constexpr Time kSilentEvery = std::chrono::milliseconds(100);  // a silent servo is asked to be off
constexpr double kPerRad = KZ_ANGLE_PER_RAD;

s16 to_angle(double rad) {
  return static_cast<s16>(std::clamp(std::lround(rad * kPerRad), -32767L, 32767L));
}

double to_rad(s16 angle) {
  return angle / kPerRad;
}

u16 to_u16(double value) {
  return static_cast<u16>(std::clamp(std::lround(value), 0L, 65535L));
}

template <class Message>
std::vector<std::uint8_t> packed(const Message& message, u8 (*pack)(const Message*, u8*)) {
  std::array<u8, KZ_PAYLOAD_MAX> fields{};
  const u8 size = pack(&message, fields.data());
  return {fields.begin(), fields.begin() + size};
}

std::string degrees(double rad) {
  return std::to_string(std::lround(rad / kDegree));
}

// Beyond its last step a position goes on at the first one, where a goal would drive the joint the long way.
Result<void> check_range(const BusJoint& joint) {
  const auto [low, high] =
      std::minmax({joint.servo.steps_at(joint.lower_rad), joint.servo.steps_at(joint.upper_rad)});
  const int last = joint.servo.model->steps - 1;
  if (low > -1 && high < last + 1) return {};
  return fail(Fault::usage,
              named(joint.servo) + ": in bus.json, its range of " + degrees(joint.lower_rad) +
                  " to " + degrees(joint.upper_rad) + " degrees corresponds to positions " +
                  std::to_string(std::lround(low)) + " to " + std::to_string(std::lround(high)) +
                  ", but the servo has positions 0 to " + std::to_string(last) +
                  ": run `kaz calibrate joints`");
}

}  // namespace

Result<BusBoard> BusBoard::open(Link& link, Clock& clock, std::vector<BusJoint> joints) {
  if (joints.empty() || joints.size() > KZ_JOINTS)
    return fail(Fault::usage, "a robot on a servo bus must have 1 to " + std::to_string(KZ_JOINTS) +
                                  " joints, not " + std::to_string(joints.size()));
  const servo_bus::Protocol protocol = joints.front().servo.model->protocol;
  BusBoard board(BusDriver::make(protocol, link, clock), clock);
  std::set<int> ids;
  std::string silent;
  for (BusJoint& joint : joints) {
    if (joint.servo.model->protocol != protocol)
      return fail(Fault::usage, "bus.json has servos of two protocols: use one protocol per bus");
    if (!ids.insert(joint.servo.id).second)
      return fail(Fault::usage, "bus.json has the id " + std::to_string(joint.servo.id) +
                                    " twice: give each servo its own id");
    KAZ_TRY(check_range(joint));
    const auto greeting = KAZ_TRY(board.driver_->greet(joint.servo));
    if (!greeting) {
      silent += (silent.empty() ? "" : ", ") + named(joint.servo);
      continue;
    }
    const auto& [model, mode, refused] = *greeting;
    if (model && *model != joint.servo.model->number)
      return fail(Fault::usage, named(joint.servo) + " on " + link.name() + " has model number " +
                                    std::to_string(*model) + ", but bus.json says " +
                                    std::string(joint.servo.model->name) + " (" +
                                    std::to_string(joint.servo.model->number) + ")");
    const int wanted = board.driver_->position_mode();
    if (mode && *mode != wanted)
      return fail(Fault::usage, named(joint.servo) + " on " + link.name() + " is in mode " +
                                    std::to_string(*mode) + ": only the position mode, " +
                                    std::to_string(wanted) + ", is supported");
    if (!refused.empty())
      return fail(
          Fault::environment,
          named(joint.servo) + " on " + link.name() + " does not accept 0 for its register " +
              std::string(refused) + ": check its plug and supply; `kaz bus scan " +
              bus_option(joint.servo.model->protocol, link.name()) + "` counts lost answers");
    Joint& one = board.joints_.emplace_back();
    one.of = std::move(joint);
  }
  if (!silent.empty())
    return fail(Fault::environment,
                silent + (silent.find(',') == std::string::npos ? " does" : " do") +
                    " not answer on " + link.name() + ": check power, cable, id and bit rate (" +
                    std::string(servo_bus::name_of(protocol)) + ":PATH@BAUD)");
  KAZ_TRY(board.reset());
  constexpr double kBeyond =
      15 * kDegree;  // of its stops, which give way, and of a rough calibration
  for (const Joint& joint : board.joints_) {
    if (joint.missing == 0 &&
        (joint.angle < joint.of.lower_rad - kBeyond || joint.angle > joint.of.upper_rad + kBeyond))
      return fail(
          Fault::environment,
          named(joint.of.servo) + " on " + link.name() + " is at " + degrees(joint.angle) +
              " degrees according to bus.json, outside its range of " +
              degrees(joint.of.lower_rad) + " to " + degrees(joint.of.upper_rad) +
              ": bus.json belongs to another robot; `kaz calibrate joints` writes a new one");
  }
  return board;
}

// Largest ramp (0.1 rad/s) within the joint's speed limit; at least 1, the smallest ramp of the protocol.
u16 max_ramp(const BusJoint& joint) {
  return static_cast<u16>(std::clamp(std::floor(10 * joint.max_rad_per_s), 1.0, 60.0));
}

Result<void> BusBoard::reset() {
  KAZ_TRY(switch_to(0));
  for (Joint& joint : joints_) {
    joint.lower = to_angle(joint.of.lower_rad);
    joint.upper = to_angle(joint.of.upper_rad);
    joint.ramp = max_ramp(joint.of);
    joint.kp = KZ_KP_DEFAULT;
    joint.kd = KZ_KD_DEFAULT;
    joint.dead_band = 0;
    joint.friction = 0;
  }
  start_ = clock_.now();
  reason_ = 0;
  shutdown_tick_ = 0;
  frames_ = refusals_ = bad_frames_ = 0;
  last_body_.clear();
  has_looked_ = false;
  KAZ_TRY(look());
  lowest_volts_ = volts_;
  return {};
}

void BusBoard::forget() {
  kz_receiver_init(&receiver_);
  waiting_.clear();
  has_looked_ = false;
}

std::uint32_t BusBoard::tick() const {
  return static_cast<std::uint32_t>((clock_.now() - start_).count() / 1'000'000);
}

std::uint32_t BusBoard::on() const {
  std::uint32_t mask = 0;
  for (std::size_t j = 0; j < joints_.size(); ++j)
    mask |= (joints_[j].power != Power::off ? 1u : 0u) << j;
  return mask;
}

std::uint32_t BusBoard::driven() const {
  std::uint32_t mask = 0;
  for (std::size_t j = 0; j < joints_.size(); ++j)
    mask |= (joints_[j].power == Power::on ? 1u : 0u) << j;
  return mask;
}

std::string BusBoard::still_on() const {
  std::vector<BusDriver::Torque> torque;
  for (const Joint& joint : joints_)
    torque.push_back(joint.power == Power::off ? BusDriver::Torque::off : joint.said);
  return host::still_on(servos(), torque);
}

std::uint32_t BusBoard::there() const {
  return (std::uint32_t{1} << joints_.size()) - 1;
}

u16 BusBoard::status() const {
  u16 status = static_cast<u16>(reason_ << 8);
  if (on() != 0) status |= KZ_STATUS_ENABLED;
  if (on() != 0 && clock_.now() < moving_until_) status |= KZ_STATUS_MOVING;
  return status;
}

std::vector<const BusServo*> BusBoard::servos() const {
  std::vector<const BusServo*> all;
  for (const Joint& joint : joints_) all.push_back(&joint.of.servo);
  return all;
}

Result<void> BusBoard::look() {
  if (has_looked_ && clock_.now() - looked_ < kFresh) return {};
  const auto states = KAZ_TRY(driver_->read_all(servos()));
  looked_ = clock_.now();
  has_looked_ = true;
  double volts = 0, celsius = 0;
  int measured = 0;
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    Joint& joint = joints_[j];
    if (!states[j]) {
      ++joint.missing;
      continue;
    }
    joint.missing = 0;
    const BusServo& servo = joint.of.servo;
    joint.trouble = states[j]->trouble;
    joint.angle = servo.angle_at(states[j]->steps);
    joint.speed = servo.sign() * states[j]->speed / servo.model->steps_per_rad();
    joint.duty = servo.sign() * states[j]->duty;
    if (std::isnan(states[j]->volts)) continue;
    volts += states[j]->volts;
    celsius = std::max(celsius, states[j]->celsius);
    ++measured;
  }
  if (measured > 0) {
    volts_ = volts / measured;
    celsius_ = celsius;
  }
  lowest_volts_ = std::min(lowest_volts_, volts_);
  u8 detail = KZ_NO_DETAIL;
  if (const u8 reason = cause(detail); reason != 0 && driven() != 0)
    return shut_down(reason, detail);
  return release_next();
}

u8 BusBoard::cause(u8& detail) const {
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const Joint& joint = joints_[j];
    detail = static_cast<u8>(j);
    if (joint.missing >= kMostMissing || !joint.accepted) return KZ_SHUTDOWN_POT;
    if ((joint.trouble & kTroubleSensor) != 0) return KZ_SHUTDOWN_POT;
    if ((joint.trouble & kTroubleOverload) != 0) return KZ_SHUTDOWN_OVERLOAD;
    detail = KZ_NO_DETAIL;
    if ((joint.trouble & kTroubleHeat) != 0) return KZ_SHUTDOWN_TEMPERATURE;
    if ((joint.trouble & kTroubleVoltage) != 0) return KZ_SHUTDOWN_UNDERVOLTAGE;
  }
  detail = KZ_NO_DETAIL;
  return 0;
}

Result<void> BusBoard::shut_down(u8 reason, u8 detail) {
  reason_ = reason;
  detail_ = detail;
  shutdown_tick_ = tick();
  return switch_to(0);
}

Result<void> BusBoard::release(std::vector<Joint*> joints, Time within) {
  if (joints.empty()) return {};
  // Those that answer come first: waiting for a silent one takes long.
  // clang 14 does not compile std::ranges::stable_partition of libstdc++ 12.
  std::stable_partition(joints.begin(), joints.end(),
                        [](const Joint* joint) { return joint->missing == 0; });
  std::vector<const BusServo*> servos;
  for (Joint* joint : joints) {
    joint->power = Power::unconfirmed;
    joint->said = BusDriver::Torque::silent;
    servos.push_back(&joint->of.servo);
  }
  const auto torque = KAZ_TRY(driver_->release(servos, within));
  for (std::size_t i = 0; i < joints.size(); ++i) {
    joints[i]->said = torque[i];
    if (torque[i] == BusDriver::Torque::off) joints[i]->power = Power::off;
  }
  return {};
}

Result<void> BusBoard::release_next() {
  if (on() == driven()) return {};
  const bool silent_too = clock_.now() >= silent_due_;
  for (std::size_t n = 0; n < joints_.size(); ++n) {
    released_ = (released_ + 1) % joints_.size();
    Joint& joint = joints_[released_];
    if (joint.power != Power::unconfirmed || (joint.missing > 0 && !silent_too)) continue;
    if (joint.missing > 0) silent_due_ = clock_.now() + kSilentEvery;
    return release({&joint}, Time::zero());
  }
  return {};
}

// A joint that was off holds the angle that it has, if that was just read.
Result<void> BusBoard::switch_to(std::uint32_t mask) {
  std::vector<Joint*> off, failed;
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    // Also one that should be off already: a program that was killed may have left it on.
    if ((mask >> j & 1) == 0) off.push_back(&joints_[j]);
  }
  KAZ_TRY(release(std::move(off)));
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    Joint& joint = joints_[j];
    if ((mask >> j & 1) == 0 || joint.power == Power::on || joint.missing > 0) continue;
    joint.target = joint.angle;
    joint.power = Power::unconfirmed;  // until it says that it holds, or that it is off
    joint.said = BusDriver::Torque::silent;
    const BusServo& servo = joint.of.servo;
    if (KAZ_TRY(driver_->hold(servo, servo.steps_at(joint.angle)))) {
      joint.power = Power::on;
      joint.said = BusDriver::Torque::on;
    } else {
      failed.push_back(&joint);
    }
  }
  return release(std::move(failed));
}

// A servo goes to its target at a constant speed; of targets that follow one another, each is gone to as fast
// as the joint's ramp allows.
Result<void> BusBoard::move(const kz_targets& targets) {
  const Time duration = std::chrono::milliseconds(targets.duration_ms);
  std::vector<BusDriver::Goal> goals;
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    if ((targets.mask >> j & 1) == 0) continue;
    Joint& joint = joints_[j];
    const BusServo& servo = joint.of.servo;
    const double target = to_rad(targets.angle[j]),
                 most = std::min(joint.ramp / 10.0, joint.of.max_rad_per_s);
    const double speed = duration < kStream
                             ? most
                             : std::min(most, std::abs(target - joint.angle) / seconds(duration));
    joint.target = target;
    goals.push_back({&servo, servo.steps_at(target), speed * servo.model->steps_per_rad()});
  }
  KAZ_TRY(driver_->move(goals));
  moving_until_ = std::max(moving_until_, clock_.now() + duration);
  return {};
}

Result<void> BusBoard::recover() {
  std::vector<BusDriver::Goal> troubled;
  std::vector<Joint*> joints;
  for (Joint& joint : joints_) {
    if (joint.missing > 0 || (joint.trouble == 0 && joint.accepted)) continue;
    troubled.push_back({&joint.of.servo, joint.of.servo.steps_at(joint.angle), 0});
    joints.push_back(&joint);
    joint.power = Power::unconfirmed;
  }
  if (!troubled.empty()) {
    const auto accepted = KAZ_TRY(driver_->recover(troubled));
    for (std::size_t i = 0; i < joints.size(); ++i) joints[i]->accepted = accepted[i];
    KAZ_TRY(release(std::move(joints)));
  }
  has_looked_ = false;
  return look();
}

void BusBoard::set_gains(const kz_gains& gains) {
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    if ((gains.mask >> j & 1) == 0) continue;
    Joint& joint = joints_[j];
    joint.kp = gains.kp;
    joint.kd = gains.kd;
    joint.dead_band = gains.dead_band;
    joint.friction = gains.friction;
  }
}

void BusBoard::set_limits(const kz_limits& limits) {
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    if ((limits.mask >> j & 1) == 0) continue;
    Joint& joint = joints_[j];
    joint.ramp = std::min(limits.ramp, max_ramp(joint.of));
    joint.lower = std::max(limits.lower, to_angle(joint.of.lower_rad));
    joint.upper = std::min(limits.upper, to_angle(joint.of.upper_rad));
  }
}

void BusBoard::take(std::span<const std::uint8_t> bytes) {
  for (const std::uint8_t byte : bytes) {
    const u8 result = kz_receive(&receiver_, byte, 0);
    if (result == KZ_RECEIVE_FRAME && receiver_.length >= KZ_HEADER_SIZE) {
      std::vector<std::uint8_t> body(receiver_.body, receiver_.body + receiver_.length);
      if (switches_all_off(body)) waiting_.clear();
      waiting_.push_back(std::move(body));
    } else if (result != KZ_RECEIVE_MORE) {
      ++bad_frames_;
    }
  }
}

bool BusBoard::switches_all_off(const std::vector<std::uint8_t>& body) {
  const u8 address = body[KZ_BODY_ADDRESS], type = body[KZ_BODY_TYPE];
  if (address != KZ_ADDRESS_DEFAULT && address != KZ_ADDRESS_ALL) return false;
  return type == KZ_TYPE_stop ||
         (type == KZ_TYPE_enable && body.size() == KZ_HEADER_SIZE + KZ_SIZE_enable &&
          kz_get_u32(body.data() + KZ_HEADER_SIZE) == 0);
}

Result<std::optional<std::vector<std::uint8_t>>> BusBoard::serve() {
  if (waiting_.empty()) return std::optional<std::vector<std::uint8_t>>();
  const std::vector<std::uint8_t> body = std::move(waiting_.front());
  waiting_.erase(waiting_.begin());
  const u8 address = body[KZ_BODY_ADDRESS], type = body[KZ_BODY_TYPE];
  if (address != KZ_ADDRESS_DEFAULT && address != KZ_ADDRESS_ALL)
    return std::vector<std::uint8_t>();
  ++frames_;
  std::vector<std::uint8_t> request(body.begin() + KZ_HEADER_SIZE, body.end());
  // The same once more: answered, not executed again, but for what it switches off (clause REQ-12).
  if (body == last_body_) {
    if (type == KZ_TYPE_enable && request.size() == KZ_SIZE_enable) {
      kz_put_u32(request.data(), kz_get_u32(request.data()) & (driven() | ~there()));
    } else if (type != KZ_TYPE_stop && type != KZ_TYPE_reset) {
      return last_answer_;
    }
  }

  Refusal refusal;
  auto fields = KAZ_TRY(answer(type, request.data(), static_cast<u8>(request.size()), refusal));
  u8 reply = static_cast<u8>(type | KZ_REPLY);
  if (refusal.reason != 0) {
    ++refusals_;
    reply = KZ_TYPE_refused;
    fields =
        packed(kz_refused{tick(), status(), type, refusal.reason, refusal.detail}, kz_pack_refused);
  }
  std::vector<std::uint8_t> answered{KZ_ADDRESS_DEFAULT, reply, body[KZ_BODY_SEQUENCE]};
  answered.insert(answered.end(), fields.begin(), fields.end());
  std::array<std::uint8_t, KZ_FRAME_MAX> wire{};
  const u8 size = kz_frame_encode(answered.data(), static_cast<u8>(answered.size()), wire.data());
  last_body_ = body;
  last_answer_.clear();
  if (address != KZ_ADDRESS_ALL) last_answer_.assign(wire.begin(), wire.begin() + size);
  return last_answer_;
}

BusBoard::Fields BusBoard::health_reply() const {
  const auto millivolts = [](double volts) { return to_u16(1000 * volts); };
  return packed(kz_health_reply{tick(), status(), reason_ != 0 ? detail_ : u8{KZ_NO_DETAIL},
                                shutdown_tick_, millivolts(volts_), millivolts(lowest_volts_),
                                static_cast<s16>(std::lround(10 * celsius_)), 512},
                kz_pack_health_reply);
}

BusBoard::Fields BusBoard::statistics_reply() const {
  kz_statistics_reply reply{};
  reply.tick = tick();
  reply.status = status();
  reply.frames = frames_;
  reply.refusals = refusals_;
  reply.bad_check = bad_frames_;
  return packed(reply, kz_pack_statistics_reply);
}

Result<BusBoard::Refusal> BusBoard::refuse_for_cause() {
  u8 detail = KZ_NO_DETAIL;
  const u8 reason = cause(detail);
  if (reason == 0) return Refusal();
  KAZ_TRY(shut_down(reason, detail));
  return Refusal{KZ_REFUSED_FAULT, reason};
}

Result<BusBoard::Fields> BusBoard::enable(std::uint32_t mask, Refusal& refusal) {
  if (mask != 0 && reason_ != 0) {
    refusal = {KZ_REFUSED_FAULT, reason_};
    return Fields();
  }
  // Off waits for no reading.
  if (mask != 0) {
    has_looked_ = false;
    KAZ_TRY(look());
    refusal = KAZ_TRY(refuse_for_cause());
    if (refusal.reason != 0) return Fields();
  }
  KAZ_TRY(switch_to(mask));
  // Joints that are not there are as they were requested.
  if (driven() != (mask & there())) {
    // A servo whose protection has acted meanwhile does not go on.
    has_looked_ = false;
    KAZ_TRY(look());
    refusal = KAZ_TRY(refuse_for_cause());
    if (refusal.reason != 0) return Fields();
  }
  // A joint that was to be on counts as on if it holds; one that was to be off, until it says that it is.
  const std::uint32_t enabled = (driven() & mask) | (on() & ~mask) | (mask & ~there());
  return packed(kz_enable_reply{tick(), status(), enabled}, kz_pack_enable_reply);
}

BusBoard::Refusal BusBoard::check(const kz_targets& targets) const {
  if (reason_ != 0) return {KZ_REFUSED_FAULT, reason_};
  for (u8 j = 0; j < KZ_JOINTS; ++j) {
    if ((targets.mask >> j & 1) == 0) continue;
    if (j >= joints_.size() || joints_[j].power != Power::on) return {KZ_REFUSED_DISABLED, j};
    if (targets.angle[j] < joints_[j].lower || targets.angle[j] > joints_[j].upper)
      return {KZ_REFUSED_LIMIT, j};
  }
  return {};
}

BusBoard::Fields BusBoard::read_targets_reply(std::uint32_t mask) const {
  kz_read_targets_reply reply{};
  reply.tick = tick();
  reply.status = status();
  reply.mask = mask;
  for (std::size_t j = 0; j < joints_.size(); ++j)
    reply.angle[j] = to_angle(joints_[j].power == Power::on ? joints_[j].target : joints_[j].angle);
  return packed(reply, kz_pack_read_targets_reply);
}

BusBoard::Fields BusBoard::state_reply() const {
  kz_state_reply reply{};
  reply.tick = tick();
  reply.status = status();
  reply.supply_mv = to_u16(1000 * volts_);
  for (std::size_t j = 0; j < joints_.size(); ++j) reply.angle[j] = to_angle(joints_[j].angle);
  return packed(reply, kz_pack_state_reply);
}

BusBoard::Fields BusBoard::joints_reply(std::uint32_t mask) const {
  kz_joints_reply reply{};
  reply.tick = tick();
  reply.status = status();
  reply.mask = mask;
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const Joint& joint = joints_[j];
    reply.angle[j] = to_angle(joint.angle);
    reply.speed[j] = static_cast<s16>(std::clamp(std::lround(1000 * joint.speed), -32767L, 32767L));
    reply.duty[j] = static_cast<s16>(std::lround(255 * std::clamp(joint.duty, -1.0, 1.0)));
    reply.load[j] = static_cast<u8>(std::lround(255 * std::min(1.0, std::abs(joint.duty))));
    reply.faults[j] =
        static_cast<u8>((joint.power != Power::off ? KZ_JOINT_ON : 0) |
                        (joint.missing > 0 || !joint.accepted ? KZ_JOINT_POT : 0) |
                        ((joint.trouble & kTroubleOverload) != 0 ? KZ_JOINT_STALLED : 0) |
                        ((joint.trouble & kTroubleHeat) != 0 ? KZ_JOINT_HOT : 0));
  }
  return packed(reply, kz_pack_joints_reply);
}

Result<BusBoard::Fields> BusBoard::clear(Refusal& refusal) {
  has_looked_ = false;
  KAZ_TRY(look());
  KAZ_TRY(recover());
  u8 detail = KZ_NO_DETAIL;
  if (const u8 reason = cause(detail); reason != 0) {
    refusal = {KZ_REFUSED_FAULT, reason};
    return Fields();
  }
  reason_ = 0;
  shutdown_tick_ = 0;
  return acknowledge();
}

BusBoard::Fields BusBoard::settings_reply(u8 number) const {
  const Joint joint = number < joints_.size() ? joints_[number] : Joint();
  return packed(kz_settings_reply{tick(), status(), number, joint.kp, joint.kd, joint.dead_band,
                                  joint.friction, joint.ramp, joint.lower, joint.upper},
                kz_pack_settings_reply);
}

BusBoard::Fields BusBoard::acknowledge() const {
  return packed(kz_targets_reply{tick(), status()}, kz_pack_targets_reply);
}

Result<BusBoard::Fields> BusBoard::answer(u8 type, const u8* body, u8 size, Refusal& refusal) {
  const auto refuse = [&refusal](u8 reason, u8 detail = KZ_NO_DETAIL) {
    refusal = {reason, detail};
    return Fields();
  };
  switch (type) {
    case KZ_TYPE_identify:
      return packed(kz_identify_reply{tick(), KZ_PROTOCOL_VERSION, KZ_JOINTS, status(), 0, 0x0100,
                                      0, 0, KZ_RESET_POWER, watchdog_10ms_, reaction_},
                    kz_pack_identify_reply);
    case KZ_TYPE_health:
      KAZ_TRY(look());
      return health_reply();
    case KZ_TYPE_statistics:
      return statistics_reply();
    case KZ_TYPE_self_test:
      return packed(kz_self_test_reply{tick(), status(), 0, 0, 0, 0}, kz_pack_self_test_reply);
    case KZ_TYPE_enable: {
      kz_enable request{};
      if (!kz_unpack_enable(&request, body, size)) return refuse(KZ_REFUSED_LENGTH);
      return enable(request.mask, refusal);
    }
    case KZ_TYPE_targets: {
      kz_targets targets{};
      if (!kz_unpack_targets(&targets, body, size)) return refuse(KZ_REFUSED_LENGTH);
      refusal = check(targets);
      if (refusal.reason != 0) return Fields();
      KAZ_TRY(move(targets));
      return acknowledge();
    }
    case KZ_TYPE_read_targets: {
      kz_read_targets query{};
      if (!kz_unpack_read_targets(&query, body, size)) return refuse(KZ_REFUSED_LENGTH);
      KAZ_TRY(look());
      return read_targets_reply(query.mask);
    }
    case KZ_TYPE_state:
      KAZ_TRY(look());
      return state_reply();
    case KZ_TYPE_joints: {
      kz_joints query{};
      if (!kz_unpack_joints(&query, body, size)) return refuse(KZ_REFUSED_LENGTH);
      KAZ_TRY(look());
      return joints_reply(query.mask);
    }
    case KZ_TYPE_stop:
      KAZ_TRY(shut_down(KZ_SHUTDOWN_STOP, KZ_NO_DETAIL));
      return acknowledge();
    case KZ_TYPE_clear:
      return clear(refusal);
    case KZ_TYPE_heartbeat: {
      kz_heartbeat heartbeat{};
      if (!kz_unpack_heartbeat(&heartbeat, body, size)) return refuse(KZ_REFUSED_LENGTH);
      if (heartbeat.watchdog_10ms != 0) watchdog_10ms_ = heartbeat.watchdog_10ms;
      if (heartbeat.reaction != 0) reaction_ = heartbeat.reaction;
      KAZ_TRY(
          look());  // a servo that is lost or overloaded is found while nothing else is requested
      return acknowledge();
    }
    case KZ_TYPE_gains: {
      kz_gains gains{};
      if (!kz_unpack_gains(&gains, body, size)) return refuse(KZ_REFUSED_LENGTH);
      set_gains(gains);
      return acknowledge();
    }
    case KZ_TYPE_limits: {
      kz_limits limits{};
      if (!kz_unpack_limits(&limits, body, size)) return refuse(KZ_REFUSED_LENGTH);
      if (limits.lower > limits.upper) return refuse(KZ_REFUSED_RANGE);
      set_limits(limits);
      return acknowledge();
    }
    case KZ_TYPE_settings: {
      kz_settings query{};
      if (!kz_unpack_settings(&query, body, size)) return refuse(KZ_REFUSED_LENGTH);
      return settings_reply(query.joint);
    }
    case KZ_TYPE_calibration: {
      kz_calibration_reply reply{};
      reply.tick = tick();
      reply.status = status();
      return packed(reply, kz_pack_calibration_reply);
    }
    case KZ_TYPE_unlock:
      return acknowledge();
    case KZ_TYPE_telemetry:
      return refuse(KZ_REFUSED_SHARED_LINE);
    case KZ_TYPE_reset: {
      KAZ_TRY(reset());
      return acknowledge();
    }
    default:
      return refuse(KZ_REFUSED_UNKNOWN_TYPE);
  }
}

}  // namespace kaz::host
