// Hardware constants of the servo board: clock, A/D channels, output bits and angle units. The wiring of each
// joint is in joints.def.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_BOARD_BOARD_H
#define KAZ_SHARED_BOARD_BOARD_H

#include "shared/base/types.h"

#define KZ_JOINTS 18

// Crystal frequency, Hz. One CPU state is one period of the crystal. The duration of a bit at 115,200 baud is
// a whole number of states, and so is 1 ms.
#define KZ_CLOCK_HZ 18432000L
#define KZ_TICK_HZ 1000
#define KZ_STATES_PER_TICK 18432L
#define KZ_BAUD 115200L
#define KZ_STATES_PER_BIT 160    // KZ_CLOCK_HZ / KZ_BAUD
#define KZ_STATES_PER_BYTE 1600  // 8N1

// Indices into kz_tick_input.analog: multiplexer * 8 + input.
#define KZ_MUXES 3
#define KZ_MUX_INPUTS 8
#define KZ_ANALOG (KZ_MUXES * KZ_MUX_INPUTS)
// Motor supply, measured through a voltage divider. Full scale is KZ_SUPPLY_FULL_MV.
#define KZ_ANALOG_SUPPLY 6
// Half of AVCC, to test the A/D converter: the expected code is 512.
#define KZ_ANALOG_REFERENCE 7
// Temperature of the motor drivers: 0 °C at code 0, KZ_TEMPERATURE_FULL_DC at full scale.
#define KZ_ANALOG_TEMPERATURE 14
// Optional inertial sensors on AN3..AN5; half of AVCC means zero. Boards without inertial sensors ground
// these pins. The inertial sensors have the indices 15, 22 and 23, because no multiplexer input uses these
// indices.
#define KZ_ANALOG_YAW_RATE 15
#define KZ_ANALOG_FORWARD_FORCE 22
#define KZ_ANALOG_LEFT_FORCE 23
#define KZ_SUPPLY_FULL_MV 15360      // supply voltage at full scale, mV; one A/D code is 15 mV
#define KZ_TEMPERATURE_FULL_DC 1024  // temperature at full scale, 0.1 °C; one A/D code is 0.1 °C

// A/D codes have 10 bits and cover the potentiometer's whole range, 190 degrees (Futaba S9204).
#define KZ_POT_CODES 1024
#define KZ_POT_RANGE_DECIDEG 1900

// Outputs of port 4 that are not joint directions. P40..P42 select the multiplexer input. Pull-ups keep
// P40..P42 high, because boot mode requires high levels. P45 enables all motor drivers. A pull-down keeps the
// drivers off while the pin floats.
#define KZ_P4_MUX_MASK 0x07
#define KZ_P4_ENABLE 0x20

// Angles on the wire and in the firmware are signed 16-bit numbers in units of 100 microradians.
#define KZ_ANGLE_PER_RAD 10000L
// Converts 0.1 degrees to 100 microradians: pi/1800 * 1e4 = 17.453293. Integer arithmetic gives the
// same result on the H8 and on the PC.
#define KZ_DECIDEG(d) ((s16)((s32)(d)*17453L / 1000L))
// Each potentiometer code covers a range of angles. KZ_POT_CENTRE is the joint angle in the middle of the
// range of code 512, in units of 100 urad. The arguments are the columns `pot_centre` and `sign` of
// joints.def. The converter rounds down. So the range of code 512 starts at the angle in joints.def. The
// distance from the start to the middle of the range is half a code, or 16.19 units.
#define KZ_POT_CENTRE(decideg, sign) ((s16)(KZ_DECIDEG(decideg) + ((sign) > 0 ? 16 : -16)))

#endif
