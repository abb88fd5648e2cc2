// The cache of translated blocks: translation, lookup, execution and invalidation.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/translate/translator.h"

#include <algorithm>
#include <cstdlib>
#include <deque>
#include <new>
#include <set>
#include <vector>

#include "sim/h8s/translate/code_memory.h"
#include "sim/h8s/translate/emitter.h"

namespace kaz::h8s {

using namespace translate;

namespace {

constexpr std::size_t kMaxBlocks = 24, kMaxUnitSteps = 400;  // of one translation
constexpr std::size_t kMaxCode = 8u << 20;                   // bytes, then all code is discarded
constexpr std::uint32_t kNeverTranslate = 0xffffffff;  // Entry::count where no block can begin
constexpr std::uint32_t kMaxThreshold = 1u << 20;

// Times that a block was too long before it is translated for the end of a stretch too.
constexpr std::uint32_t kNearEnds = 32;

struct Free {
  void operator()(void* p) const { std::free(p); }
};

template <class T>
T* allocate(std::size_t count) {
  void* p = std::calloc(count, sizeof(T));
  if (!p) throw std::bad_alloc();
  return static_cast<T*>(p);
}

struct ErrorFlag : asmjit::ErrorHandler {
  bool any = false;
  void handleError(asmjit::Error, const char*, asmjit::BaseEmitter*) override { any = true; }
};

}  // namespace

struct Translator::Cache {
  std::unique_ptr<Entry[], Free> entries;
  std::unique_ptr<NearEnd[], Free> near_ends;
  CodeMemory memory;
  Gate gate;
  std::vector<std::uint32_t> touched;  // entries with code, or covered
  std::size_t bytes = 0;
  std::int64_t blocks = 0;
  std::int64_t executed = 0;        // instructions, in translated code
  std::uint32_t invalidations = 0;  // each doubles the threshold of translation
  bool unusable = false;            // the host gives no memory for code
  Cpu* cpu = nullptr;               // while its code runs

  // Entries of fresh pages cost nothing until they are touched.
  bool prepare(const Cpu& c) {
    if (!entries) {
      entries.reset(allocate<Entry>(c.code_size));
      near_ends.reset(allocate<NearEnd>(c.code_size));
    }
    return !unusable;
  }

  bool make_gate() {
    if (gate.enter) return true;
    asmjit::CodeHolder code;
    ErrorFlag errors;
    code.init(asmjit::Environment::host());
    code.setErrorHandler(&errors);
    host::Assembler a(&code);
    const GateLabels labels{a.newLabel(), a.newLabel(), a.newLabel(), a.newLabel(),
                            a.newLabel(), a.newLabel(), a.newLabel(), a.newLabel()};
    emit_gate(a, labels, entries.get());
    const void* const base = errors.any ? nullptr : memory.add(code);
    if (!base) return false;
    gate.enter = base;
    const auto at = [&](const asmjit::Label& label) {
      return static_cast<const char*>(base) + code.labelOffset(label);
    };
    gate.leave = at(labels.leave);
    gate.interpret = at(labels.interpret);
    gate.load8 = at(labels.load8);
    gate.load16 = at(labels.load16);
    gate.store8 = at(labels.store8);
    gate.store16 = at(labels.store16);
    gate.leave_complete = at(labels.leave_complete);
    gate.go_elsewhere = at(labels.go_elsewhere);
    return true;
  }

  std::vector<Block> find_blocks(Cpu& c, std::uint32_t start) const {
    std::vector<Block> blocks_found;
    std::set<std::uint32_t> known{start};
    std::deque<std::uint32_t> waiting{start};
    std::size_t steps = 0;
    const auto want = [&](std::uint32_t index) {
      // Code that has never run is not translated; code already translated is reached through its entry.
      if (!c.code[index].run || entries[index].code || entries[index].count == kNeverTranslate)
        return;
      if (known.insert(index).second) waiting.push_back(index);
    };
    std::set<std::uint32_t> found;
    while (!waiting.empty() && blocks_found.size() < kMaxBlocks && steps < kMaxUnitSteps) {
      const std::uint32_t at = waiting.front();
      waiting.pop_front();
      Block block = find_block(c, at, [&](std::uint32_t index) { return found.contains(index); });
      if (block.steps.empty()) {
        entries[at].count = kNeverTranslate;
        continue;
      }
      found.insert(at);
      steps += block.steps.size();
      for (const Step& s : block.steps) {
        const bool call = s.form.op == Op::bsr || s.form.op == Op::jsr;
        const bool indirect = s.form.src == Mode::indirect;
        if (s.form.op == Op::bcc || s.form.op == Op::bsr ||
            ((s.form.op == Op::jmp || s.form.op == Op::jsr) && !indirect))
          want(s.target);
        if (call || s.form.op == Op::interpreted) want(s.index + s.insn.units);
      }
      if (block.end == End::next) want(block.after);
      blocks_found.push_back(std::move(block));
    }
    return blocks_found;
  }

  void translate(Cpu& c, std::uint32_t start) {
    if (bytes > kMaxCode) forget_all();
    if (start >= c.ram_code) note_code_in_ram(c);
    const std::vector<Block> found = find_blocks(c, start);
    if (found.empty()) return;
    if (!make_gate()) {
      unusable = true;
      return;
    }
    for (const Block& block : found) decode(c, block);
    asmjit::CodeHolder code;
    ErrorFlag errors;
    code.init(asmjit::Environment::host());
    code.setErrorHandler(&errors);
    Emitter emitter(c, code, entries.get(), near_ends.get(), gate);
    emitter.emit(found);
    if (errors.any) {
      entries[start].count = kNeverTranslate;
      return;
    }
    const void* const base = add(code);
    if (!base) return;
    blocks += static_cast<std::int64_t>(found.size());
    for (std::size_t n = 0; n < found.size(); ++n) {
      entries[found[n].start].code = static_cast<const char*>(base) + emitter.entry_offset(code, n);
      near_ends[found[n].start].bound = static_cast<std::uint16_t>(found[n].bound);
      cover(found[n]);
    }
  }

