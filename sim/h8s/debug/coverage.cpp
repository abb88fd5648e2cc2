// Instruction and branch coverage.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/debug/coverage.h"

#include <algorithm>
#include <cstdio>
#include <vector>

namespace kaz::h8s {
namespace {

using Functions = std::vector<const Symbol*>;

// By address.
Functions functions_of(const SymbolTable& symbols) {
  Functions functions;
  for (const Symbol& s : symbols.symbols()) {
    if (s.function) functions.push_back(&s);
  }
  return functions;
}

// Behind the last byte of a function; up to the next one if the image does not state its size.
std::uint32_t end_of(const Functions& functions, std::size_t k) {
  constexpr std::uint32_t kEnd = 0x01000000;  // of 24-bit addresses
  const Symbol& function = *functions[k];
  const std::uint32_t next =
      k + 1 < functions.size() ? functions[k + 1]->address : std::max(kEnd, function.address);
  // A damaged image may state anything.
  if (function.size == 0 || function.size > next - function.address) return next;
  return function.address + function.size;
}

}  // namespace

void Coverage::executed(const Executed& e) {
  if (!e.whole) return;
  Count& c = counts_[e.pc];
  ++c.executed;
  c.length = e.length;
  if (e.flow != Flow::branch) return;
  c.branch = true;
  ++(e.taken() ? c.taken : c.passed);
}

std::string Coverage::text() const {
  const Functions functions = functions_of(chip_.symbols());
  char line[256];
  std::snprintf(line, sizeof line, "%7s %7s %7s %12s %9s  %s\n", "covered", "bytes", "share %",
                "entered", "one-way", "function");
  std::string out = line;
  for (std::size_t k = 0; k < functions.size(); ++k) {
    const std::uint32_t first = functions[k]->address;
    const std::uint32_t end = end_of(functions, k);
    std::int64_t covered = 0, one_way = 0;
    for (auto at = counts_.lower_bound(first); at != counts_.end() && at->first < end; ++at) {
      covered += at->second.length;
      one_way += at->second.branch && (at->second.taken == 0 || at->second.passed == 0) ? 1 : 0;
    }
    if (first == end) continue;  // another name of the next one
    char size[32] = "-", share[32] = "-";
    if (functions[k]->size != 0) {
      const std::uint32_t bytes = end - first;
      std::snprintf(size, sizeof size, "%u", static_cast<unsigned>(bytes));
      std::snprintf(share, sizeof share, "%.1f", 100.0 * static_cast<double>(covered) / bytes);
    }
    const auto entered = counts_.find(first);
    std::snprintf(line, sizeof line, "%7lld %7s %7s %12lld %9lld  %.120s\n",
                  static_cast<long long>(covered), size, share,
                  static_cast<long long>(entered == counts_.end() ? 0 : entered->second.executed),
                  static_cast<long long>(one_way), functions[k]->name.c_str());
    out += line;
  }
  return out;
}

std::string Coverage::lcov() const {
  struct File {
    std::map<std::uint32_t, std::int64_t> lines;
    std::string functions, branches;
    int found = 0, hit = 0, branches_found = 0, branches_hit = 0;
  };
  std::map<std::string, File> files;
  const SymbolTable& symbols = chip_.symbols();
  const auto& lines = symbols.lines();
  const Functions functions = functions_of(symbols);
  std::size_t inside = 0;  // the function after that of the line
  for (std::size_t k = 0; k < lines.size(); ++k) {
    std::int64_t count = 0;
    std::uint32_t end = k + 1 < lines.size() ? lines[k + 1].address : lines[k].address + 2;
    while (inside < functions.size() && functions[inside]->address <= lines[k].address) ++inside;
    // A function's last line ends with it.
    if (inside > 0 && end_of(functions, inside - 1) > lines[k].address)
      end = std::min(end, end_of(functions, inside - 1));
    for (auto at = counts_.lower_bound(lines[k].address); at != counts_.end() && at->first < end;
         ++at)
      count = std::max(count, at->second.executed);
    std::int64_t& known = files[lines[k].file].lines[lines[k].line];
    known = std::max(known, count);
  }
  for (const Symbol& s : symbols.symbols()) {
    const SourceLine* line = s.function ? symbols.line_at(s.address) : nullptr;
    if (!line) continue;
    File& file = files[line->file];
    const auto entered = counts_.find(s.address);
    const std::int64_t n = entered == counts_.end() ? 0 : entered->second.executed;
    file.functions += "FN:" + std::to_string(line->line);
    file.functions.append(",").append(s.name).append("\nFNDA:").append(std::to_string(n));
    file.functions.append(",").append(s.name).append("\n");
    ++file.found;
    file.hit += n > 0;
  }
  for (const auto& [pc, c] : counts_) {
    const SourceLine* line = c.branch ? symbols.line_at(pc) : nullptr;
    if (!line) continue;
    File& file = files[line->file];
    const std::string head = "BRDA:" + std::to_string(line->line) + "," + std::to_string(pc) + ",";
    file.branches.append(head).append("0,").append(std::to_string(c.taken)).append("\n");
    file.branches.append(head).append("1,").append(std::to_string(c.passed)).append("\n");
    file.branches_found += 2;
    file.branches_hit += (c.taken > 0) + (c.passed > 0);
  }
  std::string out;
  for (const auto& [name, file] : files) {
    out.append("TN:kaz\nSF:").append(name).append("\n").append(file.functions);
    out.append("FNF:").append(std::to_string(file.found));
    out.append("\nFNH:").append(std::to_string(file.hit)).append("\n").append(file.branches);
    out.append("BRF:").append(std::to_string(file.branches_found));
    out.append("\nBRH:").append(std::to_string(file.branches_hit)).append("\n");
    std::int64_t hit = 0;
    for (const auto& [line, count] : file.lines) {
      out.append("DA:").append(std::to_string(line)).append(",");
      out.append(std::to_string(count)).append("\n");
      hit += count > 0;
    }
    out.append("LF:").append(std::to_string(file.lines.size()));
    out.append("\nLH:").append(std::to_string(hit)).append("\nend_of_record\n");
  }
  return out;
}

}  // namespace kaz::h8s
