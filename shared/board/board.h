// Servo board: numbers that follow from how the board is built. The wiring itself is joints.def.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_BOARD_BOARD_H
#define KAZ_SHARED_BOARD_BOARD_H

#include "shared/base/types.h"

#define KZ_JOINTS 18

// Crystal, Hz. One CPU state is one period. 115,200 baud and 1 ms come out exact.
#define KZ_CLOCK_HZ 18432000L
#define KZ_TICK_HZ 1000
#define KZ_STATES_PER_TICK 18432L
#define KZ_BAUD 115200L
#define KZ_STATES_PER_BIT 160    // KZ_CLOCK_HZ / KZ_BAUD
#define KZ_STATES_PER_BYTE 1600  // 8N1

// Index into kz_tick_input.analog: multiplexer * 8 + input.
#define KZ_MUXES 3
#define KZ_MUX_INPUTS 8
#define KZ_ANALOG (KZ_MUXES * KZ_MUX_INPUTS)
// Supply voltage through a divider: full scale is KZ_SUPPLY_FULL_MV.
#define KZ_ANALOG_SUPPLY 6
// Half of AVCC: code 512 if the converter is healthy.
#define KZ_ANALOG_REFERENCE 7
// Motor drivers: 0 °C at code 0, KZ_TEMPERATURE_FULL_DC at full scale.
#define KZ_ANALOG_TEMPERATURE 14
// The inertial option on AN3..AN5, which are grounded where it is not fitted: half of AVCC stands
// for zero. These places are of multiplexer inputs to which nothing is connected.
#define KZ_ANALOG_YAW_RATE 15
#define KZ_ANALOG_FORWARD_FORCE 22
#define KZ_ANALOG_LEFT_FORCE 23
#define KZ_SUPPLY_FULL_MV 15360      // 15 mV a code
#define KZ_TEMPERATURE_FULL_DC 1024  // 0.1 °C a code: 102.4 °C

// A/D codes are 10 bits. A potentiometer's whole range is 190 degrees (Futaba S9204, design section
// 4).
#define KZ_POT_CODES 1024
#define KZ_POT_RANGE_DECIDEG 1900

// Outputs that are not joint directions. P40..P42 select the multiplexer input (pull-ups on the
// board: boot mode wants them high), P45 enables all motor drivers (pull-down: off while the pin
// floats).
#define KZ_P4_MUX_MASK 0x07
#define KZ_P4_ENABLE 0x20

// Angles on the wire and in the firmware are signed 16-bit numbers of 100 microradians.
#define KZ_ANGLE_PER_RAD 10000L
// Tenths of a degree to 100 microradians, exact in integers on both compilers: pi/1800 * 1e4
// = 17.453293.
#define KZ_DECIDEG(d) ((s16)((s32)(d)*17453L / 1000L))
// What a potentiometer's code 512 stands for, in 100 urad, from the columns of joints.def: half a code
// (16.19) beyond the angle at which it begins, because the converter rounds down.
#define KZ_POT_CENTRE(decideg, sign) ((s16)(KZ_DECIDEG(decideg) + ((sign) > 0 ? 16 : -16)))

#endif
