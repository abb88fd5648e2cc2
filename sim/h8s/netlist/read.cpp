// The text form of netlists.
// SPDX-License-Identifier: Apache-2.0
#include <cctype>
#include <charconv>
#include <cmath>
#include <sstream>

#include "shared/base/files.hpp"
#include "sim/h8s/netlist/parts.h"

namespace kaz::h8s {
namespace {

struct Token {
  std::string text;
  std::size_t column;
};

class Line {
 public:
  Line(Netlist& netlist, std::string where, std::vector<Token> tokens, std::size_t end)
      : netlist_(netlist), where_(std::move(where)), tokens_(std::move(tokens)), end_(end) {}

  Result<void> build() {
    const std::string what = tokens_[0].text;
    next_ = 1;
    if (what == "pull-up" || what == "pull-down") return pull(what == "pull-up");
    if (what == "wire") return wire();
    if (what == "analog") return analog();
    if (what == "switch") return make_switch();
    if (what == "inverter") return inverter();
    if (what == "open-drain" || what == "probe") return simple(what);
    if (what == "rc" || what == "divider") return network(what == "rc");
    next_ = 0;
    return wrong(
        "pull-up, pull-down, wire, analog, switch, inverter, open-drain, rc, divider or probe");
  }

 private:
  bool more() const { return next_ < tokens_.size(); }

  tl::unexpected<Error> wrong(const std::string& expected) const {
    const bool here = more();
    const std::size_t column = here ? tokens_[next_].column : end_;
    return fail(where_ + ":" + std::to_string(column) + ": expected " + expected + ", found " +
                (here ? "'" + tokens_[next_].text + "'" : "the end of the line"));
  }
  Result<void> done() const {
    if (more()) return wrong("the end of the line");
    return {};
  }

  bool is_net() const {
    if (!more()) return false;
    const std::string& t = tokens_[next_].text;
    // A name of the form of a port's pin must be an existing pin.
    const auto digit = [&](std::size_t k) {
      return std::isdigit(static_cast<unsigned char>(t[k])) != 0;
    };
    if (t.size() == 3 && (t[0] == 'P' || t[0] == 'p') && digit(1) && digit(2))
      return find_pin(t).has_value();
    return std::isalpha(static_cast<unsigned char>(t[0])) || t[0] == '_';
  }
  Result<Net> net() {
    if (!is_net()) return wrong("a pin (P40, TxD1), vcc, gnd or the name of a net");
    return netlist_.net(tokens_[next_++].text);
  }

  // A number such as "4.7k" or "1u"; negative if invalid.
  static double number(std::string_view t, std::string_view unit) {
    double value = 0;
    const auto [rest, bad] = std::from_chars(t.data(), t.data() + t.size(), value);
    if (bad != std::errc{} || !std::isfinite(value) || value < 0) return -1;
    std::string_view tail(rest, static_cast<std::size_t>(t.data() + t.size() - rest));
    if (!unit.empty()) {
      if (!tail.ends_with(unit)) return -1;
      tail.remove_suffix(unit.size());
    }
    constexpr std::string_view letters = "kMmunp";
    constexpr double factors[] = {1e3, 1e6, 1e-3, 1e-6, 1e-9, 1e-12};
    if (tail.empty()) return value;
    const std::size_t k = letters.find(tail[0]);
    if (tail.size() != 1 || k == letters.npos) return -1;
    const double scaled = value * factors[k];
    return std::isfinite(scaled) ? scaled : -1;
  }
  Result<double> amount(const std::string& expected) {
    const double value = more() ? number(tokens_[next_].text, "") : -1;
    if (value <= 0) return wrong(expected);
    ++next_;
    return value;
  }
  // States, or seconds with "s"; negative if invalid.
  States time(std::string_view t) const {
    States states = 0;
    const auto [rest, bad] = std::from_chars(t.data(), t.data() + t.size(), states);
    if (bad == std::errc{} && rest == t.data() + t.size()) return states < 0 ? -1 : states;
    const double seconds = number(t, "s");
    if (seconds < 0 || seconds > 1e6) return -1;
    return std::llround(seconds * static_cast<double>(netlist_.settings().hertz));
  }

  Result<void> pull(bool up) {
    const auto at = KAZ_TRY(net());
    const auto ohms = KAZ_TRY(amount("ohms such as 10k"));
    if (auto ok = done(); !ok) return ok;
    netlist_.source(at, up ? 1 : 0, ohms, where_ + (up ? " pull-up" : " pull-down"));
    return {};
  }

  Result<void> wire() {
    std::vector<Net> nets;
    do {
      const auto n = KAZ_TRY(net());
      nets.push_back(n);
    } while (more() || nets.size() < 2);
    for (std::size_t k = 1; k < nets.size(); ++k) netlist_.wire(nets[0], nets[k]);
    return {};
  }

