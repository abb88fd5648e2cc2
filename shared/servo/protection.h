// Motor protection: updates load, stall and heat (I2t model) of each joint every 16 ms.
// SPDX-License-Identifier: Apache-2.0
//
// Load. A motor's torque is proportional to its current. The torque follows from voltage and back-EMF
// (shared/robot/kaz/motor.xml):
//
//   torque = slope V duty - back_emf speed,  slope = 0.2288 Nm/V,  back_emf = 0.1764 Nm s/rad
//
// The load is the fraction of the stall torque at 10 V (slope * 10 V = 2.288 Nm), in units of 1/255:
//
//   load = (V / 10 V) duty - speed / (12.97 rad/s)
//
// Because supply, duty and speed are known, the board needs no current sensor.
//
// Heat. The I2t model: the winding absorbs the power I^2 R and cools with one time constant.
//
//   heat += load^2 - heat / 8192  every 16 ms: a time constant of 131 s
//
// According to the torque formula above, the winding has a resistance of 3.4 ohm. At full stall at 10 V, the
// winding thus absorbs 30 W. A winding and rotor of this size have a heat capacity of about 5 J/K. The
// winding can be 80 K warmer than the ambient air without damage. At full stall, a cold motor becomes 80 K
// warmer within about 13 s. The time constant from winding to case is assumed to be two minutes. With this
// time constant, a steady load of 0.35 of full stall (0.8 Nm) makes the winding 80 K warmer. The servo's
// rated short-time torque is 0.97 Nm. All of these values are estimates. Replace the constants below once the
// bench has measured a motor.
//
// Stall. The motors are switched off if a load of 0.7 of full stall lasts 1 s while the joint moves less than
// 0.03 rad. No motion of the robot needs such a load at standstill for 1 s. If a motor stayed on at this
// load, the motor would overheat. With a supply below 7 V, the load at standstill stays below 0.7 of full
// stall, so only the heat model protects the motor.
#ifndef KAZ_SHARED_SERVO_PROTECTION_H
#define KAZ_SHARED_SERVO_PROTECTION_H

#include "shared/servo/servo.h"

#ifdef __cplusplus
extern "C" {
#endif

#define KZ_PROTECTION_MS 16  // period for each joint, ticks
#define KZ_STALL_LOAD 178    // in units of 1/255 of the stall torque at 10 V
#define KZ_STALL_ANGLE 300   // unit 100 urad; a joint that moves less counts as standing still
#define KZ_STALL_COUNT (1000 / KZ_PROTECTION_MS)
#define KZ_STALL_REPORTED 6  // KZ_JOINT_STALLED is set if `stalled` has at least this value
#define KZ_HEAT_LOAD 89      // continuous load that a motor withstands, in units of 1/255
// The motors are switched off at the heat KZ_HEAT_LOAD^2 * 8192. KZ_HEAT_FULL is the upper 16 bits of this
// 32-bit number.
#define KZ_HEAT_FULL ((u16)(KZ_HEAT_LOAD * KZ_HEAT_LOAD / 8))

// Updates load, stall and heat of the joints that are due in this tick. Every 4 ms, also updates the flag in
// `constrained` that marks a joint near a soft limit (joint_loop.h). Returns 0 or a shutdown request in the
// format of kz_joint_loop. Call kz_protection_update in every tick, after kz_joints_update and
// kz_bench_drive.
u16 kz_protection_update(kz_servo* servo);

#ifdef __cplusplus
}
#endif

#endif
