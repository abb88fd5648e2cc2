// Motorola S-records.
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

// Bytes of the address by record type; 0: no such record.
int address_bytes(char type) {
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

class Reader {
 public:
  explicit Reader(const std::string& name) : name_(name) {}

  Result<void> line(std::string_view text) {
    ++line_;
    while (!text.empty() && (text.back() == '\r' || text.back() == ' ')) text.remove_suffix(1);
    if (text.empty()) return {};
    if (ended_) return error("record after the end record");
    if (text.size() < 4 || text[0] != 'S')
      return error("not an S-record: it does not start with S and a type");
    const int width = address_bytes(text[1]);
    if (width == 0) return error(std::string("unknown record type S") + text[1]);
    if (text.size() % 2 != 0) return error("odd number of hex digits");
    std::vector<std::uint8_t> bytes;
    for (std::size_t k = 2; k < text.size(); k += 2) {
      const int high = digit(text[k]), low = digit(text[k + 1]);
      if (high < 0 || low < 0)
        return error("column " + std::to_string(k + 1) + ": '" + std::string(text.substr(k, 2)) +
                     "' is not hex");
      bytes.push_back(static_cast<std::uint8_t>(high << 4 | low));
    }
    if (bytes[0] + std::size_t{1} != bytes.size())
      return error("length byte says " + std::to_string(bytes[0]) + ", the line has " +
                   std::to_string(bytes.size() - 1) + " bytes");
    if (bytes[0] < width + 1) return error("record too short for its address");
    unsigned sum = 0;
    for (const std::uint8_t b : bytes) sum += b;
    if ((sum & 0xff) != 0xff) return error("wrong checksum");
    return record(text[1], width, bytes);
  }

  Result<Image> finish() {
    if (data_records_ == 0) return fail(name_ + ": no data records");
    if (!ended_) return fail(name_ + ": no end record (S7, S8 or S9); the file is cut off");
    return std::move(image_);
  }

 private:
  tl::unexpected<Error> error(const std::string& what) const {
    return fail(name_ + ":" + std::to_string(line_) + ": " + what);
  }

  Result<void> record(char type, int width, const std::vector<std::uint8_t>& bytes) {
    std::uint32_t address = 0;
    for (int k = 0; k < width; ++k) address = address << 8 | bytes[static_cast<std::size_t>(1 + k)];
    if (type == '5' || type == '6') {
      if (address != data_records_ % (type == '5' ? 0x10000u : 0x1000000u))
        return error("record count says " + std::to_string(address) + ", the file has " +
                     std::to_string(data_records_));
    } else if (type >= '7') {
      image_.entry = address;
      ended_ = true;
    } else if (type != '0') {
      ++data_records_;
      add(address, bytes.begin() + 1 + width, bytes.end() - 1);
    }
    return {};
  }

  template <class It>
  void add(std::uint32_t address, It from, It to) {
    if (!image_.segments.empty()) {
      Segment& last = image_.segments.back();
      if (last.load_address + last.bytes.size() == address) {
        last.bytes.insert(last.bytes.end(), from, to);
        return;
      }
    }
    image_.segments.push_back({address, address, "S-record data", {from, to}});
  }

  const std::string& name_;
  int line_ = 0;
  bool ended_ = false;
  std::uint32_t data_records_ = 0;
  Image image_;
};

}  // namespace

Result<Image> parse_srecord(std::string_view text, const std::string& name) {
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