  Result<void> analog() {
    const auto at = KAZ_TRY(net());
    const double share = more() ? number(tokens_[next_].text, "") : -1;
    if (share < 0 || share > 1) return wrong("a share of AVCC from 0 to 1");
    ++next_;
    double ohms = 0;
    if (more()) {
      const auto given = KAZ_TRY(amount("ohms such as 10k, or nothing"));
      ohms = given;
    }
    if (auto ok = done(); !ok) return ok;
    netlist_.source(at, share, ohms, where_ + " analog");
    return {};
  }

  Result<void> make_switch() {
    const auto at = KAZ_TRY(net());
    if (!more() || (tokens_[next_].text != "vcc" && tokens_[next_].text != "gnd"))
      return wrong("vcc or gnd");
    const bool to_supply = tokens_[next_++].text == "vcc";
    const bool closed = more() && tokens_[next_].text == "closed";
    if (closed) ++next_;
    std::vector<std::pair<States, bool>> schedule;
    States last = -1;
    while (more()) {
      const std::string& t = tokens_[next_].text;
      const std::size_t dots = t.find("..");
      const States from = dots == t.npos ? -1 : time(t.substr(0, dots));
      const States to = dots == t.npos ? -1 : time(t.substr(dots + 2));
      if (from <= last || to <= from) return wrong("times such as 1ms..2ms, in ascending order");
      schedule.emplace_back(from, !closed);
      schedule.emplace_back(to, closed);
      last = to;
      ++next_;
    }
    Switch& part = netlist_.add(std::make_unique<Switch>(at, to_supply));
    part.set(netlist_, closed);
    for (const auto& [when, level] : schedule) part.set_at(netlist_, when, level);
    return {};
  }

  Result<void> inverter() {
    const auto in = KAZ_TRY(net());
    const auto out = KAZ_TRY(net());
    States delay = 0;
    if (more()) {
      delay = time(tokens_[next_].text);
      if (delay < 0) return wrong("a delay such as 20 (states) or 10ns");
      ++next_;
    }
    if (auto ok = done(); !ok) return ok;
    netlist_.add(std::make_unique<Inverter>(in, out, delay));
    return {};
  }

  Result<void> simple(const std::string& what) {
    const auto first = KAZ_TRY(net());
    if (what == "probe") {
      if (auto ok = done(); !ok) return ok;
      netlist_.add(std::make_unique<Probe>(first, tokens_[1].text));
      return {};
    }
    const auto out = KAZ_TRY(net());
    if (auto ok = done(); !ok) return ok;
    netlist_.add(std::make_unique<OpenDrain>(first, out));
    return {};
  }

  Result<void> network(bool rc) {
    const auto in = KAZ_TRY(net());
    const auto out = KAZ_TRY(net());
    const auto first = KAZ_TRY(amount("ohms such as 10k"));
    const auto second = KAZ_TRY(amount(rc ? "farads such as 100n" : "ohms such as 10k"));
    if (auto ok = done(); !ok) return ok;
    if (rc)
      netlist_.add(std::make_unique<Rc>(in, out, first, second));
    else
      netlist_.add(std::make_unique<Divider>(in, out, first, second));
    return {};
  }

  Netlist& netlist_;
  std::string where_;
  std::vector<Token> tokens_;
  std::size_t end_, next_ = 0;
};

}  // namespace

Result<void> read_netlist(Netlist& netlist, std::string_view text, const std::string& name) {
  std::istringstream in{std::string(text)};
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (const std::size_t comment = line.find('#'); comment != line.npos) line.resize(comment);
    std::vector<Token> tokens;
    std::size_t k = 0;
    while (k < line.size()) {
      if (std::isspace(static_cast<unsigned char>(line[k]))) {
        ++k;
        continue;
      }
      const std::size_t from = k;
      while (k < line.size() && !std::isspace(static_cast<unsigned char>(line[k]))) ++k;
      tokens.push_back({line.substr(from, k - from), from + 1});
    }
    if (tokens.empty()) continue;
    const std::size_t end = tokens.back().column + tokens.back().text.size();
    Line parsed(netlist, name + ":" + std::to_string(number), std::move(tokens), end);
    if (auto ok = parsed.build(); !ok) return ok;
  }
  return {};
}

Result<void> load_netlist(Netlist& netlist, const std::string& path) {
  const auto text = KAZ_TRY(read_whole_file(path, 1 << 20, "give a netlist"));
  if (text.empty()) return fail(path + ": the file is empty; give a netlist");
  return read_netlist(netlist, text, path);
}

}  // namespace kaz::h8s
