// One millisecond of the joints: measuring, ramps, position loop, soft limits.
// SPDX-License-Identifier: Apache-2.0
//
//   drive = kp e - kd rate + friction sign(e),  e = command - angle, 0 inside the dead band
//
// Soft limits bound the speed at which a joint may approach them, by the remaining distance,
//
//   max speed = distance / T,  T = 64 ms; 32 ms within 0.1 rad of the limit
//
// whatever drive the position loop computes. A faster joint is braked with up to full drive. At and
// beyond a limit there is no drive further out. T is long enough for full reverse drive at 10 V to stop
// the load of any joint of Kaz: the deceleration along that line is speed / T. The hips carry the
// largest inertia, 0.02 kg m2 (leg stretched); at 12 rad/s that takes 3.8 Nm, and reverse drive and
// back-EMF give 4.4 Nm.
//
// To save time, only a joint that is `constrained` gets all this: by friction, if it has a dead band or
// friction; near a limit, if it may reach one. The latter is decided every 4 ms (protection.c): a joint
// is not near when both limits are further away than it can move in that time at any speed that the
// limits allow.
#ifndef KAZ_SHARED_SERVO_JOINT_LOOP_H
#define KAZ_SHARED_SERVO_JOINT_LOOP_H

#include "shared/servo/joint_drive.h"
#include "shared/servo/servo.h"

#ifdef __cplusplus
extern "C" {
#endif

// Max change of angle in a tick, larger ones are clamped: 51 rad/s, four times the motor's no-load speed.
// Keeps the filtered rate inside 16 bits: 64 * 511 = 32704.
#define KZ_DELTA_MAX 511
// Why a joint is constrained.
#define KZ_CONSTRAINED_NEAR_LIMIT 1
#define KZ_CONSTRAINED_BY_FRICTION 2  // it has a dead band or friction

// A joint further from both limits than its rate plus this cannot reach the braking region within 4 ms:
// the rate allowed is the distance plus 1000; in 4 ms it gets 620 nearer (15.5 rad/s, no-load speed at
// 12 V), and full drive raises the filtered rate by 41 % of a step to full speed, 3,420.
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
