// From a request's type and bytes to what it does.
// SPDX-License-Identifier: Apache-2.0
#include "shared/servo/commands.h"

#include "shared/servo/replies.h"

u8 kz_count_joints(u32 mask) {
  // In two halves: the H8 does 16 bits at once.
  u16 bits = (u16)mask;
  u8 count = 0;
  for (; bits != 0; bits = (u16)(bits & (u16)(bits - 1))) ++count;
  for (bits = (u16)(mask >> 16); bits != 0; bits = (u16)(bits & (u16)(bits - 1))) ++count;
  return count;
}

// Takes the fields apart into `request`, and checks them against their bounds.
#define TAKE(name)                                        \
  if (!kz_unpack_##name(&request.name, fields, length)) { \
    return KZ_REFUSE(KZ_REFUSED_LENGTH, KZ_NO_DETAIL);    \
  }                                                       \
  wrong = kz_check_##name(&request.name);                 \
  if (wrong != KZ_IN_BOUNDS) return KZ_REFUSE(KZ_REFUSED_RANGE, wrong);

#define TAKE_NOTHING() \
  if (length != 0) return KZ_REFUSE(KZ_REFUSED_LENGTH, KZ_NO_DETAIL);

kz_outcome kz_command(kz_servo* servo, u8 type, const u8* fields, u8 length, u32* parameter) {
  union {
    kz_enable enable;
    kz_gains gains;
    kz_limits limits;
    kz_heartbeat heartbeat;
    kz_read_targets read_targets;
    kz_joints joints;
    kz_settings settings;
    kz_telemetry telemetry;
    kz_unlock unlock;
    kz_raw_drive raw_drive;
    kz_set_address set_address;
    kz_reset reset;
    kz_loader loader;
  } request;
  u8 wrong;
  switch (type) {
    case KZ_TYPE_identify:
    case KZ_TYPE_health:
    case KZ_TYPE_statistics:
    case KZ_TYPE_self_test:
    case KZ_TYPE_state:
    case KZ_TYPE_calibration:
    case KZ_TYPE_inertial:
      TAKE_NOTHING()
      return KZ_DONE;
    case KZ_TYPE_read_targets:
      TAKE(read_targets)
      *parameter = request.read_targets.mask;
      return KZ_DONE;
    case KZ_TYPE_joints:
      TAKE(joints)
      if (kz_count_joints(request.joints.mask) > KZ_JOINTS_REPLY_MOST) {
        return KZ_REFUSE(KZ_REFUSED_RANGE, 0);
      }
      *parameter = request.joints.mask;
      return KZ_DONE;
    case KZ_TYPE_settings:
      TAKE(settings)
      *parameter = request.settings.joint;
      return KZ_DONE;
    case KZ_TYPE_stop:
      TAKE_NOTHING()
      return kz_do_stop(servo);
    case KZ_TYPE_clear:
      TAKE_NOTHING()
      return kz_do_clear(servo);
    case KZ_TYPE_enable:
      TAKE(enable)
      return kz_do_enable(servo, request.enable.mask);
    case KZ_TYPE_targets:
      return kz_do_targets(servo, fields, length);
    case KZ_TYPE_gains:
      TAKE(gains)
      return kz_do_gains(servo, &request.gains);
    case KZ_TYPE_limits:
      TAKE(limits)
      return kz_do_limits(servo, &request.limits);
    case KZ_TYPE_heartbeat:
      TAKE(heartbeat)
      return kz_do_heartbeat(servo, &request.heartbeat);
    case KZ_TYPE_telemetry:
      TAKE(telemetry)
      return kz_do_telemetry(servo, &request.telemetry);
    case KZ_TYPE_calibrate:
      return kz_do_calibrate(servo, fields, length);
    case KZ_TYPE_store_calibration:
      TAKE_NOTHING()
      return kz_do_store_calibration(servo);
    case KZ_TYPE_unlock:
      TAKE(unlock)
      return kz_do_unlock(servo, &request.unlock);
    case KZ_TYPE_raw_drive:
      TAKE(raw_drive)
      return kz_do_raw_drive(servo, &request.raw_drive);
    case KZ_TYPE_set_address:
      TAKE(set_address)
      return kz_do_set_address(servo, &request.set_address);
    case KZ_TYPE_reset:
      TAKE(reset)
      return kz_do_reset(servo);
    case KZ_TYPE_loader:
      TAKE(loader)
      return kz_do_loader(servo);
    default:
      return KZ_REFUSE(KZ_REFUSED_UNKNOWN_TYPE, KZ_NO_DETAIL);
  }
}
