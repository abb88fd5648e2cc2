// Robot: settings of joints and their detailed state.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "host/link/port_address.h"
#include "host/robot/robot_parts.h"

namespace kaz::host {

namespace {

// Units of messages.def.
constexpr double kKpPerUnit = 1.0 / 256, kKdPerUnit = 1.0 / 4096, kShare = 1.0 / 255;
constexpr double kRampPerUnit = 0.1;  // 100 urad/ms
constexpr int kJointsAtOnce = 9;

// Remembers what joints were set to, joints set alike with one mask.
template <class Message>
void remember(std::array<std::optional<Message>, KZ_JOINTS>& all, const Message& message) {
  for (std::size_t j = 0; j < all.size(); ++j) {
    if (message.mask >> j & 1) {
      all[j] = message;
    } else if (all[j]) {
      all[j]->mask &= ~message.mask;
    }
  }
}

u32 lowest_bits(u32 mask, int count) {
  u32 taken = 0;
  for (int j = 0; j < KZ_JOINTS && count > 0; ++j) {
    if (!(mask >> j & 1)) continue;
    taken |= u32{1} << j;
    --count;
  }
  return taken;
}

}  // namespace

Result<void> Robot::set_gains(std::uint32_t mask, const Gains& gains) {
  if (auto valid = check_mask(mask); !valid) return valid;
  const auto kp = to_wire<u16>(gains.kp_per_rad / kKpPerUnit);
  const auto kd = to_wire<u16>(gains.kd_s_per_rad / kKdPerUnit);
  const auto dead_band = to_wire<u16>(gains.dead_band_rad * KZ_ANGLE_PER_RAD);
  const auto friction = to_wire<u8>(gains.friction / kShare);
  if (!kp || !kd || !dead_band || !friction) {
    return fail(Fault::usage,
                "gains out of range: kp must be 0 to 80 /rad, kd 0 to 1 s/rad, the dead band 0 to "
                "0.1 rad, friction 0 to 0.25");
  }
  const kz_gains message{mask, *kp, *kd, *dead_band, *friction};
  if (kz_check_gains(&message) != KZ_IN_BOUNDS) {
    return fail(Fault::usage,
                "gains out of range: kp must be 0 to 80 /rad, kd 0 to 1 s/rad, the dead band 0 to "
                "0.1 rad, friction 0 to 0.25");
  }
  const auto reply = parts_->query(KZ_TYPE_gains, message, kz_pack_gains, kz_unpack_gains_reply);
  if (!reply) return tl::unexpected(reply.error());
  remember(parts_->gains, message);
  return {};
}

double Robot::Parts::max_ramp(std::size_t joint) const {
  constexpr double kRounding = 1e-6;  // in units of the ramp
  constexpr double kLargest = KZ_RAMP_MAX;
  if (joint >= options.max_rad_per_s.size()) return kLargest * kRampPerUnit;
  const double units = std::floor(options.max_rad_per_s[joint] / kRampPerUnit + kRounding);
  return std::clamp(units, 1.0, kLargest) * kRampPerUnit;
}

Result<void> Robot::lower_ramps() {
  for (std::size_t j = 0;
       j < std::min<std::size_t>(KZ_JOINTS, parts_->options.max_rad_per_s.size()); ++j) {
    const double ramp = parts_->max_ramp(j);
    if (ramp >= KZ_RAMP_MAX * kRampPerUnit) continue;
    Limits limits = KAZ_TRY(settings(static_cast<int>(j))).limits;
    if (limits.ramp_rad_per_s <= ramp) continue;
    limits.ramp_rad_per_s = ramp;
    KAZ_TRY(set_limits(u32{1} << j, limits));
  }
  return {};
}

Result<void> Robot::set_limits(std::uint32_t mask, const Limits& limits) {
  if (auto valid = check_mask(mask); !valid) return valid;
  const auto ramp = to_wire<u16>(limits.ramp_rad_per_s / kRampPerUnit);
  const auto lower = to_wire<s16>(limits.lower_rad * KZ_ANGLE_PER_RAD);
  const auto upper = to_wire<s16>(limits.upper_rad * KZ_ANGLE_PER_RAD);
  if (!ramp || *ramp < 1 || *ramp > KZ_RAMP_MAX || !lower || !upper || *lower > *upper) {
    return fail(Fault::usage,
                "limits out of range: the ramp must be 0.1 to 12 rad/s, and both angles -3.2768 to "
                "3.2767 rad; the lower angle must not be above the upper angle");
  }
  for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
    if ((mask >> j & 1) == 0 || *ramp * kRampPerUnit <= parts_->max_ramp(j) + kRampPerUnit / 2)
      continue;
    char text[160];
    std::snprintf(text, sizeof text,
                  ": a ramp of %.1f rad/s is above the joint's speed limit of %.1f rad/s; correct "
                  "the `velocity` in the robot's file, or move more slowly",
                  *ramp * kRampPerUnit, parts_->max_ramp(j));
    return fail(Fault::usage, parts_->names_of(u32{1} << j) + text);
  }
  const kz_limits message{mask, *ramp, *lower, *upper};
  const auto reply = parts_->query(KZ_TYPE_limits, message, kz_pack_limits, kz_unpack_limits_reply);
  if (!reply) return tl::unexpected(reply.error());
  remember(parts_->limits, message);
  return {};
}

