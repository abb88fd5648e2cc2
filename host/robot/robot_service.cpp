// Robot: safety, health, telemetry, calibration, and what only a bench needs.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "host/robot/robot_parts.h"
#include "shared/protocol/message_info.h"

namespace kaz::host {

namespace {

constexpr double kShare = 1.0 / 255;
constexpr std::size_t kTelemetryKept = 256;
constexpr double kTickShare = 8.0 / KZ_STATES_PER_TICK;  // of a tick, in 8 states
constexpr double kSecondsPer8States = 8.0 * 1e-3 / KZ_STATES_PER_TICK;
constexpr Time kStart = std::chrono::milliseconds(200);  // within which a board answers (TIME-4)

std::optional<int> joint_of(u8 detail) {
  return detail < KZ_JOINTS ? std::optional<int>(detail) : std::nullopt;
}

std::string test_names(u8 tests) {
  constexpr std::pair<u8, const char*> kNames[] = {{KZ_TEST_RAM, "RAM"},
                                                   {KZ_TEST_FLASH, "FLASH"},
                                                   {KZ_TEST_CONVERTER, "CONVERTER"},
                                                   {KZ_TEST_SUPPLY, "SUPPLY"}};
  std::string text;
  for (const auto& [bit, name] : kNames) {
    if (tests & bit) text += (text.empty() ? "" : ", ") + std::string(name);
  }
  return text;
}

}  // namespace

// ---- Safety

Result<void> Robot::stop() {
  Parts& parts = *parts_;
  parts.on = 0;
  parts.cycles.clear();
  const Request request = make_request(KZ_TYPE_stop, kz_stop{}, kz_pack_stop);
  auto reply = parts.requester.exchange_at_once(request);
  if (!reply) {
    if (auto found = parts.resume(&reply.error()); !found) return found;
    reply = parts.requester.exchange_at_once(request);
    if (!reply) return tl::unexpected(reply.error());
  }
  parts.observe(KZ_TYPE_stop, *reply);
  const auto stopped = KAZ_TRY(read_reply(*reply, kz_unpack_stop_reply));
  if (const std::string on = parts.still_on(0, stopped.status); !on.empty())
    return fail(Fault::environment,
                "the stop request failed: motors are " + on + "; cut their power");
  return {};
}

Result<void> Robot::clear() {
  const std::uint32_t before = std::exchange(parts_->on, 0);
  const Request request = make_request(KZ_TYPE_clear, kz_clear{}, kz_pack_clear);
  const auto replies = parts_->exchange({&request, 1}, AfterLoss::repeat);
  if (!replies) return tl::unexpected(replies.error());
  const auto reply = read_reply(replies->front(), kz_unpack_clear_reply);
  if (!reply) return tl::unexpected(parts_->with_joints(reply.error(), replies->front()));
  if (reply->status & KZ_STATUS_ENABLED) parts_->on = before;
  return {};
}

Error Robot::Parts::with_joints(Error error, const Reply& reply) {
  kz_refused refusal{};
  if (!reply.refused ||
      !kz_unpack_refused(&refusal, reply.fields.bytes.data(), reply.fields.length) ||
      refusal.reason != KZ_REFUSED_FAULT || refusal.detail != KZ_SHUTDOWN_POT) {
    return error;
  }
  std::string names;
  for (const u32 half : {u32{0x1ff}, u32{0x3fe00}}) {
    const Request request = make_request(KZ_TYPE_joints, kz_joints{half}, kz_pack_joints);
    const auto replies = requester.exchange({&request, 1});
    if (!replies) return error;
    const auto answer = read_reply(replies->front(), kz_unpack_joints_reply);
    if (!answer) return error;
    for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
      if (answer->faults[j] & KZ_JOINT_POT) {
        names += (names.empty() ? "" : ", ") + std::string(joint_table()[j].name);
      }
    }
  }
  if (!names.empty()) error.message += " (" + names + ")";
  return error;
}

