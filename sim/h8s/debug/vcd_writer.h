// The text of a VCD file: header, values and times.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <ostream>
#include <string>
#include <vector>

namespace kaz::h8s {

class VcdWriter {
 public:
  struct Variable {
    std::string scope, name;
    int bits = 1;
  };
  // The header with one scope below "h8s2128" for each that the variables name.
  VcdWriter(std::ostream& to, const std::vector<Variable>& variables);
  // First values, one text of '0', '1', 'x' and 'z' a variable, most significant bit first.
  void begin(std::int64_t picoseconds, const std::vector<std::string>& values);
  // Ignored if the time is before the last one or the value is unchanged.
  void change(std::size_t variable, std::int64_t picoseconds, const std::string& value);
  void end(std::int64_t picoseconds);

 private:
  void put(std::size_t variable, const std::string& value);
  void at(std::int64_t picoseconds);

  std::ostream& to_;
  std::vector<std::string> codes_, last_;
  std::int64_t time_ = 0;
};

// Binary digits of the low bits of `value`.
std::string binary(std::uint32_t value, int bits);

}  // namespace kaz::h8s
