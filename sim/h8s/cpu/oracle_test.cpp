// Every form of every instruction against the tests' own model, which is made from the manual.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <tuple>

#include "sim/h8s/cpu/oracle_testing.h"

namespace kaz::h8s::oracle {
namespace {

// Normal mode or not, and the engine.
class Mode : public ::testing::TestWithParam<std::tuple<bool, Engine>> {
 protected:
  static Options options() {
    Options chosen;
    chosen.engine = std::get<1>(GetParam());
    return chosen;
  }
};
std::string name_of(const ::testing::TestParamInfo<std::tuple<bool, Engine>>& mode) {
  const std::string name = std::get<0>(mode.param) ? "normal" : "advanced";
  return name + (std::get<1>(mode.param) == Engine::reference ? "_reference" : "_interpreter");
}

INSTANTIATE_TEST_SUITE_P(Cpu, Mode,
                         ::testing::Combine(::testing::Bool(),
                                            ::testing::Values(Engine::reference,
                                                              Engine::interpreter)),
                         name_of);

// Whether the form touches data that may be in I/O registers: bytes, or words in steps of even
// addresses. Block moves would run over registers that do not keep what is written.
bool touches_data(const Form& form) {
  return form.cycles.l + form.cycles.m > 0 && form.name.rfind("eepmov", 0) != 0;
}

TEST_P(Mode, EachFormDoesWhatTheManualSays) {
  Bench bench(std::get<0>(GetParam()), options());
  int wrong = 0, trials = 0;
  for (const Form& form : forms()) {
    for (int k = 0; k < 1000; ++k) {
      const std::string text = bench.random_trial(form, false);
      ++trials;
      if (text.empty()) continue;
      ADD_FAILURE() << text;
      if (++wrong > 20) return;
      break;
    }
    const std::string memory = bench.compare_memory();
    ASSERT_TRUE(memory.empty()) << "after " << form.name << ": " << memory;
  }
  EXPECT_EQ(trials, 1000 * static_cast<int>(forms().size()));
}

// The same with operands among the registers of both buses: contents, flags and states.
TEST_P(Mode, EachFormReachesRegistersAtTheirSpeed) {
  Bench bench(std::get<0>(GetParam()), options());
  int wrong = 0, tried = 0;
  for (const Form& form : forms()) {
    if (!touches_data(form)) continue;
    ++tried;
    for (int k = 0; k < 60; ++k) {
      const std::string text = bench.random_trial(form, true);
      if (text.empty()) continue;
      ADD_FAILURE() << text;
      if (++wrong > 20) return;
      break;
    }
  }
  EXPECT_EQ(tried, 135);  // MOV 38, LDC and STC 24, bits 72, TAS
}

}  // namespace
}  // namespace kaz::h8s::oracle
