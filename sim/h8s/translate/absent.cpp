// Stands in for the translator where the host is not x86-64 or asmjit was not found.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/translate/translator.h"

namespace kaz::h8s {

struct Translator::Cache {};

Translator::Translator() = default;
Translator::~Translator() = default;

void Translator::run(Cpu& c) {
  run_interpreter(c);
}

void Translator::forget(std::uint32_t, std::uint32_t) {}
void Translator::hook_changed(std::uint32_t) {}
void Translator::forget_all() {}

std::int64_t Translator::translated() const {
  return 0;
}

std::int64_t Translator::executed() const {
  return 0;
}
void Translator::reset_count() {}

std::unique_ptr<Translator> make_translator() {
  return nullptr;
}

bool translator_available() {
  return false;
}

}  // namespace kaz::h8s
