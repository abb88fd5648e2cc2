// Sets of vector instructions. Loops over pixels are compiled once for each set.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>

namespace kaz::sim {

// With all instruction sets, the pictures are the same, byte for byte.
enum class InstructionSet { plain, avx2, avx512 };

// Returns false if the processor does not have the instructions of `set`, or if the program was compiled for
// another kind of processor.
inline bool is_available(InstructionSet set) {
#if defined(__x86_64__)
  if (set == InstructionSet::avx2) return __builtin_cpu_supports("avx2") != 0;
  if (set == InstructionSet::avx512)
    return __builtin_cpu_supports("avx512bw") != 0 && __builtin_cpu_supports("avx512dq") != 0 &&
           __builtin_cpu_supports("avx512vl") != 0;
#endif
  return set == InstructionSet::plain;
}

// Returns the available set with the widest vectors.
inline InstructionSet best_instructions() {
  for (const InstructionSet set : {InstructionSet::avx512, InstructionSet::avx2}) {
    if (is_available(set)) return set;
  }
  return InstructionSet::plain;
}

}  // namespace kaz::sim
