// What values an option takes, in words instead of CLI11's notation of types and checks.
// SPDX-License-Identifier: Apache-2.0
#include "tools/kaz/values.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <utility>

namespace kaz::tools {
namespace {

// CLI11 joins the type and the descriptions of the checks by colons: "TEXT:{h8,native}", "N:INT in [1 - 14]",
// "INT:POSITIVE". A type's own name may contain a colon too: "ctl:PATH|manual".
struct Notation {
  std::string type;
  std::string choices;           // "h8,native"
  std::string number, min, max;  // "INT", "1", "14"
  std::string unit;              // behind the range, if its check has one: "m"
};

Notation notation(const CLI::Option& option) {
  Notation n;
  n.type = option.get_type_name();
  if (const auto brace = n.type.find(":{"); brace != std::string::npos && n.type.back() == '}') {
    n.choices = n.type.substr(brace + 2, n.type.size() - brace - 3);
    n.type.resize(brace);
  }
  const auto in = n.type.find(" in [");
  const auto colon = n.type.rfind(':', in);
  const auto dash = n.type.find(" - ", in);
  if (in != std::string::npos && colon != std::string::npos && dash != std::string::npos) {
    n.number = n.type.substr(colon + 1, in - colon - 1);
    n.min = n.type.substr(in + 5, dash - in - 5);
    const auto end = n.type.find(']', dash);
    n.max = n.type.substr(dash + 3, end - dash - 3);
    n.unit = n.type.substr(std::min(end + 1, n.type.size()));
    n.type.resize(colon);
  }
  if (n.type.ends_with(":POSITIVE")) n.type.resize(n.type.size() - 9);
  return n;
}

// "1e+08" in digits; other text as it is.
std::string plain(const std::string& text) {
  if (text.find("e+") == std::string::npos && text.find("e-") == std::string::npos) return text;
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  if (*end != '\0' || std::abs(number) > 1e15) return text;
  char digits[64];
  std::snprintf(digits, sizeof digits, "%.12f", number);
  std::string out = digits;
  out.resize(out.find_last_not_of('0') + 1);
  if (out.back() == '.') out.pop_back();
  return out;
}

std::string unit(const std::string& type) {
  static constexpr std::pair<const char*, const char*> kUnits[] = {
      {"V", "V"},     {"HZ", "Hz"},     {"M", "m"},       {"MS", "ms"},
      {"S", "s"},     {"PX", "px"},     {"SECONDS", "s"}, {"DEGREES", "degrees"},
      {"VOLTS", "V"}, {"KGM2", "kg m2"}};
  for (const auto& [name, text] : kUnits) {
    if (type == name) return std::string(" ") + text;
  }
  return "";
}

std::string bound(const Notation& n, const std::string& text) {
  if (n.type != "ADDRESS") return plain(text);
  const unsigned long long number = std::strtoull(text.c_str(), nullptr, 10);
  char hex[32];
  std::snprintf(hex, sizeof hex, number < 10 ? "%llu" : "0x%llx", number);
  return hex;
}

}  // namespace

std::string placeholder(const CLI::Option& option) {
  const Notation n = notation(option);
  if (!n.choices.empty()) {
    std::string all;
    for (const std::string& choice : choices(option)) all += (all.empty() ? "" : "|") + choice;
    return all;
  }
  if (n.type == "INT" || n.type == "UINT") return "N";
  return n.type == "FLOAT" ? "NUMBER" : n.type;
}

std::vector<std::string> choices(const CLI::Option& option) {
  const std::string list = notation(option).choices;
  return list.empty() ? std::vector<std::string>() : CLI::detail::split(list, ',');
}

std::string range(const CLI::Option& option) {
  const Notation n = notation(option);
  if (n.min.empty()) return "";
  return bound(n, n.min) + " to " + bound(n, n.max) + (n.unit.empty() ? unit(n.type) : n.unit);
}

std::string accepted(const CLI::Option& option) {
  const Notation n = notation(option);
  if (!n.choices.empty()) return alternatives(choices(option));
  if (n.min.empty()) return "";
  const bool whole = (n.number == "INT" || n.number == "UINT") && n.type != "ADDRESS";
  return (whole ? "a whole number from " : "") + range(option);
}

std::string default_text(const CLI::Option& option) {
  const std::string text = option.get_default_str();
  const bool list = text.size() > 1 && text.front() == '[' && text.back() == ']';
  return list ? text.substr(1, text.size() - 2) : plain(text);
}

std::string alternatives(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) text += i + 1 == words.size() ? " or " : ", ";
    text += words[i];
  }
  return text;
}

}  // namespace kaz::tools
