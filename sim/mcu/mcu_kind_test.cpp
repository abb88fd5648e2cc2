// The names of the engines, as options and recordings spell them.
// SPDX-License-Identifier: Apache-2.0
#include "sim/mcu/mcu_kind.h"

#include <gtest/gtest.h>

#include "shared/base/enum_names.hpp"
#include "sim/mcu/mcu.h"

namespace kaz::sim {
namespace {

TEST(McuKind, HasTheNamesOfOptionsAndRecordings) {
  EXPECT_EQ(enum_names(kMcuKinds), (std::vector<std::string>{"h8", "native"}));
  for (const McuKind kind : kMcuKinds) EXPECT_EQ(parse_enum(kMcuKinds, to_string(kind)), kind);
}

TEST(McuKind, IsNoOtherName) {
  for (const char* name : {"avr", "", "H8", "h8 ", "nativ"})
    EXPECT_FALSE(parse_enum(kMcuKinds, name)) << name;
}

TEST(McuKind, IsTheNameOfItsEngine) {
  EXPECT_EQ(make_native()->name(), to_string(McuKind::native));
  EXPECT_EQ(make_erased_h8()->name(), to_string(McuKind::h8));
}

}  // namespace
}  // namespace kaz::sim
