// Rules by which a group of boards merges its boards' replies: one rule for each field of each reply.
// SPDX-License-Identifier: Apache-2.0
//
// If messages.def gets a new reply or field, BoardGroup does not compile until the rule is listed here.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "shared/protocol/messages.h"

namespace kaz::host::merging {

// ---- Rules
// `all` is the value that was merged from the boards before, `one` the value of the next board.

// Keeps the first board's value.
struct First {
  void operator()(auto&, auto) const {}
};
// merge_rest() of the reply merges this field, because the value depends on other fields.
using Rest = First;

struct Min {
  void operator()(auto& all, auto one) const { all = std::min(all, one); }
};

struct Max {
  void operator()(auto& all, auto one) const { all = std::max(all, one); }
};

// Minimum of the values other than 0.
struct MinNonzero {
  void operator()(auto& all, auto one) const {
    if (one != 0 && (all == 0 || one < all)) all = one;
  }
};

// Saturates, as the boards' counters do.
struct Sum {
  void operator()(u16& all, u16 one) const {
    all = static_cast<u16>(std::min<std::uint32_t>(0xFFFF, std::uint32_t{all} + one));
  }
};

struct SumModulo {
  void operator()(u16& all, u16 one) const { all = static_cast<u16>(all + one); }
};

struct And {
  void operator()(auto& all, auto one) const { all &= one; }
};

struct Or {
  void operator()(auto& all, auto one) const { all |= one; }
};

// The value that differs most from half the converter's range.
struct FarthestFromHalf {
  void operator()(u16& all, u16 one) const {
    if (std::abs(one - 512) > std::abs(all - 512)) all = one;
  }
};

// For each joint, the value of the joint's board. `joints`: the joints of the next board.
struct ByJoint {
  template <class Number>
  void operator()(Number (&all)[KZ_JOINTS], const Number (&one)[KZ_JOINTS],
                  std::uint32_t joints) const {
    for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
      if (joints >> j & 1) all[j] = one[j];
    }
  }
};

// ---- Rules of the fields of each reply

// BoardGroup::merge() sets tick and status of every reply. Many replies have no other fields.
struct TickAndStatus {
  First tick, status;
  static void merge_rest(auto&, const auto&) {}
};

template <class Message>
struct Rules;

template <>
struct Rules<kz_identify_reply> : TickAndStatus {
  Min protocol_version;
  And capabilities;
  MinNonzero watchdog_10ms;
  First joints, firmware_version, build_id, image_crc, reset_cause, reaction;
};

template <>
struct Rules<kz_health_reply> : TickAndStatus {
  Min supply_mv, supply_lowest_mv;
  Max temperature_dc;
  FarthestFromHalf reference;
  Rest detail, shutdown_tick;  // belong to the first board that has shut down
  static void merge_rest(kz_health_reply& all, const kz_health_reply& one) {
    const auto shut_down = [](u16 status) { return status >> 8 != KZ_SHUTDOWN_NONE; };
    if (shut_down(all.status) || !shut_down(one.status)) return;
    all.status = one.status;
    all.detail = one.detail;
    // By its age: the clocks of two boards have different zeros.
    all.shutdown_tick = all.tick - (one.tick - one.shutdown_tick);
  }
};

template <>
struct Rules<kz_statistics_reply> : TickAndStatus {
  Max busy_8states, worst_8states;
  SumModulo frames;
  Sum missed_ticks, repetitions, refusals, bad_check, bad_stuffing, too_short, too_long,
      line_errors, overruns, idle, telemetry_dropped;
};

template <>
struct Rules<kz_self_test_reply> : TickAndStatus {
  And done;
  Or failed;
  First image_crc;
  Max start_8states;
};

template <>
struct Rules<kz_enable_reply> : TickAndStatus {
  Or mask;
};

template <>
struct Rules<kz_read_targets_reply> : TickAndStatus {
  Or mask;
  ByJoint angle;
};

template <>
struct Rules<kz_state_reply> : TickAndStatus {
  Min supply_mv;
  ByJoint angle;  // at the reference's tick (Member::align)
};

template <>
struct Rules<kz_joints_reply> : TickAndStatus {
  Or mask;
  ByJoint angle, speed, duty, load, faults;
};

template <>
struct Rules<kz_inertial_reply> : TickAndStatus {
  First yaw_rate, forward, left;
};

template <>
struct Rules<kz_settings_reply> : TickAndStatus {  // only one board has the joint
  First joint, kp, kd, dead_band, friction, ramp, lower, upper;
};

template <>
struct Rules<kz_calibration_reply> : TickAndStatus {
  Max erases_a, erases_b;
  ByJoint centre, scale;
  Rest source,
      sequence;  // as long as one board has stored no calibration, the group has stored none
  static void merge_rest(kz_calibration_reply& all, const kz_calibration_reply& one) {
    if (one.sequence >= all.sequence) return;
    all.sequence = one.sequence;
    all.source = one.source;
  }
};

template <>
struct Rules<kz_store_calibration_reply> : TickAndStatus {
  Min sequence;
  Max erases_a, erases_b;
};

}  // namespace kaz::host::merging
