// Random inputs of the joints' loop, with corner values and values at every threshold of the loop.
// SPDX-License-Identifier: Apache-2.0
//
// Each field of each joint is drawn from a mixture: corner values (0, 1, -1, the ends of the type), values
// of every magnitude, uniform ones, and values solved for the state so that a comparison of the loop
// falls one short of, exactly on or one beyond its threshold: the range of codes, the change of angle
// that counts, the rate at which a limit brakes, the distance that a rate needs, a limit met by a ramp, the
// edges of the dead band, the rounding and the saturation of the duty, the braking drive.
//
// Fields are independent of each other and of what requests allow: limits may be crossed, gains negative,
// ramps may run over an end of the type. Excluded is only where the two sides are not defined alike:
//   - `on` other than 0 and 1 in a joint that is not constrained but has a dead band or friction: the C takes
//     any value as true, the assembler compares with 1 and then takes the constrained path. `on` is a bit of
//     `enabled`, and the protection keeps KZ_CONSTRAINED_BY_FRICTION for a joint with dead band or friction.
//   - |kp| or |kd| above 32,759 in a constrained joint with friction: the sum can exceed 32 bits, which C
//     leaves undefined. Requests set 8,356 and 816 at most.
#pragma once

#include <array>
#include <cstdint>

#include "shared/servo/servo.h"

namespace kaz::firmware {

struct LoopInput {
  std::array<kz_joint, KZ_JOINTS> joint{};
  std::array<u16, 256> analog{};  // as many as `pot_input` can name
};

// Input of call number `call` under `seed`: the same on every machine, and whichever calls came before.
void draw_loop_input(std::uint64_t seed, std::uint64_t call, LoopInput& input);

}  // namespace kaz::firmware
