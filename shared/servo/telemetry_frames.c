// Frames of telemetry.
// SPDX-License-Identifier: Apache-2.0
#include "shared/servo/telemetry_frames.h"

#include "shared/protocol/bytes.h"
#include "shared/servo/joint_replies.h"
#include "shared/servo/joints.h"
#include "shared/servo/replies.h"

static u8* put_commands(const kz_servo* servo, u8* to) {
  const kz_joint* joint = servo->joint;
  u8 left;
  to = kz_put_head(servo, to);
  for (left = KZ_JOINTS; left != 0; --left) {
    to = kz_put_s16(to, joint->on ? joint->command : joint->angle);
    ++joint;
  }
  return to;
}

static u8* put_drives(const kz_servo* servo, u8* to) {
  const kz_joint* joint = servo->joint;
  u8 left;
  to = kz_put_head(servo, to);
  for (left = KZ_JOINTS; left != 0; --left) {
    to = kz_put_s16(to, kz_joint_drive(joint));
    ++joint;
  }
  return to;
}

static u8* put_health(const kz_servo* servo, const kz_tick_input* input, u8* to) {
  to = kz_put_head(servo, to);
  to = kz_put_u8(to, servo->shutdown_detail);
  to = kz_put_u16(to, servo->supply_mv);
  to = kz_put_s16(to, servo->temperature_dc);
  to = kz_put_u16(to, input->busy_8states);
  return kz_put_u16(to, input->worst_8states);
}

void kz_telemetry_send(kz_servo* servo, const kz_tick_input* input) {
  u8* const fields = servo->sender.body + KZ_HEADER_SIZE;
  const u8 due = servo->telemetry_due;
  const u8 next = (u8)(due & (u8)-due);  // the lowest bit
  u8 type;
  u8* end;
  servo->telemetry_due = (u8)(due & (u8)~next);
  switch (next) {
    case KZ_TELEMETRY_STATE:
      type = KZ_TYPE_telemetry_state;
      end = kz_put_state(servo, fields);
      break;
    case KZ_TELEMETRY_COMMANDS:
      type = KZ_TYPE_telemetry_commands;
      end = put_commands(servo, fields);
      break;
    case KZ_TELEMETRY_DRIVES:
      type = KZ_TYPE_telemetry_drives;
      end = put_drives(servo, fields);
      break;
    default:
      type = KZ_TYPE_telemetry_health;
      end = put_health(servo, input, fields);
      break;
  }
  kz_send(servo, type, servo->telemetry_sequence, (u8)(end - fields));
  ++servo->telemetry_sequence;
}
