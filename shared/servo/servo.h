// State of the servo tick. Only shared/servo writes the state. Other code only reads the state (fields.h).
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_SERVO_SERVO_H
#define KAZ_SHARED_SERVO_SERVO_H

#include "shared/base/types.h"
#include "shared/board/board.h"
#include "shared/protocol/messages.h"
#include "shared/servo/snapshot.h"

#ifdef __cplusplus
extern "C" {
#endif

#define KZ_FIRMWARE_VERSION 0x0002  // major * 256 + minor

// Defaults after a reset. protocol/messages.h has the defaults of the gains.
#define KZ_RAMP_DEFAULT 60  // 6 rad/s; the unit is 100 urad/ms
#define KZ_WATCHDOG_DEFAULT_MS 90

// Limits of the protection. KZ_*_FAULT_MS is the time for which a value may stay out of range.
#define KZ_POT_LOWEST 4      // lower A/D codes mean a short or open circuit
#define KZ_POT_HIGHEST 1019  // higher A/D codes mean a short or open circuit
#define KZ_POT_FAULT_MS 20
#define KZ_SUPPLY_LOWEST_MV 4000    // 4 V; the servos are made for 4.8 V
#define KZ_SUPPLY_HIGHEST_MV 13000  // 13 V; the motor drivers are made for at most 12 V
#define KZ_SUPPLY_FAULT_MS 20
#define KZ_TEMPERATURE_HIGHEST_DC 850  // 85 degC; the drivers switch off by themselves at 100 degC
#define KZ_TEMPERATURE_FAULT_MS 20
#define KZ_REFERENCE_CODE 512
#define KZ_REFERENCE_TOLERANCE 16  // maximum difference from KZ_REFERENCE_CODE
#define KZ_REFERENCE_FAULT_MS 20

// State of one joint. The order of the fields avoids padding, so offsets are the same on the H8 (which aligns
// to 2 bytes) and on the PC. A test checks the layout on the PC.
//
//   pot_centre, pot_scale  calibration of the potentiometer (board/table.h)
//   angle       measured joint angle, 100 urad
//   rate        speed, 1/64 of 100 urad/ms; first-order filter with coefficient 1/8 per tick
//   target      end of the ramp, 100 urad
//   command     setpoint of the loop, 100 urad
//   ramp_*      linear ramp of `command` to the target. The ramp has `time` ticks, of which `left`
//               remain. Each tick adds `whole` to `command`, and subtracts `rest` from `room`. If
//               `room` is used up, the tick also adds `extra` (+1 or -1) to `command`, and adds
//               `time` to `room`. Sums are modulo 2^16.
//   ramp_limit  maximum change of `command` per tick, for ramps that start from now on
//   lower, upper  soft limits, which are within the mechanical limits, 100 urad
//   dead_band, friction  as in the message `gains`
//   target_ms   duration of the next ramp, which leads to `target` and has not started yet
//   kp          gain, in 1/2048 of a count of duty per two units of error
//   kd          gain, in 1/2048 of a count of duty per unit of rate
//   friction_drive  `friction` in 1/256 of a count of duty
//   duty        high counts of the PWM, 0..255
//   forward     direction output
//   pot_bad_ms  time for which the potentiometer has been out of range, up to KZ_POT_FAULT_MS;
//               1 before the first measurement
//   pot_input   index into kz_tick_input.analog
//   mirrored    1: turning the shaft forward decreases the joint angle
//   constrained KZ_CONSTRAINED_* (joint_loop.h)
//   on          1 if the joint is on; equal to the joint's bit in `enabled`
//   heat        I2t heat of the motor (protection.h)
//   stall_angle reference angle of the stall detection, 100 urad
//   load        torque as a share of the stall torque at 10 V, 0..255
//   stalled     time at standstill under high load, in periods of KZ_PROTECTION_MS
#define KZ_JOINT_FIELDS(FIELD) \
  FIELD(u32, heat)             \
  FIELD(s16, pot_centre)       \
  FIELD(s16, pot_scale)        \
  FIELD(s16, angle)            \
  FIELD(s16, rate)             \
  FIELD(s16, target)           \
  FIELD(s16, command)          \
  FIELD(u16, ramp_left)        \
  FIELD(u16, ramp_time)        \
  FIELD(u16, ramp_whole)       \
  FIELD(u16, ramp_extra)       \
  FIELD(u16, ramp_rest)        \
  FIELD(u16, ramp_room)        \
  FIELD(u16, ramp_limit)       \
  FIELD(s16, lower)            \
  FIELD(s16, upper)            \
  FIELD(u16, dead_band)        \
  FIELD(s16, stall_angle)      \
  FIELD(s16, kp)               \
  FIELD(s16, kd)               \
  FIELD(u16, target_ms)        \
  FIELD(u16, friction_drive)   \
  FIELD(u8, duty)              \
  FIELD(u8, forward)           \
  FIELD(u8, pot_bad_ms)        \
  FIELD(u8, pot_input)         \
  FIELD(u8, mirrored)          \
  FIELD(u8, friction)          \
  FIELD(u8, load)              \
  FIELD(u8, stalled)           \
  FIELD(u8, constrained)       \
  FIELD(u8, on)

// State of the board.
//
//   tick            number of the present tick
//   enabled         joints that are on, bit n: joint n
//   fresh_targets   joints whose ramp to `target` has not started yet
//   shutdown_tick   tick in which `shutdown` was latched
//   image_crc, start_8states, reset_cause, tests_*, shared_line, address, calibration
//                   copies of the fields of kz_startup
//   frames .. refusals       counters of `statistics_reply`
//   bad_check .. idle        damaged frames by cause, saturated at 65535
//   missed_tick, holding, uncalibrated  the status flag KZ_STATUS_* of the same name, or 0
//   shutdown        latched KZ_SHUTDOWN_* reason. shutdown_detail: detail of the reason
//   reaction        KZ_REACTION_* of the link watchdog
//   silent_ms       time since the last valid request
//   watchdog_ms     timeout of the link watchdog
//   supply_mv, supply_lowest_mv, temperature_dc, reference  as in `health_reply`
//   supply_bad_ms, hot_ms, reference_bad_ms  time out of range, saturated; initially 1
//   phase           tick counter for work that is not done in every tick
//   memory_next     index in `remembered` for the next request
//   queued          number of entries in `queue`
//   replying        1 while the sender sends a reply from `queue`
//   prepared        bytes of the first part of the reply to queue[0], already in the sender's body; the rest
//                   follows in the next tick. 0: no part is prepared
//   tx_throttled    1: this tick has much other work, so large replies wait and few bytes are sent
//   refuse_busy     1: the request with busy_type and busy_sequence must be refused as BUSY
//   extras          0: telemetry, unlock, raw drive and actions are all inactive, and the tick skips them
//   telemetry_ms    period of telemetry, 0: no telemetry. telemetry_left_ms: time left of the period
//   telemetry_selection  KZ_TELEMETRY_* frames to send in every period. telemetry_due: frames of the
//                   present period that are still to be sent
//   telemetry_sequence  number of the next telemetry frame
//   telemetry_dropped   number of telemetry frames that were dropped because the line was too slow
//   unlocked_ms     time left of the bench unlock
//   raw_ms          time left of the raw drive of raw_joint at raw_duty. raw_begun: 1 once the drive runs
//   action          pending KZ_ACTION_*. acting: 1 if the previous tick requested the action
//   new_address, new_shared_line  values that KZ_ACTION_STORE_ADDRESS stores
#define KZ_SERVO_FIELDS(FIELD)   \
  FIELD(u32, tick)               \
  FIELD(u32, enabled)            \
  FIELD(u32, fresh_targets)      \
  FIELD(u32, shutdown_tick)      \
  FIELD(u16, silent_ms)          \
  FIELD(u16, watchdog_ms)        \
  FIELD(u16, supply_mv)          \
  FIELD(u16, supply_lowest_mv)   \
  FIELD(s16, temperature_dc)     \
  FIELD(u16, reference)          \
  FIELD(u16, image_crc)          \
  FIELD(u16, start_8states)      \
  FIELD(u16, missed_ticks)       \
  FIELD(u16, frames)             \
  FIELD(u16, repetitions)        \
  FIELD(u16, refusals)           \
  FIELD(u16, bad_check)          \
  FIELD(u16, bad_stuffing)       \
  FIELD(u16, too_short)          \
  FIELD(u16, too_long)           \
  FIELD(u16, line_errors)        \
  FIELD(u16, overruns)           \
  FIELD(u16, idle)               \
  FIELD(u16, telemetry_dropped)  \
  FIELD(u16, telemetry_ms)       \
  FIELD(u16, telemetry_left_ms)  \
  FIELD(u16, unlocked_ms)        \
  FIELD(u16, raw_ms)             \
  FIELD(s16, raw_duty)           \
  FIELD(u8, missed_tick)         \
  FIELD(u8, shutdown)            \
  FIELD(u8, shutdown_detail)     \
  FIELD(u8, reaction)            \
  FIELD(u8, holding)             \
  FIELD(u8, uncalibrated)        \
  FIELD(u8, supply_bad_ms)       \
  FIELD(u8, hot_ms)              \
  FIELD(u8, reference_bad_ms)    \
  FIELD(u8, reset_cause)         \
  FIELD(u8, tests_done)          \
  FIELD(u8, tests_failed)        \
  FIELD(u8, shared_line)         \
  FIELD(u8, address)             \
  FIELD(u8, calibration)         \
  FIELD(u8, memory_next)         \
  FIELD(u8, queued)              \
  FIELD(u8, replying)            \
  FIELD(u8, prepared)            \
  FIELD(u8, tx_throttled)        \
  FIELD(u8, refuse_busy)         \
  FIELD(u8, telemetry_selection) \
  FIELD(u8, telemetry_due)       \
  FIELD(u8, telemetry_sequence)  \
  FIELD(u8, raw_joint)           \
  FIELD(u8, raw_begun)           \
  FIELD(u8, action)              \
  FIELD(u8, acting)              \
  FIELD(u8, extras)              \
  FIELD(u8, new_address)         \
  FIELD(u8, new_shared_line)     \
  FIELD(u8, busy_type)           \
  FIELD(u8, busy_sequence)       \
  FIELD(u8, phase)

// Data of an executed or refused request. The board needs these data for the reply, and to recognize a
// repetition of the request.
//
//   parameter         joint, or mask of joints, that the reply reports
//   crc               CRC of the whole body, which distinguishes a repetition from another request
//                     with the same sequence number
//   reason, detail    reason and detail of the refusal. Reason 0: the request was executed. Reason
//                     KZ_PENDING (handlers.h): the request waits for an action
#define KZ_ANSWER_FIELDS(FIELD) \
  FIELD(u32, parameter)         \
  FIELD(u16, crc)               \
  FIELD(u8, type)               \
  FIELD(u8, sequence)           \
  FIELD(u8, reason)             \
  FIELD(u8, detail)             \
  FIELD(u16, spare)

// Size of the queue. Requests other than `stop` use at most KZ_REQUESTS_UNDER_WAY entries. One more entry is
// kept for a `stop`.
#define KZ_QUEUE (KZ_REQUESTS_UNDER_WAY + 1)

#define KZ_DECLARE_FIELD(type, name) type name;

typedef struct kz_joint {
  KZ_JOINT_FIELDS(KZ_DECLARE_FIELD)
} kz_joint;

typedef struct kz_answer {
  KZ_ANSWER_FIELDS(KZ_DECLARE_FIELD)
} kz_answer;

typedef struct kz_servo {
  kz_answer remembered[KZ_REQUESTS_REMEMBERED];  // latest requests, as a ring buffer
  kz_answer queue[KZ_QUEUE];                     // requests without a reply yet, oldest first
  KZ_SERVO_FIELDS(KZ_DECLARE_FIELD)
  kz_joint joint[KZ_JOINTS];
  kz_receiver receiver;
  kz_sender sender;
} kz_servo;

// Return &servo->joint[number] without a 32-bit multiplication, which the H8 does not have.
static inline kz_joint* kz_joint_at(kz_servo* servo, u8 number) {
  return (kz_joint*)((u8*)servo->joint + (u16)((u16)number * (u16)sizeof(kz_joint)));
}
static inline const kz_joint* kz_joint_of(const kz_servo* servo, u8 number) {
  return (const kz_joint*)((const u8*)servo->joint + (u16)((u16)number * (u16)sizeof(kz_joint)));
}

// Increments a counter that saturates at 65535.
static inline void kz_count(u16* counter) {
  if (*counter < 0xFFFF) ++*counter;
}

#ifdef __cplusplus
}
#endif

#endif
