// Whether guest code can be translated to host code.
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kaz::h8s {

// True where this build has the translator: x86-64 with asmjit. Else Engine::translator interprets.
bool translator_available();

}  // namespace kaz::h8s
