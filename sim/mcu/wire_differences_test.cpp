// The list of differences by design: the fields exist, and docs/explanation/emulator.md contains the table.
// SPDX-License-Identifier: Apache-2.0
#include "sim/mcu/wire_differences.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "shared/protocol/frame.h"
#include "shared/protocol/message_info.h"

namespace kaz::sim {
namespace {

TEST(WireDifferences, NameFieldsOfReplies) {
  for (const WireException& row : wire_differences()) {
    if (row.type == 0) continue;
    const kz_message_info* info = kz_message_find(row.type);
    ASSERT_NE(info, nullptr) << row.what;
    bool found = false;
    for (int f = 0; f < info->field_count; ++f)
      found = found || std::string_view(info->fields[f].name) == row.field;
    EXPECT_TRUE(found) << row.what;
  }
}

TEST(WireDifferences, MaskTheirFieldsAndNothingElse) {
  const kz_message_info* info = kz_message_find(KZ_TYPE_statistics_reply);
  std::vector<std::uint8_t> body(std::size_t{KZ_HEADER_SIZE} + info->size_max, 0xEE);
  body[1] = KZ_TYPE_statistics_reply;
  ASSERT_TRUE(mask_wire_differences(body));
  // After header, tick and status: two numbers of two bytes.
  for (std::size_t i = 0; i < body.size(); ++i) {
    const bool masked = i >= KZ_HEADER_SIZE + 6u && i < KZ_HEADER_SIZE + 10u;
    if (i != 1) {
      EXPECT_EQ(body[i], masked ? 0 : 0xEE) << i;
    }
  }
  std::vector<std::uint8_t> other(10, 0xEE);
  other[1] = KZ_TYPE_state_reply;
  EXPECT_FALSE(mask_wire_differences(other));
}

// The list as a Markdown table.
std::string wire_differences_table() {
  std::string table = "| on the wire | `h8` | `native` | why |\n|---|---|---|---|\n";
  for (const WireException& row : wire_differences()) {
    for (const char* cell : {row.what, row.h8, row.native, row.reason})
      table += std::string("| ") + cell + " ";
    table += "|\n";
  }
  return table;
}

TEST(WireDifferences, AreInTheDocument) {
  std::ifstream file(KAZ_SOURCE "/docs/explanation/emulator.md");
  std::stringstream text;
  text << file.rdbuf();
  EXPECT_NE(text.str().find(wire_differences_table()), std::string::npos)
      << "docs/explanation/emulator.md should have:\n"
      << wire_differences_table();
}

}  // namespace
}  // namespace kaz::sim