Result<JointSettings> Robot::settings(int joint) {
  KAZ_TRY(check_joint(joint));
  const auto reply = parts_->query(KZ_TYPE_settings, kz_settings{static_cast<u8>(joint)},
                                   kz_pack_settings, kz_unpack_settings_reply);
  if (!reply) return tl::unexpected(reply.error());
  JointSettings settings;
  settings.gains = {reply->kp * kKpPerUnit, reply->kd * kKdPerUnit,
                    static_cast<double>(reply->dead_band) / KZ_ANGLE_PER_RAD,
                    reply->friction * kShare};
  settings.limits = {reply->ramp * kRampPerUnit, angle_of(reply->lower), angle_of(reply->upper)};
  return settings;
}

Error Robot::Parts::with_limits(Error error, const Reply& reply,
                                std::span<const JointTarget> targets) {
  kz_refused refusal{};
  if (!reply.refused ||
      !kz_unpack_refused(&refusal, reply.fields.bytes.data(), reply.fields.length) ||
      refusal.reason != KZ_REFUSED_LIMIT || refusal.detail >= KZ_JOINTS) {
    return error;
  }
  const Request request =
      make_request(KZ_TYPE_settings, kz_settings{refusal.detail}, kz_pack_settings);
  const auto replies = requester.exchange({&request, 1});
  if (!replies) return error;
  const auto set = read_reply(replies->front(), kz_unpack_settings_reply);
  if (!set) return error;
  const std::string recover =
      "kaz recover " + robot_option(requester.link().name()) +
      (options.address == KZ_ADDRESS_DEFAULT ? ""
                                             : " --address " + std::to_string(options.address));
  return outside_set_limits(refusal.detail, targets,
                            {set->ramp * kRampPerUnit, angle_of(set->lower), angle_of(set->upper)},
                            recover);
}

Result<JointAngles> Robot::read_targets(std::uint32_t mask) {
  KAZ_TRY(check_mask(mask));
  const auto reply = parts_->query(KZ_TYPE_read_targets, kz_read_targets{mask},
                                   kz_pack_read_targets, kz_unpack_read_targets_reply);
  if (!reply) return tl::unexpected(reply.error());
  JointAngles angles;
  for (std::size_t j = 0; j < angles.size(); ++j) angles[j] = angle_of(reply->angle[j]);
  return angles;
}

Result<std::vector<JointDetail>> Robot::joints(std::uint32_t mask) {
  KAZ_TRY(check_mask(mask));
  std::vector<JointDetail> details;
  while (mask != 0) {
    const u32 now = lowest_bits(mask, kJointsAtOnce);
    mask &= ~now;
    const auto reply =
        parts_->query(KZ_TYPE_joints, kz_joints{now}, kz_pack_joints, kz_unpack_joints_reply);
    if (!reply) return tl::unexpected(reply.error());
    for (int j = 0; j < KZ_JOINTS; ++j) {
      if (!(now >> j & 1)) continue;
      details.push_back({j, angle_of(reply->angle[j]), reply->speed[j] * 1e-3,
                         reply->duty[j] * kShare, reply->load[j] * kShare, reply->faults[j]});
    }
  }
  return details;
}

}  // namespace kaz::host
