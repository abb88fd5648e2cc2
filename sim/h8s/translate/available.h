// Query whether this build can translate guest code to host code.
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kaz::h8s {

// Returns whether this build has the translator (x86-64 with asmjit). In a build without the translator,
// Engine::translator runs the interpreter.
bool translator_available();

}  // namespace kaz::h8s
