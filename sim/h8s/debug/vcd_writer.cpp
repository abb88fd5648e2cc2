// Writes VCD as IEEE 1364 has it.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/debug/vcd_writer.h"

#include <algorithm>

namespace kaz::h8s {
namespace {

// Short names of variables: printable characters from '!' to '~'.
std::string code(std::size_t n) {
  std::string text;
  do {
    text += static_cast<char>('!' + n % 94);
    n /= 94;
  } while (n != 0);
  return text;
}

}  // namespace

std::string binary(std::uint32_t value, int bits) {
  std::string text;
  for (int k = bits - 1; k >= 0; --k) text += (value >> k & 1) != 0 ? '1' : '0';
  return text;
}

VcdWriter::VcdWriter(std::ostream& to, const std::vector<Variable>& variables)
    : to_(to), last_(variables.size()) {
  to_ << "$version kaz::h8s $end\n$timescale 1 ps $end\n$scope module h8s2128 $end\n";
  std::vector<std::string> scopes;
  for (std::size_t k = 0; k < variables.size(); ++k) {
    codes_.push_back(code(k));
    const std::string& s = variables[k].scope;
    if (std::find(scopes.begin(), scopes.end(), s) == scopes.end()) scopes.push_back(s);
  }
  for (const std::string& scope : scopes) {
    to_ << "$scope module " << scope << " $end\n";
    for (std::size_t k = 0; k < variables.size(); ++k) {
      const Variable& v = variables[k];
      if (v.scope != scope) continue;
      to_ << (v.bits == 1 ? "$var wire " : "$var reg ") << v.bits << ' ' << codes_[k] << ' '
          << v.name;
      if (v.bits > 1) to_ << " [" << v.bits - 1 << ":0]";
      to_ << " $end\n";
    }
    to_ << "$upscope $end\n";
  }
  to_ << "$upscope $end\n$enddefinitions $end\n";
}

void VcdWriter::put(std::size_t variable, const std::string& value) {
  if (value.size() == 1)
    to_ << value << codes_[variable] << '\n';
  else
    to_ << 'b' << value << ' ' << codes_[variable] << '\n';
  last_[variable] = value;
}

void VcdWriter::begin(std::int64_t picoseconds, const std::vector<std::string>& values) {
  time_ = picoseconds;
  to_ << '#' << time_ << "\n$dumpvars\n";
  for (std::size_t k = 0; k < values.size(); ++k) put(k, values[k]);
  to_ << "$end\n";
}

void VcdWriter::at(std::int64_t picoseconds) {
  if (picoseconds == time_) return;
  time_ = picoseconds;
  to_ << '#' << time_ << '\n';
}

void VcdWriter::change(std::size_t variable, std::int64_t picoseconds, const std::string& value) {
  if (picoseconds < time_ || last_[variable] == value) return;
  at(picoseconds);
  put(variable, value);
}

void VcdWriter::end(std::int64_t picoseconds) {
  if (picoseconds > time_) at(picoseconds);
  to_.flush();
}

}  // namespace kaz::h8s
