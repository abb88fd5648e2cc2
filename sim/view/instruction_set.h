// Sets of vector instructions that loops over pixels are compiled for.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>

namespace kaz::sim {

// Pictures are the same bytes with each of them.
enum class InstructionSet { plain, avx2, avx512 };

// False where the processor, or the compiler's target, has not got it.
inline bool is_available(InstructionSet set) {
#if defined(__x86_64__)
  if (set == InstructionSet::avx2) return __builtin_cpu_supports("avx2") != 0;
  if (set == InstructionSet::avx512)
    return __builtin_cpu_supports("avx512bw") != 0 && __builtin_cpu_supports("avx512dq") != 0 &&
           __builtin_cpu_supports("avx512vl") != 0;
#endif
  return set == InstructionSet::plain;
}

// The widest that is available.
inline InstructionSet best_instructions() {
  for (const InstructionSet set : {InstructionSet::avx512, InstructionSet::avx2}) {
    if (is_available(set)) return set;
  }
  return InstructionSet::plain;
}

}  // namespace kaz::sim
