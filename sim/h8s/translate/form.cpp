// Parses rows of the opcode table by their names and operand texts.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/translate/form.h"

#include <map>
#include <string_view>
#include <vector>

#include "sim/h8s/cpu/flags.h"

namespace kaz::h8s::translate {
namespace {

struct Named {
  std::string_view name;
  Op op;
  std::uint8_t detail;
};

constexpr std::uint8_t shift_kind(Shift s) {
  return static_cast<std::uint8_t>(s);
}

constexpr Named kNames[] = {
    {"nop", Op::nop, 0},
    {"mov", Op::mov, 0},
    {"add", Op::add, 0},
    {"sub", Op::sub, 0},
    {"cmp", Op::cmp, 0},
    {"and", Op::bit_and, 0},
    {"or", Op::bit_or, 0},
    {"xor", Op::bit_xor, 0},
    {"addx", Op::addx, 0},
    {"subx", Op::subx, 0},
    {"adds", Op::adds, 0},
    {"subs", Op::adds, 1},
    {"inc", Op::inc, 0},
    {"dec", Op::dec, 0},
    {"neg", Op::neg, 0},
    {"not", Op::bit_not, 0},
    {"extu", Op::extu, 0},
    {"exts", Op::exts, 0},
    {"shll", Op::shift, shift_kind(Shift::shll)},
    {"shal", Op::shift, shift_kind(Shift::shal)},
    {"shlr", Op::shift, shift_kind(Shift::shlr)},
    {"shar", Op::shift, shift_kind(Shift::shar)},
    {"rotxl", Op::shift, shift_kind(Shift::rotxl)},
    {"rotl", Op::shift, shift_kind(Shift::rotl)},
    {"rotxr", Op::shift, shift_kind(Shift::rotxr)},
    {"rotr", Op::shift, shift_kind(Shift::rotr)},
    {"mulxu", Op::mulxu, 0},
    {"mulxs", Op::mulxs, 0},
    {"divxu", Op::handler, 0},
    {"divxs", Op::handler, 0},
    {"daa", Op::handler, 0},
    {"das", Op::handler, 0},
    {"stc", Op::handler, 0},
    {"ldc", Op::interpreted, 0},
    {"andc", Op::interpreted, 0},
    {"orc", Op::interpreted, 0},
    {"xorc", Op::interpreted, 0},
    {"tas", Op::interpreted, 0},
    {"trapa", Op::interpreted, 1},
    {"rte", Op::rte, 0},
    {"sleep", Op::interpreted, 1},
    {"eepmov", Op::interpreted, 1},
    {"bset", Op::bset, 0},
    {"bnot", Op::bnot, 0},
    {"bclr", Op::bclr, 0},
    {"bst", Op::bst, 0},
    {"bist", Op::bst, 1},
    {"btst", Op::btst, 0},
    {"bor", Op::bor, 0},
    {"bior", Op::bor, 1},
    {"bxor", Op::bxor, 0},
    {"bixor", Op::bxor, 1},
    {"band", Op::band, 0},
    {"biand", Op::band, 1},
    {"bld", Op::bld, 0},
    {"bild", Op::bld, 1},
    {"bra", Op::bcc, 0x0},
    {"brn", Op::bcc, 0x1},
    {"bhi", Op::bcc, 0x2},
    {"bls", Op::bcc, 0x3},
    {"bcc", Op::bcc, 0x4},
    {"bcs", Op::bcc, 0x5},
    {"bne", Op::bcc, 0x6},
    {"beq", Op::bcc, 0x7},
    {"bvc", Op::bcc, 0x8},
    {"bvs", Op::bcc, 0x9},
    {"bpl", Op::bcc, 0xa},
    {"bmi", Op::bcc, 0xb},
    {"bge", Op::bcc, 0xc},
    {"blt", Op::bcc, 0xd},
    {"bgt", Op::bcc, 0xe},
    {"ble", Op::bcc, 0xf},
    {"bsr", Op::bsr, 0},
    {"jmp", Op::jmp, 0},
    {"jsr", Op::jsr, 0},
    {"rts", Op::rts, 0},
    {"stm", Op::stm, 0},
    {"ldm", Op::ldm, 0},
};

// Splits operands at commas outside parentheses.
std::vector<std::string_view> split(std::string_view text) {
  std::vector<std::string_view> parts;
  int depth = 0;
  std::size_t start = 0;
  for (std::size_t k = 0; k < text.size(); ++k) {
    if (text[k] == '(') ++depth;
    if (text[k] == ')') --depth;
    if (text[k] == ',' && depth == 0) {
      parts.push_back(text.substr(start, k - start));
      start = k + 1;
    }
  }
  if (!text.empty()) parts.push_back(text.substr(start));
  return parts;
}

Mode mode_of(std::string_view text) {
  if (text.starts_with("#") || text == "%j") return Mode::imm;
  if (text.starts_with("%")) return Mode::reg;
  if (text.starts_with("@(%d")) return Mode::indirect;
  if (text.starts_with("@%a")) return Mode::absolute;
  if (text.starts_with("@-%")) return Mode::decrement;
  if (text.starts_with("@%")) return text.ends_with("+") ? Mode::increment : Mode::indirect;
  return Mode::none;
}

// "(er4-er6)" of ldm and stm.
void take_group(Form& form, std::string_view text) {
  const std::size_t at = text.find("(er");
  form.first = static_cast<std::uint8_t>(text[at + 3] - '0');
  form.count = static_cast<std::uint8_t>(text[at + 7] - '0' - form.first + 1);
}

Form classify(const Opcode& opcode) {
  Form form;
  std::string_view name = opcode.name;
  if (const std::size_t dot = name.find('.'); dot != std::string_view::npos) {
    const char size = name[dot + 1];
    form.size = size == 'b' ? 1 : size == 'w' ? 2 : 4;
    name = name.substr(0, dot);
  }
  for (const Named& known : kNames) {
    if (known.name == name) form.op = known.op, form.detail = known.detail;
  }
  if (form.op == Op::adds) form.size = 4;
  const auto operands = split(opcode.operands);
  if (form.op == Op::stm || form.op == Op::ldm) {
    take_group(form, operands[form.op == Op::stm ? 0 : 1]);
    return form;
  }
  // STC to memory may end at a register; STC to a register only reads.
  if (name == "stc" && operands[1] != "%s") form.op = Op::interpreted;
  if (operands.size() == 2) form.src = mode_of(operands[0]);
  if (!operands.empty()) form.dst = mode_of(operands.back());
  if (operands.size() == 2 && operands[1] == "ccr" && form.src == Mode::imm && name != "ldc") {
    form.op = Op::control;
    form.detail = static_cast<std::uint8_t>(name == "andc"  ? Control::bit_and
                                            : name == "orc" ? Control::bit_or
                                                            : Control::bit_xor);
  }
  if (form.op == Op::jmp || form.op == Op::jsr) {
    form.src = form.dst;
    if (form.src == Mode::none) form.op = Op::interpreted, form.detail = 1;  // by the vector table
  }
  if (!operands.empty() && operands[0].size() == 2 && operands[0][0] == '#' &&
      operands[0][1] != '%')
    form.count = static_cast<std::uint8_t>(operands[0][1] - '0');
  if ((form.op == Op::shift || form.op == Op::inc || form.op == Op::dec) && form.count == 0)
    form.count = 1;
  form.number_in_register = form.src == Mode::reg;
  return form;
}

}  // namespace

const Form& form_of(const Opcode& opcode) {
  static const std::map<const Opcode*, Form> forms = [] {
    std::map<const Opcode*, Form> all;
    for (auto group : {move_opcodes(), arithmetic_opcodes(), shift_opcodes(), bit_opcodes(),
                       branch_opcodes(), system_opcodes()}) {
      for (const Opcode& row : group) all.emplace(&row, classify(row));
    }
    return all;
  }();
  return forms.at(&opcode);
}

}  // namespace kaz::h8s::translate
