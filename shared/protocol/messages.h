// Messages of the wire protocol as C structs, with functions that pack and unpack the messages. Generated
// from messages.def. The protocol is specified in docs/reference/protocol.md.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_PROTOCOL_MESSAGES_H
#define KAZ_SHARED_PROTOCOL_MESSAGES_H

#include "shared/base/types.h"
#include "shared/board/board.h"
#include "shared/protocol/frame.h"

#ifdef __cplusplus
extern "C" {
#endif

#define KZ_PROTOCOL_VERSION 3
// Oldest protocol version that hosts accept. Versions 2 and 3 have the same messages. The versions differ in
// the handling of a repeated `stop`: version 3 executes it again, version 2 does not.
#define KZ_PROTOCOL_VERSION_OLDEST 2
#define KZ_REPLY 0x80         // this bit of the type is set in messages from board to host
#define KZ_ADDRESS_DEFAULT 1  // address of a board that has no stored address
#define KZ_ADDRESS_LAST 14
#define KZ_ADDRESS_ALL 15
#define KZ_KEY 0x4B5A  // "KZ": key of requests that must not be executed by accident
#define KZ_ALL_JOINTS 0x3FFFF

// Maximum number of outstanding requests. The board answers one request while another request waits.
#define KZ_REQUESTS_UNDER_WAY 2
// Number of latest requests that the board remembers to recognize repetitions.
#define KZ_REQUESTS_REMEMBERED 4

// Status word: flags in the lower byte, the latched KZ_SHUTDOWN_* reason in the upper byte.
#define KZ_STATUS_ENABLED 0x0001    // at least one motor is on
#define KZ_STATUS_MOVING 0x0002     // at least one ramp is running
#define KZ_STATUS_HOLDING 0x0004    // the link watchdog holds the joints at their commands
#define KZ_STATUS_UNLOCKED 0x0008   // the bench unlock is active
#define KZ_STATUS_RAW_DRIVE 0x0010  // a raw drive runs: a motor is driven without the position loop
#define KZ_STATUS_TELEMETRY 0x0020  // telemetry is on
#define KZ_STATUS_UNCALIBRATED 0x0040  // nominal calibration: no valid copy in flash
#define KZ_STATUS_MISSED_TICK 0x0080   // a tick took too long; latched until `clear`

// Reasons of a shutdown. The board latches the first reason. Until a request `clear` is executed, the board
// latches no other reason. A shutdown switches the motors off, with one exception: they stay on if the reason
// is LINK_LOST and the status has HOLDING.
#define KZ_SHUTDOWN_NONE 0
#define KZ_SHUTDOWN_STOP 1          // the host's emergency stop
#define KZ_SHUTDOWN_LINK_LOST 2     // timeout of the link watchdog
#define KZ_SHUTDOWN_POT 3           // potentiometer open or shorted; detail: joint
#define KZ_SHUTDOWN_UNDERVOLTAGE 4  // supply too low
#define KZ_SHUTDOWN_OVERVOLTAGE 5   // supply too high
#define KZ_SHUTDOWN_TEMPERATURE 6   // motor drivers too hot
#define KZ_SHUTDOWN_REFERENCE 7     // the A/D converter misreads the reference voltage
#define KZ_SHUTDOWN_STALL 8         // high load at standstill; detail: joint
#define KZ_SHUTDOWN_OVERLOAD 9      // too hot according to the I2t model; detail: joint
#define KZ_SHUTDOWN_SELF_TEST 10    // a test at start failed; only a reset clears this reason

// Reactions of the link watchdog.
#define KZ_REACTION_LIMP 1  // motors off
#define KZ_REACTION_HOLD 2  // motors stay on, ramps end at the present commands

// Joint flags.
#define KZ_JOINT_ON 0x01
#define KZ_JOINT_MOVING 0x02    // the joint's ramp is running or about to start
#define KZ_JOINT_POT 0x04       // the joint's potentiometer is out of range
#define KZ_JOINT_STALLED 0x08   // at standstill under high load now
#define KZ_JOINT_HOT 0x10       // heat is above half of the switch-off threshold
#define KZ_JOINT_AT_LIMIT 0x20  // at or beyond a soft limit; outward drive is cut

// Capabilities in `identify_reply`.
#define KZ_CAPABILITY_TELEMETRY 0x0001    // telemetry is possible; not set if boards share a line
#define KZ_CAPABILITY_CALIBRATION 0x0002  // calibration can be stored
#define KZ_CAPABILITY_RAW_DRIVE 0x0004
#define KZ_CAPABILITY_LOADER 0x0008

// Selection of telemetry.
#define KZ_TELEMETRY_STATE 0x01     // telemetry_state
#define KZ_TELEMETRY_COMMANDS 0x02  // telemetry_commands
#define KZ_TELEMETRY_DRIVES 0x04    // telemetry_drives
#define KZ_TELEMETRY_HEALTH 0x08    // telemetry_health
#define KZ_TELEMETRY_PERIOD_MIN_MS 5

// Tests at start.
#define KZ_TEST_RAM 0x01
#define KZ_TEST_FLASH 0x02      // CRC of the application
#define KZ_TEST_CONVERTER 0x04  // A/D converter; the test input is half of the reference voltage
#define KZ_TEST_SUPPLY 0x08     // motor supply; this test never fails, even without motor supply

// Source of the calibration.
#define KZ_CALIBRATION_NOMINAL 0  // no valid copy in flash
#define KZ_CALIBRATION_A 1        // block A of flash
#define KZ_CALIBRATION_B 2        // block B of flash

// Upper bounds of settings.
#define KZ_KP_MAX 20480           // 80 /rad
#define KZ_KD_MAX 4096            // 1 s/rad
#define KZ_DEAD_BAND_MAX 1000     // 0.1 rad
#define KZ_FRICTION_MAX 64        // a quarter of full duty
#define KZ_RAMP_MAX 120           // 12 rad/s, near the motors' no-load speed
#define KZ_CENTRE_TOLERANCE 5000  // 0.5 rad around the nominal value

// Gains after a reset. With these gains, no joint oscillates across its gear backlash at any load
// (docs/howto/bench.md, step.hunting). The host's behaviors replace these gains
// (host/behavior/control_cycle.cpp). One unit of kp is 1/256 per rad, and one unit of kd is 1/4096 s/rad.
#define KZ_KP_DEFAULT 4096  // kp of 16 per rad
#define KZ_KP_HAND 205      // kp of 0.8 per rad for the hands, so that their jaws stay compliant
#define KZ_KD_DEFAULT 369   // kd of 0.09 s/rad

#define KZ_JOINTS_PER_REPLY 9  // maximum number of joints in a `joints_reply`

// Value of `detail` if the reason concerns neither a joint nor a field.
#define KZ_NO_DETAIL 255

// Reasons of a refusal.
#define KZ_REFUSED_UNKNOWN_TYPE 1  // no request has this type
#define KZ_REFUSED_LENGTH 2        // size of the fields does not match the type
#define KZ_REFUSED_RANGE 3         // value out of range; detail: index of the field, or joint
#define KZ_REFUSED_LIMIT 4         // target outside the joint's soft limits; detail: joint
#define KZ_REFUSED_DISABLED 5      // target for a joint that is off; detail: joint
#define KZ_REFUSED_FAULT 6         // a shutdown is latched or a fault is present; detail: reason
#define KZ_REFUSED_BUSY 7          // too many outstanding requests, or an action is pending
#define KZ_REFUSED_ARMED 8         // only allowed while all motors are off
#define KZ_REFUSED_LOCKED 9        // only allowed while the bench unlock is active
#define KZ_REFUSED_SHARED_LINE 10  // not allowed on a line with other boards
#define KZ_REFUSED_STORE 11        // writing flash failed

// Kinds of messages (messages.def). If a code does not belong to a message, kz_kind_of returns KZ_KIND_NONE.
enum kz_kind {
  KZ_KIND_NONE,
  KZ_KIND_QUERY,
  KZ_KIND_JOINT_QUERY,
  KZ_KIND_COMMAND,
  KZ_KIND_BULK_COMMAND,
  KZ_KIND_FLASH_COMMAND,
  KZ_KIND_RESTART_COMMAND,
  KZ_KIND_REPLY,
  KZ_KIND_LARGE_REPLY,
  KZ_KIND_SPLIT_REPLY,
  KZ_KIND_ACKNOWLEDGEMENT,
  KZ_KIND_REFUSAL,
  KZ_KIND_TELEMETRY
};

// KZ_TYPE_<name>: code of each message.
enum kz_type {
#define KZ_MESSAGE(name, code, kind, text) KZ_TYPE_##name = code,
#include "shared/protocol/messages.def"
};

// KZ_SIZE_<name>: maximum size of the fields, bytes.
enum kz_size {
#define KZ_MESSAGE(name, code, kind, text) KZ_SIZE_##name = 0
#define KZ_FIELD(type, name, unit, text) +(int)sizeof(type)
#define KZ_ARRAY(type, name, count, unit, text) +(count) * (int)sizeof(type)
#define KZ_MASKED(type, name, mask, most, unit, text) +(most) * (int)sizeof(type)
#define KZ_END() ,
#include "shared/protocol/messages.def"
};

// struct kz_<name>: the fields of each message. A message without fields has a dummy member, always 0.
#define KZ_MESSAGE(name, code, kind, text) \
  typedef struct kz_##name kz_##name;      \
  struct kz_##name {
#define KZ_FIELD(type, name, unit, text) type name;
#define KZ_ARRAY(type, name, count, unit, text) type name[count];
#define KZ_MASKED(type, name, mask, most, unit, text) type name[KZ_JOINTS];
#define KZ_NO_FIELDS() u8 no_fields;
#define KZ_END() \
  }              \
  ;
#include "shared/protocol/messages.def"

// kz_pack_<name> writes the fields, which follow the header. Returns the size of the fields, at most
// KZ_SIZE_<name>.
//
// kz_unpack_<name> reads the fields. Returns 1, or 0 if `length` is wrong for the message.
//
// A field with a mask contains one number for each set bit of the mask. In messages.def, `most` is the
// maximum count of these numbers. If the mask has more set bits than `most`, the field contains numbers only
// for the lowest set bits. Mask bits above the highest joint have no number. Unpacking sets the numbers of
// joints that are not in the mask to 0.
//
// kz_check_<name> returns the index of the first field that is out of bounds, or KZ_IN_BOUNDS.
#define KZ_IN_BOUNDS 255
#define KZ_MESSAGE(name, code, kind, text)                                     \
  u8 kz_pack_##name(const struct kz_##name* message, u8* fields);              \
  u8 kz_unpack_##name(struct kz_##name* message, const u8* fields, u8 length); \
  u8 kz_check_##name(const struct kz_##name* message);
#include "shared/protocol/messages.def"

#ifdef __cplusplus
}
#endif

#endif