Result<kz_heartbeat_reply> Robot::heartbeat(Time watchdog, std::optional<Reaction> reaction) {
  const auto limit = to_wire<u8>(seconds(watchdog) * 100);
  if (!limit || *limit > 100) {
    return fail(Fault::usage, "the link watchdog's limit must be 10 ms to 1 s");
  }
  const u8 what = reaction ? static_cast<u8>(*reaction) : u8{0};
  auto reply = parts_->query(KZ_TYPE_heartbeat, kz_heartbeat{*limit, what}, kz_pack_heartbeat,
                             kz_unpack_heartbeat_reply);
  if (reply && *limit != 0) parts_->watchdog_10ms = *limit;
  if (reply && what != 0) parts_->reaction = what;
  return reply;
}

Result<Health> Robot::health() {
  const auto reply =
      parts_->query(KZ_TYPE_health, kz_health{}, kz_pack_health, kz_unpack_health_reply);
  if (!reply) return tl::unexpected(reply.error());
  Health health;
  health.tick = reply->tick;
  health.status = reply->status;
  if (const int reason = reply->status >> 8; reason != KZ_SHUTDOWN_NONE) {
    health.shutdown = kz_shutdown_text(static_cast<u8>(reason));
    health.joint = joint_of(reply->detail);
    health.shutdown_tick = reply->shutdown_tick;
  }
  health.supply_volts = reply->supply_mv * 1e-3;
  health.supply_lowest_volts = reply->supply_lowest_mv * 1e-3;
  health.temperature_c = reply->temperature_dc * 0.1;
  health.reference = reply->reference / 1024.0;
  return health;
}

std::string Robot::Parts::names_of(std::uint32_t mask) const {
  std::string names;
  for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
    if ((mask >> j & 1) == 0) continue;
    names += names.empty() ? "" : ", ";
    names += j < options.joint_names.size() ? options.joint_names[j] : joint_table()[j].name;
  }
  return names;
}

std::string Robot::Parts::still_on(std::uint32_t mask, std::uint16_t status) const {
  if (mask == 0 && (status & KZ_STATUS_ENABLED) == 0) return "";
  const std::string names = names_of(mask);
  return "still on" + (names.empty() ? "" : ": " + names);
}

std::string Robot::describe_fault(std::uint16_t status) {
  return parts_->describe_fault(status);
}

std::string Robot::Parts::describe_fault(std::uint16_t status) {
  std::string where;
  const auto reply = query(KZ_TYPE_health, kz_health{}, kz_pack_health, kz_unpack_health_reply);
  if (reply) {
    const int reason = status >> 8;
    if (const auto joint = joint_of(reply->detail)) {
      const auto at = static_cast<std::size_t>(*joint);
      where = at < options.joint_names.size() ? options.joint_names[at] : joint_table()[at].name;
    } else if (reason == KZ_SHUTDOWN_UNDERVOLTAGE || reason == KZ_SHUTDOWN_OVERVOLTAGE) {
      char volts[48];
      std::snprintf(volts, sizeof volts, "now %.1f V, lowest %.1f V", reply->supply_mv * 1e-3,
                    reply->supply_lowest_mv * 1e-3);
      where = volts;
    }
  }
  return fault_sentence(status, where).value_or("the board reports no fault");
}

Result<kz_statistics_reply> Robot::board_statistics() {
  return parts_->query(KZ_TYPE_statistics, kz_statistics{}, kz_pack_statistics,
                       kz_unpack_statistics_reply);
}

Result<SelfTest> Robot::self_test() {
  const auto reply = parts_->query(KZ_TYPE_self_test, kz_self_test{}, kz_pack_self_test,
                                   kz_unpack_self_test_reply);
  if (!reply) return tl::unexpected(reply.error());
  return SelfTest{reply->done, reply->failed, test_names(reply->failed), reply->image_crc,
                  reply->start_8states * kSecondsPer8States};
}

// ---- Telemetry

Result<void> Robot::subscribe(Time period, std::uint8_t selection) {
  const auto period_ms = to_wire<u16>(seconds(period) * 1e3);
  const kz_telemetry message{period_ms.value_or(0), selection};
  if (!period_ms || (*period_ms != 0 && *period_ms < KZ_TELEMETRY_PERIOD_MIN_MS) ||
      kz_check_telemetry(&message) != KZ_IN_BOUNDS) {
    return fail(
        Fault::usage,
        "the telemetry period must be 5 ms to 65 s, or 0 for no telemetry; the selection "
        "must be a sum of different values among KZ_TELEMETRY_STATE, KZ_TELEMETRY_COMMANDS, "
        "KZ_TELEMETRY_DRIVES and KZ_TELEMETRY_HEALTH");
  }
  const auto reply =
      parts_->query(KZ_TYPE_telemetry, message, kz_pack_telemetry, kz_unpack_telemetry_reply);
  if (!reply) return tl::unexpected(reply.error());
  parts_->telemetry_request = message;
  parts_->telemetry_on = *period_ms != 0 && selection != 0;
  return {};
}

