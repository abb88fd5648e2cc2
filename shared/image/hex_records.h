// What Motorola S-records and Intel HEX share: lines of hex digits, one record each.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "shared/image/image.h"

namespace kaz::h8s {

class HexRecords {
 public:
  virtual ~HexRecords() = default;
  Result<Image> parse(std::string_view text);

 protected:
  // `name` is used in messages and must outlive it; `segment` names the segments; `end` is how the
  // last record is called.
  HexRecords(const std::string& name, std::string segment, std::string end)
      : name_(name), segment_(std::move(segment)), end_(std::move(end)) {}

  // One line without the blanks at its end, never empty.
  virtual Result<void> record(std::string_view line) = 0;

  tl::unexpected<Error> error(const std::string& what) const;
  // The bytes that the digits of `line` from `first` on stand for.
  Result<std::vector<std::uint8_t>> digits(std::string_view line, std::size_t first) const;
  static std::uint32_t big(std::span<const std::uint8_t> bytes);
  // What follows the bytes before becomes one segment with them.
  void append(std::uint32_t address, std::span<const std::uint8_t> data);
  void entry(std::uint32_t address) { image_.entry = address; }
  void ended() { ended_ = true; }

 private:
  Result<void> line(std::string_view text);

  const std::string& name_;
  std::string segment_, end_;
  int line_ = 0;
  bool ended_ = false;
  Image image_;
};

}  // namespace kaz::h8s
