// Intel HEX: records 00 to 05.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdint>

#include "shared/image/image.h"

namespace kaz::h8s {
namespace {

int digit(char ch) {
  if (ch >= '0' && ch <= '9') return ch - '0';
  if (ch >= 'A' && ch <= 'F') return ch - 'A' + 10;
  if (ch >= 'a' && ch <= 'f') return ch - 'a' + 10;
  return -1;
}

class Reader {
 public:
  explicit Reader(const std::string& name) : name_(name) {}

  Result<void> line(std::string_view text) {
    ++line_;
    while (!text.empty() && (text.back() == '\r' || text.back() == ' ')) text.remove_suffix(1);
    if (text.empty()) return {};
    if (ended_) return error("record after the end record");
    if (text[0] != ':') return error("not an Intel HEX record: it does not start with a colon");
    if (text.size() % 2 != 1) return error("odd number of hex digits");
    std::vector<std::uint8_t> bytes;
    for (std::size_t k = 1; k < text.size(); k += 2) {
      const int high = digit(text[k]), low = digit(text[k + 1]);
      if (high < 0 || low < 0)
        return error("column " + std::to_string(k + 1) + ": two hex digits expected");
      bytes.push_back(static_cast<std::uint8_t>(high << 4 | low));
    }
    if (bytes.size() < 5) return error("the record is too short: at least 5 bytes expected");
    if (bytes[0] + std::size_t{5} != bytes.size())
      return error("length byte says " + std::to_string(bytes[0]) + ", the line has " +
                   std::to_string(bytes.size() - 5) + " bytes of data");
    unsigned sum = 0;
    for (const std::uint8_t b : bytes) sum += b;
    if ((sum & 0xff) != 0) return error("wrong checksum");
    return record(bytes);
  }

  Result<Image> finish() {
    if (image_.segments.empty()) return fail(name_ + ": no data records");
    if (!ended_) return fail(name_ + ": no end record (type 01); the file is cut off");
    return std::move(image_);
  }

 private:
  tl::unexpected<Error> error(const std::string& what) const {
    return fail(name_ + ":" + std::to_string(line_) + ": " + what);
  }

  static std::uint32_t big(std::span<const std::uint8_t> bytes) {
    std::uint32_t value = 0;
    for (const std::uint8_t b : bytes) value = value << 8 | b;
    return value;
  }

  Result<void> record(std::span<const std::uint8_t> bytes) {
    const auto data = bytes.subspan(4, bytes[0]);
    const unsigned type = bytes[3];
    const std::size_t wanted[] = {0, 0, 2, 4, 2, 4};
    if (type > 5) return error("unknown record type " + std::to_string(type) + ", 0 to 5 expected");
    if (type != 0 && data.size() != wanted[type])
      return error("record type " + std::to_string(type) + " has " + std::to_string(data.size()) +
                   " bytes of data, " + std::to_string(wanted[type]) + " expected");
    switch (type) {
      case 0:
        add(big(bytes.subspan(1, 2)), data);
        break;
      case 1:
        ended_ = true;
        break;
      case 2:
        base_ = big(data) << 4;
        segmented_ = true;
        break;
      case 3:
        image_.entry = (big(data.first(2)) << 4) + big(data.subspan(2));
        break;
      case 4:
        base_ = big(data) << 16;
        segmented_ = false;
        break;
      default:
        image_.entry = big(data);
        break;
    }
    return {};
  }

  // After a record 02 offsets wrap inside its 64 KiB.
  void add(std::uint32_t offset, std::span<const std::uint8_t> data) {
    const std::size_t before =
        segmented_ ? std::min<std::size_t>(data.size(), 0x10000 - offset) : data.size();
    append(base_ + offset, data.first(before));
    if (before < data.size()) append(base_, data.subspan(before));
  }

  void append(std::uint32_t address, std::span<const std::uint8_t> data) {
    if (data.empty()) return;
    if (!image_.segments.empty()) {
      Segment& last = image_.segments.back();
      if (last.load_address + last.bytes.size() == address) {
        last.bytes.insert(last.bytes.end(), data.begin(), data.end());
        return;
      }
    }
    image_.segments.push_back({address, address, "Intel HEX data", {data.begin(), data.end()}});
  }

  const std::string& name_;
  int line_ = 0;
  std::uint32_t base_ = 0;
  bool segmented_ = false;
  bool ended_ = false;
  Image image_;
};

}  // namespace

Result<Image> parse_intel_hex(std::string_view text, const std::string& name) {
  Reader reader(name);
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    if (auto ok = reader.line(text.substr(0, end)); !ok)
      return fail(ok.error().message +
                  (end == text.size() ? "; the file ends within this line: it seems cut off" : ""));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return reader.finish();
}

}  // namespace kaz::h8s