Result<std::optional<TelemetryFrame>> Robot::next_telemetry(Time deadline) {
  Parts& parts = *parts_;
  const Time period = parts.heartbeat_period();
  while (parts.telemetry.empty() && parts.clock.now() < deadline) {
    const Time due = period > Time::zero() ? parts.requester.last_sent() + period : Time::max();
    if (parts.clock.now() >= due) {
      KAZ_TRY(heartbeat());
      continue;
    }
    if (auto listened = parts.requester.listen(std::min(deadline, due)); !listened) {
      KAZ_TRY(parts.resume(&listened.error()));
    }
  }
  if (parts.telemetry.empty()) return std::nullopt;
  TelemetryFrame oldest = parts.telemetry.front();
  parts.telemetry.pop_front();
  return oldest;
}

void Robot::Parts::take_telemetry(std::uint8_t type, std::span<const std::uint8_t> fields, Time) {
  TelemetryFrame frame;
  const auto unpack = [&](auto message, auto unpack_fields) {
    if (!unpack_fields(&message, fields.data(), static_cast<u8>(fields.size()))) {
      message.tick = 0;
    } else {
      frame.selection = static_cast<u8>(1 << (type - KZ_TYPE_telemetry_state));
      frame.tick = message.tick;
      frame.status = message.status;
    }
    return message;
  };
  switch (type) {
    case KZ_TYPE_telemetry_state: {
      const auto state = unpack(kz_telemetry_state{}, kz_unpack_telemetry_state);
      for (std::size_t j = 0; j < KZ_JOINTS; ++j) frame.values[j] = angle_of(state.angle[j]);
      frame.supply_volts = state.supply_mv * 1e-3;
      break;
    }
    case KZ_TYPE_telemetry_commands: {
      const auto commands = unpack(kz_telemetry_commands{}, kz_unpack_telemetry_commands);
      for (std::size_t j = 0; j < KZ_JOINTS; ++j) frame.values[j] = angle_of(commands.angle[j]);
      break;
    }
    case KZ_TYPE_telemetry_drives: {
      const auto drives = unpack(kz_telemetry_drives{}, kz_unpack_telemetry_drives);
      for (std::size_t j = 0; j < KZ_JOINTS; ++j) frame.values[j] = drives.duty[j] * kShare;
      break;
    }
    default: {
      const auto health = unpack(kz_telemetry_health{}, kz_unpack_telemetry_health);
      frame.joint = joint_of(health.detail);
      frame.supply_volts = health.supply_mv * 1e-3;
      frame.temperature_c = health.temperature_dc * 0.1;
      frame.tick_busy = health.busy_8states * kTickShare;
      frame.tick_worst = health.worst_8states * kTickShare;
      break;
    }
  }
  if (frame.selection == 0) return;  // of another length than the table has it
  if (relation.known()) frame.time = relation.host_time(frame.tick);
  telemetry.push_back(frame);
  if (telemetry.size() > kTelemetryKept) telemetry.pop_front();
}

// ---- Calibration

Result<Calibration> Robot::calibration() {
  const auto reply = parts_->query(KZ_TYPE_calibration, kz_calibration{}, kz_pack_calibration,
                                   kz_unpack_calibration_reply);
  if (!reply) return tl::unexpected(reply.error());
  Calibration calibration;
  calibration.source = reply->source;
  calibration.sequence = reply->sequence;
  calibration.erases_a = reply->erases_a;
  calibration.erases_b = reply->erases_b;
  for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
    calibration.joints[j] = {angle_of(reply->centre[j]), angle_of(reply->scale[j])};
  }
  return calibration;
}

