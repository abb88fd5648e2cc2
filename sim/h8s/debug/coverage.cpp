// Instruction and branch coverage.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/debug/coverage.h"

#include <algorithm>
#include <cstdio>
#include <vector>

namespace kaz::h8s {

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
  std::vector<const Symbol*> functions;
  for (const Symbol& s : chip_.symbols().symbols()) {
    if (s.function) functions.push_back(&s);
  }
  char line[256];
  std::snprintf(line, sizeof line, "%7s %7s %7s %12s %9s  %s\n", "covered", "bytes", "share %",
                "entered", "one-way", "function");
  std::string out = line;
  for (std::size_t k = 0; k < functions.size(); ++k) {
    const std::uint32_t first = functions[k]->address;
    // The last function is taken to end at the last covered instruction.
    std::uint32_t end = k + 1 < functions.size() ? functions[k + 1]->address : first;
    std::int64_t covered = 0, one_way = 0;
    for (auto at = counts_.lower_bound(first);
         at != counts_.end() && (k + 1 == functions.size() || at->first < end); ++at) {
      covered += at->second.length;
      one_way += at->second.branch && (at->second.taken == 0 || at->second.passed == 0) ? 1 : 0;
      if (k + 1 == functions.size()) end = at->first + at->second.length;
    }
    const auto size = static_cast<std::int64_t>(end - first);
    if (size == 0) continue;
    const auto entered = counts_.find(first);
    std::snprintf(line, sizeof line, "%7lld %7lld %7.1f %12lld %9lld  %.120s\n",
                  static_cast<long long>(covered), static_cast<long long>(size),
                  100.0 * static_cast<double>(covered) / static_cast<double>(size),
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
  for (std::size_t k = 0; k < lines.size(); ++k) {
    std::int64_t count = 0;
    const std::uint32_t end = k + 1 < lines.size() ? lines[k + 1].address : lines[k].address + 2;
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
