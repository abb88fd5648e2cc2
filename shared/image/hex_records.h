// Base class of the parsers of Motorola S-records and Intel HEX: one record of hex digits per line.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "shared/image/image.h"

namespace kaz::h8s {

// Parses one file. Use a new object for each file.
class HexRecords {
 public:
  virtual ~HexRecords() = default;
  // Returns the image, or an error that names file and line. A line ends with LF, CR LF or CR.
  Result<Image> parse(std::string_view text);

 protected:
  // `name` names the file in messages and must outlive the object. `segment` is the name of the image's
  // segments. `end` names the end record in messages.
  HexRecords(const std::string& name, std::string segment, std::string end)
      : name_(name), segment_(std::move(segment)), end_(std::move(end)) {}

  // Parses a record: a line without trailing blanks, never empty.
  virtual Result<void> record(std::string_view line) = 0;

  // Returns an error that names the present line.
  tl::unexpected<Error> error(const std::string& what) const;
  // Converts hex digits to bytes, from the digit at index `first` to the end of `line`.
  Result<std::vector<std::uint8_t>> digits(std::string_view line, std::size_t first) const;
  // Reads a big-endian number of up to four bytes.
  static std::uint32_t big(std::span<const std::uint8_t> bytes);
  // Adds data to the image. If `address` directly follows the previous data, the data extend the same
  // segment. Bytes that repeat the values of an earlier record are skipped. Returns an error if a byte
  // contradicts an earlier record or lies beyond 32 bits.
  Result<void> append(std::uint32_t address, std::span<const std::uint8_t> data);
  void entry(std::uint32_t address) { image_.entry = address; }
  void ended() { ended_ = true; }

 private:
  Result<void> line(std::string_view text);
  Result<void> check_equal(std::uint32_t address, std::span<const std::uint8_t> data,
                           std::span<const std::uint8_t> earlier) const;
  void add_new(std::uint32_t address, std::span<const std::uint8_t> data);

  const std::string& name_;
  std::string segment_, end_;
  int line_ = 0;
  bool ended_ = false;
  Image image_;
  // Index of each segment by its address. The segments do not overlap.
  std::map<std::uint64_t, std::size_t> by_address_;
};

}  // namespace kaz::h8s