Result<void> Robot::set_calibration(std::uint32_t mask,
                                    const std::array<JointCalibration, KZ_JOINTS>& joints) {
  if (auto valid = check_mask(mask); !valid) return valid;
  kz_calibrate message{};
  message.mask = mask;
  for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
    if (!(mask >> j & 1)) continue;
    const auto centre = to_wire<s16>(joints[j].centre_rad * KZ_ANGLE_PER_RAD);
    const auto scale = to_wire<s16>(joints[j].scale_rad * KZ_ANGLE_PER_RAD);
    if (!centre || !scale) {
      return fail(Fault::usage, std::string("the calibration of ") + joint_table()[j].name +
                                    " is out of range: -3.2768..3.2767 rad");
    }
    message.centre[j] = *centre;
    message.scale[j] = *scale;
  }
  const auto reply = parts_->query(KZ_TYPE_calibrate, message, kz_pack_calibrate,
                                   kz_unpack_calibrate_reply, AfterLoss::report);
  if (!reply) return tl::unexpected(reply.error());
  return {};
}

Result<StoredCalibration> Robot::store_calibration() {
  const auto reply =
      parts_->query(KZ_TYPE_store_calibration, kz_store_calibration{}, kz_pack_store_calibration,
                    kz_unpack_store_calibration_reply, AfterLoss::report);
  if (!reply) return tl::unexpected(reply.error());
  return StoredCalibration{reply->sequence, reply->erases_a, reply->erases_b};
}

// ---- Bench

Result<void> Robot::unlock(int for_seconds) {
  if (for_seconds < 0 || for_seconds > 60) {
    return fail(Fault::usage, "the bench can be unlocked for 1 to 60 s, or locked again with 0 s");
  }
  const auto reply = parts_->query(KZ_TYPE_unlock, kz_unlock{KZ_KEY, static_cast<u8>(for_seconds)},
                                   kz_pack_unlock, kz_unpack_unlock_reply);
  if (!reply) return tl::unexpected(reply.error());
  return {};
}

Result<std::uint32_t> Robot::raw_drive(int joint, double duty, Time duration) {
  KAZ_TRY(check_joint(joint));
  const auto share = to_wire<s16>(duty / kShare);
  const auto duration_ms = to_wire<u16>(seconds(duration) * 1e3);
  if (!share || std::abs(duty) > 1 || !duration_ms || *duration_ms < 1 || *duration_ms > 2000) {
    return fail(Fault::usage, "the duty of a raw drive must be -1 to 1, and its time 1 ms to 2 s");
  }
  const auto reply =
      parts_->query(KZ_TYPE_raw_drive, kz_raw_drive{static_cast<u8>(joint), *share, *duration_ms},
                    kz_pack_raw_drive, kz_unpack_raw_drive_reply, AfterLoss::report);
  if (!reply) return tl::unexpected(reply.error());
  return reply->tick;
}

Result<void> Robot::reset() {
  Parts& parts = *parts_;
  const auto reply = parts.query(KZ_TYPE_reset, kz_reset{KZ_KEY}, kz_pack_reset,
                                 kz_unpack_reset_reply, AfterLoss::report);
  if (!reply) return tl::unexpected(reply.error());
  parts.on = 0;
  parts.telemetry_on = false;
  parts.gains = {};
  parts.limits = {};
  if (auto slept = parts.clock.sleep_until(parts.clock.now() + kStart); !slept) return slept;
  parts.requester.start_anew();
  return parts.restore();
}

Result<void> Robot::start_loader() {
  const auto reply = parts_->query(KZ_TYPE_loader, kz_loader{KZ_KEY}, kz_pack_loader,
                                   kz_unpack_loader_reply, AfterLoss::report);
  if (!reply) return tl::unexpected(reply.error());
  parts_->on = 0;
  return {};
}

Result<void> Robot::set_address(int address, bool shared_line) {
  if (address < 1 || address > KZ_ADDRESS_LAST) {
    return fail(Fault::usage, "a board's address must be 1 to 14");
  }
  const kz_set_address message{static_cast<u8>(address), static_cast<u8>(shared_line ? 1 : 0)};
  const auto reply = parts_->query(KZ_TYPE_set_address, message, kz_pack_set_address,
                                   kz_unpack_set_address_reply, AfterLoss::report);
  if (!reply) return tl::unexpected(reply.error());
  return {};
}

}  // namespace kaz::host
