// Status word of the board and flags of a joint, as replies report them.
// SPDX-License-Identifier: Apache-2.0
#include "shared/servo/status.h"

#include "shared/servo/protection.h"

u8 kz_joint_flags(const kz_joint* joint, u8 fresh) {
  u8 flags = 0;
  if (joint->on) {
    flags |= KZ_JOINT_ON;
    if (joint->ramp_left != 0 || fresh) flags |= KZ_JOINT_MOVING;
  }
  if (joint->pot_bad_ms != 0) flags |= KZ_JOINT_POT;
  if (joint->stalled >= KZ_STALL_REPORTED) flags |= KZ_JOINT_STALLED;
  if (joint->heat >> 16 > KZ_HEAT_FULL / 2) flags |= KZ_JOINT_HOT;
  if (joint->angle <= joint->lower || joint->angle >= joint->upper) flags |= KZ_JOINT_AT_LIMIT;
  return flags;
}

static u8 moving(const kz_servo* servo) {
  const kz_joint* joint = servo->joint;
  u8 left;
  if (servo->fresh_targets != 0) return 1;
  for (left = KZ_JOINTS; left != 0; --left) {
    if (joint->on && joint->ramp_left != 0) return 1;
    ++joint;
  }
  return 0;
}

u16 kz_status(const kz_servo* servo) {
  u16 status = (u16)((u16)((u16)servo->shutdown << 8) | servo->missed_tick | servo->holding |
                     servo->uncalibrated);
  if (servo->enabled != 0) {
    status |= KZ_STATUS_ENABLED;
    if (moving(servo)) status |= KZ_STATUS_MOVING;
  }
  if (servo->telemetry_ms != 0) status |= KZ_STATUS_TELEMETRY;
  if (servo->unlocked_ms != 0) status |= KZ_STATUS_UNLOCKED;
  if (servo->raw_ms != 0) status |= KZ_STATUS_ENABLED | KZ_STATUS_RAW_DRIVE;
  return status;
}
