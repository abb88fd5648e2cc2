// Motorola S-records.
// SPDX-License-Identifier: Apache-2.0
#include "shared/image/hex_records.h"

namespace kaz::h8s {
namespace {

// Bytes of the address by record type; 0: no such record.
std::size_t address_bytes(char type) {
  switch (type) {
    case '0':
    case '1':
    case '5':
    case '9':
      return 2;
    case '2':
    case '6':
    case '8':
      return 3;
    case '3':
    case '7':
      return 4;
    default:
      return 0;
  }
}

class Reader final : public HexRecords {
 public:
  explicit Reader(const std::string& name) : HexRecords(name, "S-record data", "S7, S8 or S9") {}

 private:
  Result<void> record(std::string_view line) override {
    if (line.size() < 4 || line[0] != 'S')
      return error("not an S-record: it does not start with S and a type");
    const char type = line[1];
    const std::size_t width = address_bytes(type);
    if (width == 0) return error(std::string("unknown record type S") + type);
    const auto bytes = KAZ_TRY(digits(line, 2));
    if (bytes.front() + std::size_t{1} != bytes.size())
      return error("length byte is " + std::to_string(bytes.front()) + ", but the line has " +
                   std::to_string(bytes.size() - 1) + " bytes");
    if (bytes.front() < width + 1) return error("record too short for its address");
    unsigned sum = 0;
    for (const std::uint8_t b : bytes) sum += b;
    if ((sum & 0xff) != 0xff) return error("wrong checksum");
    const auto all = std::span(bytes);
    return take(type, big(all.subspan(1, width)), all.subspan(1 + width, all.size() - width - 2));
  }

  Result<void> take(char type, std::uint32_t address, std::span<const std::uint8_t> data) {
    if (type == '5' || type == '6') {
      if (address != data_records_ % (type == '5' ? 0x10000u : 0x1000000u))
        return error("record count is " + std::to_string(address) + ", but the file has " +
                     std::to_string(data_records_));
    } else if (type >= '7') {
      entry(address);
      ended();
    } else if (type != '0') {
      ++data_records_;
      KAZ_TRY(append(address, data));
    }
    return {};
  }

  std::uint32_t data_records_ = 0;
};

}  // namespace

Result<Image> parse_srecord(std::string_view text, const std::string& name) {
  return Reader(name).parse(text);
}

}  // namespace kaz::h8s
