// The byte-level examples of docs/reference/protocol.md are what the codec makes.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <vector>

#include "shared/protocol/messages.h"

namespace {

// The "on the wire" lines, in order. Tests run in the root of the tree.
std::vector<std::string> examples() {
  std::vector<std::string> found;
  std::ifstream page("docs/reference/protocol.md");
  for (std::string line; std::getline(page, line);) {
    const auto from = line.find("| on the wire | `");
    if (from == std::string::npos) continue;
    const auto start = line.find('`') + 1;
    found.push_back(line.substr(start, line.rfind('`') - start));
  }
  return found;
}

std::string wire(u8 type, u8 sequence, const std::vector<u8>& fields) {
  std::vector<u8> body = {KZ_ADDRESS_DEFAULT, type, sequence};
  body.insert(body.end(), fields.begin(), fields.end());
  u8 bytes[KZ_FRAME_MAX];
  const int length = kz_frame_encode(body.data(), static_cast<u8>(body.size()), bytes);
  std::string text;
  for (int i = 0; i < length; ++i) {
    constexpr char digits[] = "0123456789abcdef";
    if (i > 0) text += ' ';
    text += digits[bytes[i] >> 4];
    text += digits[bytes[i] & 15];
  }
  return text;
}

TEST(ProtocolPage, ExamplesAreTheCodecsBytes) {
  kz_targets targets = {};
  targets.mask = 0b11;
  targets.duration_ms = 500;
  targets.angle[0] = 1000;
  targets.angle[1] = -2;
  std::vector<u8> fields(KZ_SIZE_targets);
  fields.resize(kz_pack_targets(&targets, fields.data()));
  EXPECT_EQ(examples(), (std::vector<std::string>{wire(KZ_TYPE_state, 5, {}),
                                                  wire(KZ_TYPE_targets, 7, fields)}));
}

}  // namespace
