// The joints of the servo: measuring, ramps, position loop.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_SERVO_JOINTS_H
#define KAZ_SHARED_SERVO_JOINTS_H

#include "shared/servo/servo.h"

#ifdef __cplusplus
extern "C" {
#endif

// Gains and ramp after reset; `servo` is all zeros before.
void kz_joints_init(kz_servo* servo);

// One millisecond of all joints: angles and rates from the A/D codes; for those that are on also
// the ramp, the duty and the direction. Returns 1 if a joint that is on has had a bad potentiometer
// for too long.
u8 kz_joints_update(kz_servo* servo, const kz_tick_input* input);

// Switches the joints of the mask on and all others off. One that was off holds where it stands.
void kz_joints_enable(kz_servo* servo, u32 mask);

// Straight way to `target` (100 urad) in `duration_ms`, or more slowly if the joint's ramp demands
// that; 0: as fast as the ramp allows.
void kz_joint_go(kz_joint* joint, s16 target, u16 duration_ms);

// `kp` and `kd` as in the message `gains`, scaled as the loop wants them.
s16 kz_scaled_kp(u16 kp);
s16 kz_scaled_kd(u16 kd);

#ifdef __cplusplus
}
#endif

#endif
