// One millisecond of the joints: measuring, ramps, position loop, soft limits.
// SPDX-License-Identifier: Apache-2.0
//
//   drive = kp e - kd rate + friction sign(e),  e = command - angle, 0 inside the dead band
//
// Whatever asks for it, a joint is held back before a soft limit: the speed at which it may approach
// falls with the way that is left,
//
//   speed allowed = way / T,  T = 64 ms; on the last 0.1 rad 32 ms
//
// and what is faster is braked with up to full drive. At and beyond a limit there is no drive further
// out. T is so long that full reverse drive at 10 V stops what a joint of Kaz carries: to slow down
// along that line takes speed / T. Of all joints the hips carry most, 0.02 kg m2 (the leg stretched);
// at 12 rad/s that is 3.8 Nm, and reverse drive and back-EMF give 4.4.
//
// All this is only done for a joint that is `constrained`: dead band and friction for one that has such,
// the limits for one that may be near to them. The latter is looked after every 4 ms (protection.c):
// a joint is not near when both limits are further away than it can get in that time at any speed that
// the limit allows.
#ifndef KAZ_SHARED_SERVO_JOINT_LOOP_H
#define KAZ_SHARED_SERVO_JOINT_LOOP_H

#include "shared/servo/joint_drive.h"
#include "shared/servo/servo.h"

#ifdef __cplusplus
extern "C" {
#endif

// Fastest change of angle in a tick that is believed: 51 rad/s, four times what the motor can.
// Keeps the filtered rate inside 16 bits: 64 * 511 = 32704.
#define KZ_DELTA_MAX 511
// Why a joint is constrained.
#define KZ_CONSTRAINED_NEAR_LIMIT 1
#define KZ_CONSTRAINED_BY_FRICTION 2  // it has a dead band or friction

// A joint whose ways to both limits are longer than its rate and this need not be looked at for 4 ms:
// the rate allowed is the way and 1000; in 4 ms it gets 620 nearer (15.5 rad/s, free at 12 V), and
// full drive raises the filtered rate by 41 % of a step to full speed, 3,420.
#define KZ_FAR_FROM_LIMIT 3100

// One millisecond of all joints: angles and rates from the A/D codes; for those that are on also
// the ramp, the duty and the direction. Returns 0, or a reason to switch all motors off: its
// KZ_SHUTDOWN_* in the upper byte and the joint in the lower.
u16 kz_joint_loop(kz_joint* joint, const u16* analog);

static inline u16 kz_joints_update(kz_servo* servo, const kz_tick_input* input) {
  return kz_joint_loop(servo->joint, input->analog);
}

#ifdef __cplusplus
}
#endif

#endif
