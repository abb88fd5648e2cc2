// Sets of vector instructions for which loops over pixels are compiled.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>

namespace kaz::sim {

// All sets give the same pictures, byte for byte.
enum class InstructionSet { plain, avx2, avx512 };

// Returns false if the processor or the compiler's target lacks the set.
inline bool is_available(InstructionSet set) {
#if defined(__x86_64__)
  if (set == InstructionSet::avx2) return __builtin_cpu_supports("avx2") != 0;
  if (set == InstructionSet::avx512)
    return __builtin_cpu_supports("avx512bw") != 0 && __builtin_cpu_supports("avx512dq") != 0 &&
           __builtin_cpu_supports("avx512vl") != 0;
#endif
  return set == InstructionSet::plain;
}

// Returns the widest set that is available.
inline InstructionSet best_instructions() {
  for (const InstructionSet set : {InstructionSet::avx512, InstructionSet::avx2}) {
    if (is_available(set)) return set;
  }
  return InstructionSet::plain;
}

}  // namespace kaz::sim
