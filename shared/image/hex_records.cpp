// Lines, digits and segments of the two hex formats.
// SPDX-License-Identifier: Apache-2.0
#include "shared/image/hex_records.h"

#include <algorithm>
#include <cstdio>
#include <iterator>

namespace kaz::h8s {
namespace {

int digit(char ch) {
  if (ch >= '0' && ch <= '9') return ch - '0';
  if (ch >= 'A' && ch <= 'F') return ch - 'A' + 10;
  if (ch >= 'a' && ch <= 'f') return ch - 'a' + 10;
  return -1;
}

std::string hex(std::uint32_t value, int digits) {
  char text[16];
  std::snprintf(text, sizeof text, "%0*x", digits, value);
  return text;
}

}  // namespace

Result<Image> HexRecords::parse(std::string_view text) {
  while (!text.empty()) {
    const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
    if (auto ok = line(text.substr(0, end)); !ok)
      return fail(ok.error().message +
                  (end == text.size() ? "; the file ends within this line: it seems cut off" : ""));
    const std::size_t mark = text.substr(end).starts_with("\r\n") ? 2 : 1;
    text.remove_prefix(std::min(end + mark, text.size()));
  }
  if (image_.segments.empty()) return fail(name_ + ": no data records");
  if (!ended_) return fail(name_ + ": no end record (" + end_ + "); the file is cut off");
  return std::move(image_);
}

Result<void> HexRecords::line(std::string_view text) {
  ++line_;
  while (text.ends_with(' ')) text.remove_suffix(1);
  if (text.empty()) return {};
  if (ended_) return error("record after the end record");
  return record(text);
}

tl::unexpected<Error> HexRecords::error(const std::string& what) const {
  return fail(name_ + ":" + std::to_string(line_) + ": " + what);
}

Result<std::vector<std::uint8_t>> HexRecords::digits(std::string_view line,
                                                     std::size_t first) const {
  if ((line.size() - first) % 2 != 0) return error("odd number of hex digits");
  std::vector<std::uint8_t> bytes;
  for (std::size_t k = first; k < line.size(); k += 2) {
    const int high = digit(line[k]), low = digit(line[k + 1]);
    if (high < 0 || low < 0)
      return error("column " + std::to_string(k + 1) + ": two hex digits expected");
    bytes.push_back(static_cast<std::uint8_t>(high << 4 | low));
  }
  return bytes;
}

std::uint32_t HexRecords::big(std::span<const std::uint8_t> bytes) {
  std::uint32_t value = 0;
  for (const std::uint8_t b : bytes) value = value << 8 | b;
  return value;
}

Result<void> HexRecords::append(std::uint32_t address, std::span<const std::uint8_t> data) {
  if (data.size() > (std::uint64_t{1} << 32) - address)
    return error("the " + std::to_string(data.size()) + " bytes at address " + hex(address, 8) +
                 " end beyond ffffffff; check the address of the record");
  std::uint64_t at = address;
  while (!data.empty()) {
    const auto next = by_address_.upper_bound(at);
    std::span<const std::uint8_t> earlier;
    if (next != by_address_.begin()) {
      const auto [begin, index] = *std::prev(next);
      const std::span<const std::uint8_t> bytes = image_.segments[index].bytes;
      if (at - begin < bytes.size()) earlier = bytes.subspan(at - begin);
    }
    std::uint64_t size = data.size();
    if (!earlier.empty()) {
      size = std::min<std::uint64_t>(size, earlier.size());
      KAZ_TRY(check_equal(static_cast<std::uint32_t>(at), data.first(size), earlier.first(size)));
    } else {
      if (next != by_address_.end()) size = std::min(size, next->first - at);
      add_new(static_cast<std::uint32_t>(at), data.first(size));
    }
    at += size;
    data = data.subspan(size);
  }
  return {};
}

Result<void> HexRecords::check_equal(std::uint32_t address, std::span<const std::uint8_t> data,
                                     std::span<const std::uint8_t> earlier) const {
  const auto [byte, before] = std::ranges::mismatch(data, earlier);
  if (byte == data.end()) return {};
  address += static_cast<std::uint32_t>(byte - data.begin());
  return error("address " + hex(address, 6) + " gets the value " + hex(*byte, 2) +
               ", but an earlier record has set it to " + hex(*before, 2) +
               "; remove one of these records");
}

void HexRecords::add_new(std::uint32_t address, std::span<const std::uint8_t> data) {
  if (!image_.segments.empty()) {
    Segment& last = image_.segments.back();
    if (last.load_address + last.bytes.size() == address) {
      last.bytes.insert(last.bytes.end(), data.begin(), data.end());
      return;
    }
  }
  by_address_.emplace(address, image_.segments.size());
  image_.segments.push_back({address, address, segment_, {data.begin(), data.end()}});
}

}  // namespace kaz::h8s
