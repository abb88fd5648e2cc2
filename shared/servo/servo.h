// State of the servo tick, written by shared/servo alone; public for comparison (fields.h).
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

// Values after reset; gains are in protocol/messages.h.
#define KZ_RAMP_DEFAULT 60  // 100 urad/ms: 6 rad/s
#define KZ_WATCHDOG_DEFAULT_MS 90

// Protection.
#define KZ_POT_LOWEST 4      // below: short or open
#define KZ_POT_HIGHEST 1019  // above: open or short
#define KZ_POT_FAULT_MS 20
#define KZ_SUPPLY_LOWEST_MV 4000    // the servos' original supply is 4.8 V
#define KZ_SUPPLY_HIGHEST_MV 13000  // the motor drivers take 12 V
#define KZ_SUPPLY_FAULT_MS 20
#define KZ_TEMPERATURE_HIGHEST_DC 850  // 0.1 degC: the drivers switch off by themselves at 100 degC
#define KZ_TEMPERATURE_FAULT_MS 20
#define KZ_REFERENCE_CODE 512
#define KZ_REFERENCE_TOLERANCE 16  // codes around 512
#define KZ_REFERENCE_FAULT_MS 20

// No field needs padding before it on either machine (the H8 aligns everything to 2 bytes), so that
// the offsets are the same on both; a test holds the PC's layout against this.
//
//   pot_centre, pot_scale  calibration of the potentiometer (board/table.h)
//   angle       measured joint angle, 100 urad
//   rate        speed, 1/64 of 100 urad/ms, first-order filter with coefficient 1/8 a tick
//   target      where the ramp goes, 100 urad
//   command     angle that the loop controls to, 100 urad
//   ramp_*      straight ramp of `command` to the target: `left` of `time` ticks remain, each of them
//               adds `whole`, and also `extra` (+1 or -1) whenever `rest` has used up `room`, which
//               starts at `time` each time; sums modulo 2^16
//   ramp_limit  max change of `command` in a tick, for ramps that start from now on
//   lower, upper  soft limits, inside those of the mechanics, 100 urad
//   dead_band, friction  as in the message `gains`
//   target_ms   time for the ramp to `target` that has not started yet
//   kp, kd      gains, scaled to 1/2048 of a count of duty for half a unit of error, a unit of rate
//   friction_drive  `friction` in 1/256 of a count of duty
//   duty        high counts of the PWM, 0..255
//   forward     direction output
//   pot_bad_ms  for how long the potentiometer's code has been out of range
//   pot_input   index into kz_tick_input.analog
//   mirrored    a forward shaft is a negative joint angle
//   constrained KZ_CONSTRAINED_* (joint_loop.h)
//   on          bit of `enabled`
//   heat        I2t heat of the motor (protection.h)
//   stall_angle where it was when it began not to move under high load, 100 urad
//   load        torque as a share of the stall torque, 0..255
//   stalled     for how many times 4 ms it has not moved under high load
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

//   tick            number of the present tick
//   enabled         joints that are on, bit n: joint n
//   fresh_targets   joints whose ramp to `target` has not started yet
//   shutdown_tick   when `shutdown` was latched
//   image_crc, start_8states, reset_cause, tests_*, shared_line, address, calibration
//                   as found at start (kz_startup)
//   frames .. refusals       counters of `statistics_reply`
//   bad_check .. idle        damaged frames by cause, up to 65535
//   missed_tick, holding, uncalibrated  KZ_STATUS_MISSED_TICK and so on, or 0
//   shutdown        latched KZ_SHUTDOWN_* reason, shutdown_detail with it
//   reaction        KZ_REACTION_* of the link watchdog
//   silent_ms       since the last valid frame for this board
//   watchdog_ms     limit for it
//   supply_mv, supply_lowest_mv, temperature_dc, reference  as in `health_reply`
//   supply_bad_ms, hot_ms, reference_bad_ms  for how long that has been out of its range
//   phase           counts ticks, for what is not done in every one
//   memory_next     where in `remembered` the next request goes
//   queued          requests in `queue`
//   replying        1 while the sender sends the reply to a request that counts as under way
//   prepared        not 0: the first part of the reply to queue[0] is in the sender's body, so
//                   many bytes of fields; the rest follows in the next tick
//   tx_throttled    1: this tick is loaded: large replies wait for the next, few bytes are sent
//   refuse_busy     1: a request came that will be refused, its busy_type and busy_sequence
//   extras          not 0: something of the next four lines is active (else a tick skips them all)
//   telemetry_ms    period, 0: no telemetry; telemetry_left_ms of it are left
//   telemetry_selection, telemetry_due  KZ_TELEMETRY_*: of each period; to be sent in this one
//   telemetry_sequence  number of the next frame
//   telemetry_dropped   frames that the wire had no time for
//   unlocked_ms     time left of the bench unlock
//   raw_ms          time left of the raw drive of motor raw_joint at raw_duty; raw_begun: it runs
//   action          KZ_ACTION_* that a request wants; acting: requested in the previous tick
//   new_address, new_shared_line  what KZ_ACTION_STORE_ADDRESS is to store
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

// A request that was done or refused, as far as its reply and its repetitions need it.
//
//   parameter         what its reply is about: a mask of joints, or a joint
//   crc               of its whole body: distinguishes a repetition from another request with that number
//   reason, detail    of the refusal; reason 0: it was done
#define KZ_ANSWER_FIELDS(FIELD) \
  FIELD(u32, parameter)         \
  FIELD(u16, crc)               \
  FIELD(u8, type)               \
  FIELD(u8, sequence)           \
  FIELD(u8, reason)             \
  FIELD(u8, detail)             \
  FIELD(u16, spare)

// One more than may be under way: `stop` is taken even then.
#define KZ_QUEUE (KZ_REQUESTS_UNDER_WAY + 1)

#define KZ_DECLARE_FIELD(type, name) type name;

typedef struct kz_joint {
  KZ_JOINT_FIELDS(KZ_DECLARE_FIELD)
} kz_joint;

typedef struct kz_answer {
  KZ_ANSWER_FIELDS(KZ_DECLARE_FIELD)
} kz_answer;

typedef struct kz_servo {
  kz_answer remembered[KZ_REQUESTS_REMEMBERED];  // what was done last, a ring
  kz_answer queue[KZ_QUEUE];                     // to be answered, the oldest first
  KZ_SERVO_FIELDS(KZ_DECLARE_FIELD)
  kz_joint joint[KZ_JOINTS];
  kz_receiver receiver;
  kz_sender sender;
} kz_servo;

// servo->joint[number], without a multiplication of 32 bits, which the H8 does not have.
static inline kz_joint* kz_joint_at(kz_servo* servo, u8 number) {
  return (kz_joint*)((u8*)servo->joint + (u16)((u16)number * (u16)sizeof(kz_joint)));
}
static inline const kz_joint* kz_joint_of(const kz_servo* servo, u8 number) {
  return (const kz_joint*)((const u8*)servo->joint + (u16)((u16)number * (u16)sizeof(kz_joint)));
}

// A counter that stays at its highest value.
static inline void kz_count(u16* counter) {
  if (*counter < 0xFFFF) ++*counter;
}

#ifdef __cplusplus
}
#endif

#endif