  void translate_near_end(Cpu& c, std::uint32_t start) {
    if (bytes > kMaxCode || !c.code[start].run) return;
    const Block block = find_block(
        c, start, [&](std::uint32_t index) { return !c.code[index].run || entries[index].code; });
    if (block.steps.empty()) return;
    decode(c, block);
    asmjit::CodeHolder code;
    ErrorFlag errors;
    code.init(asmjit::Environment::host());
    code.setErrorHandler(&errors);
    Emitter emitter(c, code, entries.get(), near_ends.get(), gate);
    emitter.emit_near_end(block);
    if (errors.any) return;
    const void* const base = add(code);
    if (!base) return;
    near_ends[start].code = base;
    cover(block);
  }

  // Handlers need decoded operands; RAM with the instruction must be marked as holding code.
  static void decode(Cpu& c, const Block& block) {
    for (const Step& s : block.steps)
      if (!c.code[s.index].run || s.index >= c.ram_code) decode_in_place(c, c.code + s.index);
  }

  // Null: there is no memory for code, and what is there may no longer be executable.
  const void* add(asmjit::CodeHolder& code) {
    const void* const base = memory.add(code);
    if (!base) {
      forget_all();
      unusable = true;
      return nullptr;
    }
    bytes += code.codeSize();
    return base;
  }

  void cover(const Block& block) {
    touched.push_back(block.start);
    for (const Step& s : block.steps) {
      for (std::uint32_t u = 0; u < s.insn.units; ++u) {
        entries[s.index + u].covered = true;
        touched.push_back(s.index + u);
      }
    }
  }

  void forget_all() {
    for (const std::uint32_t index : touched) {
      entries[index] = {};
      near_ends[index] = {};
    }
    touched.clear();
    if (bytes != 0) {
      memory.clear();
      gate = {};
    }
    bytes = 0;
    if (cpu) cpu->code_discarded = true;
  }

  std::uint32_t threshold(const Cpu& c) const {
    return std::min(kMaxThreshold, c.translate_after << std::min(invalidations, 10u));
  }
};

Translator::Translator() : cache_(std::make_unique<Cache>()) {}
Translator::~Translator() = default;

std::int64_t Translator::translated() const {
  return cache_->blocks;
}

std::int64_t Translator::executed() const {
  return cache_->executed;
}

void Translator::reset_count() {
  cache_->executed = 0;
}

void Translator::hook_changed(std::uint32_t index) {
  Cache& cache = *cache_;
  if (!cache.entries) return;
  cache.entries[index].count = 0;
  if (cache.entries[index].covered) cache.forget_all();
}

void Translator::forget(std::uint32_t first, std::uint32_t count) {
  Cache& cache = *cache_;
  if (cache.touched.empty()) return;
  for (std::uint32_t k = first; k < first + count; ++k) {
    cache.entries[k].count = 0;
    if (!cache.entries[k].covered) continue;
    ++cache.invalidations;
    return cache.forget_all();
  }
}

void Translator::forget_all() {
  cache_->invalidations = 0;  // after a reset, say
  cache_->forget_all();
}

void Translator::run(Cpu& c) {
  Cache& cache = *cache_;
  if (!cache.prepare(c)) return run_interpreter(c);
  using Enter = std::uint32_t (*)(Cpu*, const void*);
  Entry* const entries = cache.entries.get();
  const std::uint32_t threshold = cache.threshold(c);
  bool arrived = true;  // at an instruction where a block may begin
  bool left = false;    // a block was left before an instruction that it does not contain
  while (c.now < c.stop) {
    const Insn* ip = c.ip;
    if (arrived && ip != &c.outside) {
      const auto index = static_cast<std::uint32_t>(ip - c.code);
      Entry& entry = entries[index];
      if (!entry.code && entry.count != kNeverTranslate && ++entry.count >= threshold)
        cache.translate(c, index);
      // A block may begin after an instruction that cannot begin one.
      left = entry.count == kNeverTranslate;
      if (entry.code) {
        NearEnd& near = cache.near_ends[index];
        if (c.stop - c.now <= near.bound && !near.code) {
          if (++near.count == std::min(kNearEnds, c.translate_after))
            cache.translate_near_end(c, index);
          return run_interpreter(c);
        }
        const auto enter =
            reinterpret_cast<Enter>(reinterpret_cast<std::uintptr_t>(cache.gate.enter));
        const std::int64_t before = c.executed;
        c.code_discarded = false;
        cache.cpu = &c;
        const std::uint32_t result = enter(&c, entry.code);
        cache.cpu = nullptr;
        cache.executed += c.executed - before;
        record_jump(c, nullptr, c.ip);
        if (c.now >= c.stop) return;
        if (result == kGoOn) continue;
        ip = c.ip;
        left = true;
      }
    }
    const Handler handler = ip->run ? ip->run : decode_in_place(c, ip);
    const Insn* next = ip + ip->units;
    c.now += ip->states;
    c.ip = handler(c, ip);
    ++c.executed;
    arrived = left || c.ip != next;
    left = false;
  }
}

std::unique_ptr<Translator> make_translator() {
  return std::make_unique<Translator>();
}

bool translator_available() {
  return true;
}

}  // namespace kaz::h8s
