// Protection of the motors: load, stall, and heat by the model I2t, each joint every 16 ms.
// SPDX-License-Identifier: Apache-2.0
//
// Load. A motor's torque, and with it its current, is that of its voltage less that of its back-EMF
// (shared/robot/kaz/motor.xml):
//
//   torque = slope V duty - back_emf speed,  slope = 0.2288 Nm/V,  back_emf = 0.1764 Nm s/rad
//
// so the load, as a fraction of the stall torque at 10 V (slope * 10 V = 2.288 Nm), is
//
//   load = (V / 10 V) duty - speed / (12.97 rad/s)
//
// in units of 1/255. No current sensor is needed: supply, duty and speed are known.
//
// Heat. The I2t model of a winding: it absorbs I^2 R and cools with one time constant,
//
//   heat += load^2 - heat / 8192  every 16 ms: a time constant of 131 s
//
// Resistance and torque constant follow from the motor line: 3.4 ohm, 30 W at full stall at 10 V. A
// winding and rotor of this size have a heat capacity of about 5 J/K and may be 80 K above ambient: some
// 13 s of full stall from cold. The time constant assumed is that of winding to case, two minutes. The
// steady load that leads to those 80 K is then 0.35 of full stall, 0.8 Nm, a little less than the
// servo's rated torque (0.97 Nm for short times). These are estimates, not measurements of a motor:
// replace the three constants below by those that the bench measures.
//
// Stall. More than 0.7 of full stall for 1 s while the joint moves less than 0.03 rad: no motion of the
// robot needs that, and it heats the motor too fast to wait longer. Below 7 V a motor does not reach this
// load, and only the heat model acts.
#ifndef KAZ_SHARED_SERVO_PROTECTION_H
#define KAZ_SHARED_SERVO_PROTECTION_H

#include "shared/servo/servo.h"

#ifdef __cplusplus
extern "C" {
#endif

#define KZ_PROTECTION_MS 16  // period for each joint, ticks
#define KZ_STALL_LOAD 178    // 1/255 of the stall torque at 10 V
#define KZ_STALL_ANGLE 300   // 100 urad: a joint that moves less is standing still
#define KZ_STALL_COUNT (1000 / KZ_PROTECTION_MS)
#define KZ_STALL_REPORTED 6  // count from which KZ_JOINT_STALLED is set
#define KZ_HEAT_LOAD 89      // 1/255: the load that a motor withstands continuously
// Upper half of the heat at which motors are switched off: 89^2 * 8192 / 65536.
#define KZ_HEAT_FULL ((u16)(KZ_HEAT_LOAD * KZ_HEAT_LOAD / 8))

// Updates the joints whose period ends in this tick, after the joints' loop and a raw drive. Returns 0,
// or a reason to switch all motors off as kz_joints_update does. Also updates `constrained` of each joint
// every 4 ms: whether it is near a soft limit (joint_loop.h).
u16 kz_protection_update(kz_servo* servo);

#ifdef __cplusplus
}
#endif

#endif
