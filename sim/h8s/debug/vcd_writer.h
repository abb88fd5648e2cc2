// Writes the text of a VCD file: header, values and times.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <ostream>
#include <string>
#include <vector>

namespace kaz::h8s {

// Times are in picoseconds. A value has one of '0', '1', 'x' and 'z' for each bit, most significant bit
// first.
class VcdWriter {
 public:
  struct Variable {
    std::string scope, name;
    int bits = 1;
  };
  // Writes the header. In the header, the scope "h8s2128" contains the scopes of all variables. `to` must
  // outlive this object.
  VcdWriter(std::ostream& to, const std::vector<Variable>& variables);
  // Writes the initial values, one for each variable. Must be called once, before change().
  void begin(std::int64_t picoseconds, const std::vector<std::string>& values);
  // Writes a value. Does nothing if the time is before the last written time, or if the value is unchanged.
  void change(std::size_t variable, std::int64_t picoseconds, const std::string& value);
  void end(std::int64_t picoseconds);

 private:
  void put(std::size_t variable, const std::string& value);
  void at(std::int64_t picoseconds);

  std::ostream& to_;
  std::vector<std::string> codes_, last_;
  std::int64_t time_ = 0;
};

// Returns the low `bits` bits of `value` as binary digits.
std::string binary(std::uint32_t value, int bits);

}  // namespace kaz::h8s
