// Joint functions outside the control loop (joint_loop.h): initialization, enable, ramp start, gain scaling.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_SERVO_JOINTS_H
#define KAZ_SHARED_SERVO_JOINTS_H

#include "shared/servo/servo.h"

#ifdef __cplusplus
extern "C" {
#endif

// Sets gains, ramp and limits to their default values. Copies the calibration from `startup`. `servo` must be
// all zeros.
void kz_joints_init(kz_servo* servo, const kz_startup* startup);

// Switches the joints of the mask on and all others off. A joint that was off holds its present angle.
// Ends a raw drive.
void kz_joints_enable(kz_servo* servo, u32 mask);

// Starts the ramps of the joints in fresh_targets, with `target` and `target_ms` of each joint. Each call
// starts at most six ramps, so all ramps start within three ticks. The handler of the request starts no
// ramps, so that the tick of the request does not take too long. fresh_targets must not be 0.
void kz_joints_start_ramps(kz_servo* servo);

// Ends all ramps at the present commands.
void kz_joints_hold(kz_servo* servo);

// Returns the motor drive, -255..255 counts. Positive drive increases the joint angle.
s16 kz_joint_drive(const kz_joint* joint);
// Returns the torque in units of 1/255 of the stall torque at 10 V, saturated at 255 (protection.h).
u8 kz_joint_load(const kz_joint* joint);

// Drives a motor with the drive value `drive`, -255..255. The joint must be off. Soft limits apply as in the
// loop. Call kz_joint_drive_raw after kz_joints_update.
void kz_joint_drive_raw(kz_joint* joint, s16 drive);

// Convert `kp` and `kd` from the units of the message `gains` to the units of the loop.
s16 kz_scaled_kp(u16 kp);
s16 kz_scaled_kd(u16 kd);
// Convert from the units of the loop to the units of the message `gains`, rounded to the nearest value. The
// conversion is reversible: kz_scaled_kp and kz_scaled_kd convert the result back to `scaled`.
u16 kz_unscaled_kp(s16 scaled);
u16 kz_unscaled_kd(s16 scaled);

// Returns the number of bits set in the mask.
u8 kz_count_joints(u32 mask);

#ifdef __cplusplus
}
#endif

#endif
