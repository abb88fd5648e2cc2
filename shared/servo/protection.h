// Protection of the motors: load, stall, and heat by the model I2t, each joint every 16 ms.
// SPDX-License-Identifier: Apache-2.0
//
// Load. A motor's torque, and with it its current, is that of its voltage less that of its back-EMF
// (shared/robot/kaz/motor.xml):
//
//   torque = slope V duty - back_emf speed,  slope = 0.2288 Nm/V,  back_emf = 0.1764 Nm s/rad
//
// so the load, as a share of the stall torque at 10 V (slope * 10 V = 2.288 Nm), is
//
//   load = (V / 10 V) duty - speed / (12.97 rad/s)
//
// kept as a number of 255 for a whole. It needs no current sensor: supply, duty and speed are known.
//
// Heat. A winding takes up I^2 R and gives off what it has with one time constant:
//
//   heat += load^2 - heat / 8192  every 16 ms: a time constant of 131 s
//
// Resistance and torque constant follow from the motor line: 3.4 ohm, 30 W at full stall at 10 V. A
// winding and rotor of this size take up about 5 J/K, and may be 80 K above the air: some 13 s of full
// stall from cold. The time constant is taken as that of the winding to the case, two minutes. The
// steady load that leads to those 80 K is then 0.35 of full stall, 0.8 Nm, a little less than the
// torque for which the servo was sold (0.97 Nm for short times). None of it was measured on a motor:
// the three constants below are where to put what a bench finds.
//
// Stall. More than 0.7 of full stall for 1 s, while the joint does not move 0.03 rad: nothing that the
// robot does takes that, and the heat of it leaves no time for anything else. Below 7 V a motor does
// not get there, and heat alone counts.
#ifndef KAZ_SHARED_SERVO_PROTECTION_H
#define KAZ_SHARED_SERVO_PROTECTION_H

#include "shared/servo/servo.h"

#ifdef __cplusplus
extern "C" {
#endif

#define KZ_PROTECTION_MS 16  // each joint's turn comes in so many ticks
#define KZ_STALL_LOAD 178    // 1/255 of the stall torque at 10 V
#define KZ_STALL_WAY 300     // 100 urad
#define KZ_STALL_COUNT (1000 / KZ_PROTECTION_MS)
#define KZ_STALL_TOLD 6  // so many: reported as KZ_JOINT_STALLED
#define KZ_HEAT_LOAD 89  // 1/255: the load that a motor stands for ever
// Upper half of the heat at which motors go off: 89^2 * 8192 / 65536.
#define KZ_HEAT_FULL ((u16)(KZ_HEAT_LOAD * KZ_HEAT_LOAD / 8))

// After the joints and a raw drive: those whose turn it is. Returns 0, or a reason to switch all
// motors off as kz_joints_update does. Also tells, every 4 ms, which joints are near a soft limit
// (joint_loop.h).
u16 kz_protection_update(kz_servo* servo);

#ifdef __cplusplus
}
#endif

#endif
