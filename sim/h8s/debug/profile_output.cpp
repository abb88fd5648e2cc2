// A profile as a table, as JSON and for KCachegrind.
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "sim/h8s/debug/profile.h"

namespace kaz::h8s {
namespace {

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    if (static_cast<unsigned char>(c) >= 0x20) out += c;
  }
  return out + "\"";
}

std::string number(std::int64_t n) {
  return std::to_string(n);
}

double share(States part, States whole) {
  return whole == 0 ? 0.0 : 100.0 * static_cast<double>(part) / static_cast<double>(whole);
}

}  // namespace

std::string Profile::text() const {
  std::string out;
  char line[256];
  std::snprintf(line, sizeof line, "%lld states, and %lld asleep\n", static_cast<long long>(total_),
                static_cast<long long>(asleep_));
  out += line;
  std::snprintf(line, sizeof line, "%6s %10s %12s %7s %7s %8s  %s\n", "self %", "self",
                "with callees", "calls", "median", "worst", "function");
  out += line;
  for (const FunctionProfile& f : functions()) {
    std::snprintf(line, sizeof line, "%6.2f %10lld %12lld %7lld %7lld %8lld  %.120s%s\n",
                  share(f.self, total_), static_cast<long long>(f.self),
                  static_cast<long long>(f.with_callees), static_cast<long long>(f.calls),
                  static_cast<long long>(f.median), static_cast<long long>(f.worst), f.name.c_str(),
                  f.interrupt ? " (interrupt)" : "");
    out += line;
  }
  if (!window_) return out;
  const WorstWindow w = worst_window();
  std::snprintf(line, sizeof line,
                "\n%lld ticks: median %lld states, worst %lld (from state %lld), spent in\n",
                static_cast<long long>(w.windows), static_cast<long long>(w.median),
                static_cast<long long>(w.worst), static_cast<long long>(w.at));
  out += line;
  for (const FunctionProfile& f : w.functions) {
    std::snprintf(line, sizeof line, "%6.2f %10lld  %.120s\n", share(f.self, w.worst),
                  static_cast<long long>(f.self), f.name.c_str());
    out += line;
  }
  return out;
}

std::string Profile::json() const {
  std::string out = "{\"states\":" + number(total_);
  out.append(",\"asleep\":").append(number(asleep_)).append(",\"functions\":[");
  bool first = true;
  for (const FunctionProfile& f : functions()) {
    out.append(first ? "\n" : ",\n").append("{\"name\":").append(quoted(f.name));
    out.append(",\"address\":").append(number(f.address));
    out.append(",\"interrupt\":").append(f.interrupt ? "true" : "false");
    out.append(",\"calls\":").append(number(f.calls));
    out.append(",\"self\":").append(number(f.self));
    out.append(",\"with_callees\":").append(number(f.with_callees));
    out.append(",\"median\":").append(number(f.median));
    out.append(",\"worst\":").append(number(f.worst)).append("}");
    first = false;
  }
  out += "]";
  if (window_) {
    const WorstWindow w = worst_window();
    out.append(",\n\"ticks\":{\"count\":").append(number(w.windows));
    out.append(",\"median\":").append(number(w.median));
    out.append(",\"worst\":").append(number(w.worst));
    out.append(",\"worst_at\":").append(number(w.at)).append(",\"functions\":[");
    first = true;
    for (const FunctionProfile& f : w.functions) {
      out.append(first ? "\n" : ",\n").append("{\"name\":").append(quoted(f.name));
      out.append(",\"self\":").append(number(f.self)).append("}");
      first = false;
    }
    out += "]}";
  }
  return out + "}\n";
}

std::string Profile::callgrind() const {
  const SymbolTable& symbols = chip_.symbols();
  const auto line_of = [&](std::uint32_t pc) {
    const SourceLine* line = symbols.line_at(pc);
    return line ? line->line : 0u;
  };
  const auto file_of = [&](std::uint32_t pc) {
    const SourceLine* line = symbols.line_at(pc);
    return line && !line->file.empty() ? line->file : std::string("(unknown)");
  };
  const auto position = [&](std::uint32_t pc) {
    char text[48];
    std::snprintf(text, sizeof text, "0x%x %u", pc, line_of(pc));
    return std::string(text);
  };
  std::string out =
      "# callgrind format\nversion: 1\ncreator: kaz-h8s\npositions: instr line\n"
      "events: States\n";
  out.append("summary: ").append(number(total_)).append("\n");
  std::map<std::uint32_t, std::map<std::uint32_t, States>> costs;
  for (const auto& [key, states] : by_address_)
    costs[static_cast<std::uint32_t>(key >> 32)][static_cast<std::uint32_t>(key)] += states;
  for (const auto& [function, lines] : costs) {
    out.append("\nfl=").append(file_of(function)).append("\nfn=").append(name_of(function));
    out += "\n";
    for (const auto& [pc, states] : lines)
      out.append(position(pc)).append(" ").append(number(states)).append("\n");
    for (const auto& [key, edge] : edges_) {
      const auto& [caller, pc, callee] = key;
      if (caller != function) continue;
      out.append("cfi=").append(file_of(callee)).append("\ncfn=").append(name_of(callee));
      out.append("\ncalls=").append(number(edge.calls)).append(" ").append(position(callee));
      out.append("\n").append(position(pc)).append(" ").append(number(edge.states)).append("\n");
    }
  }
  return out;
}

}  // namespace kaz::h8s
