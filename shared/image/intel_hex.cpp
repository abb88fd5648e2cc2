// Intel HEX: records 00 to 05.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "shared/image/hex_records.h"

namespace kaz::h8s {
namespace {

unsigned sum_of(std::span<const std::uint8_t> bytes) {
  unsigned sum = 0;
  for (const std::uint8_t b : bytes) sum += b;
  return sum & 0xff;
}

class Reader final : public HexRecords {
 public:
  explicit Reader(const std::string& name) : HexRecords(name, "Intel HEX data", "type 01") {}

 private:
  Result<void> record(std::string_view line) override {
    if (line[0] != ':') return error("not an Intel HEX record: it does not start with a colon");
    const auto bytes = KAZ_TRY(digits(line, 1));
    if (bytes.size() < 5) return error("the record is too short: at least 5 bytes expected");
    if (bytes.front() + std::size_t{5} != bytes.size())
      return error("length byte is " + std::to_string(bytes.front()) + ", but the line has " +
                   std::to_string(bytes.size() - 5) + " bytes of data");
    if (sum_of(bytes) != 0) return error("wrong checksum");
    return take(bytes);
  }

  Result<void> take(std::span<const std::uint8_t> bytes) {
    const auto data = bytes.subspan(4, bytes[0]);
    const unsigned type = bytes[3];
    const std::size_t wanted[] = {0, 0, 2, 4, 2, 4};
    if (type > 5) return error("unknown record type " + std::to_string(type) + ", 0 to 5 expected");
    if (type != 0 && data.size() != wanted[type])
      return error("record type " + std::to_string(type) + " has " + std::to_string(data.size()) +
                   " bytes of data, " + std::to_string(wanted[type]) + " expected");
    switch (type) {
      case 0:
        return add(big(bytes.subspan(1, 2)), data);
      case 1:
        ended();
        break;
      case 2:
        base_ = big(data) << 4;
        segmented_ = true;
        break;
      case 3:
        entry((big(data.first(2)) << 4) + big(data.subspan(2)));
        break;
      case 4:
        base_ = big(data) << 16;
        segmented_ = false;
        break;
      default:
        entry(big(data));
        break;
    }
    return {};
  }

  // After a record 02 offsets wrap inside its 64 KiB.
  Result<void> add(std::uint32_t offset, std::span<const std::uint8_t> data) {
    const std::size_t before =
        segmented_ ? std::min<std::size_t>(data.size(), 0x10000 - offset) : data.size();
    KAZ_TRY(append(base_ + offset, data.first(before)));
    return append(base_, data.subspan(before));
  }

  std::uint32_t base_ = 0;
  bool segmented_ = false;
};

}  // namespace

Result<Image> parse_intel_hex(std::string_view text, const std::string& name) {
  return Reader(name).parse(text);
}

}  // namespace kaz::h8s
