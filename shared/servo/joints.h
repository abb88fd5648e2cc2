// The joints of the servo: settings, switching on and off, starts of ramps (the loop: joint_loop.h).
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_SERVO_JOINTS_H
#define KAZ_SHARED_SERVO_JOINTS_H

#include "shared/servo/servo.h"

#ifdef __cplusplus
extern "C" {
#endif

// Gains and ramp after reset; `servo` is all zeros before.
void kz_joints_init(kz_servo* servo, const kz_startup* startup);

// Switches the joints of the mask on and all others off. One that was off holds its present angle.
// Ends a raw drive.
void kz_joints_enable(kz_servo* servo, u32 mask);

// Starts ramps to the targets that a request has left in the state (fresh_targets, each joint's target
// and target_ms), so that the tick that took the request has not to do this too: those of six joints,
// so all have started three ticks later.
void kz_joints_start_ramps(kz_servo* servo);

// Ends all ramps: the commands stay where they are.
void kz_joints_hold(kz_servo* servo);

// Motor drive -255..255, positive turns the joint positively.
s16 kz_joint_drive(const kz_joint* joint);
// Torque as a share of the stall torque, 0..255.
u8 kz_joint_load(const kz_joint* joint);

// Raw drive of a motor whose joint is off, -255..255, after kz_joints_update; held back before the
// soft limits like the loop.
void kz_joint_drive_raw(kz_joint* joint, s16 drive);

// `kp` and `kd` as in the message `gains`, scaled for the loop.
s16 kz_scaled_kp(u16 kp);
s16 kz_scaled_kd(u16 kd);
// And back, to the nearest: scaled once more it gives the same again.
u16 kz_unscaled_kp(s16 scaled);
u16 kz_unscaled_kd(s16 scaled);

// How many joints a mask has.
u8 kz_count_joints(u32 mask);

#ifdef __cplusplus
}
#endif

#endif
