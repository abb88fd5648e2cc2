// The protocol a second time, as expectations.
// SPDX-License-Identifier: Apache-2.0
#include "tools/fuzz/flash_writer/writer_judge.h"

#include <algorithm>
#include <cstdio>
#include <numeric>

#include "shared/flash/protocol.h"

namespace kaz::fuzz {
namespace {

constexpr std::uint32_t kFlash = 0x20000, kLine = 32;
constexpr std::uint32_t kBlocks[] = {0x0,    0x400,  0x800,   0xc00,   0x1000, 0x8000,
                                     0xc000, 0xe000, 0x10000, 0x18000, 0x20000};
constexpr std::size_t kVectorBlock = 0, kLoaderBlock = 6;

std::string hex(std::uint32_t value) {
  char text[16];
  std::snprintf(text, sizeof text, "0x%06x", value);
  return text;
}

std::string status(std::uint8_t value) {
  return "status " + std::to_string(value);
}

}  // namespace

std::uint32_t WriterJudge::Request::number_at(std::size_t at, std::size_t bytes) const {
  std::uint32_t value = 0;
  for (std::size_t k = 0; k < bytes && at + k < payload.size(); ++k)
    value = value << 8 | payload[at + k];
  return value;
}

WriterJudge::WriterJudge(WriterBoard& board, WriterStart start)
    : board_(board),
      start_(start),
      filled_(start == WriterStart::boot ? writer_second_stage() : writer_program_end()),
      flash_before_(board.memory(0, kFlash)),
      ram_before_(board.memory(kWriterRam, writer_program().size())),
      statistics_before_(board.chip().flash_statistics()),
      misuse_before_(board.chip().misuse().size()) {}

void WriterJudge::complain(const std::string& what) {
  if (complaint_.empty()) complaint_ = what;
}

bool WriterJudge::is_complete() const {
  return start_ != WriterStart::boot || filled_ == writer_program_end();
}

bool WriterJudge::is_protected(std::uint32_t address) const {
  const auto in = [&](std::size_t block) {
    return address >= kBlocks[block] && address < kBlocks[block + 1];
  };
  return start_ == WriterStart::loader && (in(kVectorBlock) || in(kLoaderBlock));
}

// Any place in the stream where a whole frame stands counts as a request: also within another one, and
// across a pause after which the board has thrown its beginning away.
void WriterJudge::sent(std::span<const std::uint8_t> bytes) {
  stream_.insert(stream_.end(), bytes.begin(), bytes.end());
  for (std::size_t at = 0; at + KZ_WRITER_OVERHEAD <= stream_.size(); ++at) {
    const std::uint8_t* header = stream_.data() + at;
    if (header[0] != KZ_WRITER_SYNC || (header[1] & KZ_WRITER_REPLY) || requests_.contains(at))
      continue;
    const std::size_t length = std::size_t{header[2]} << 8 | header[3];
    if (static_cast<std::uint8_t>(std::accumulate(header + 1, header + 6, 0u)) != 0xff ||
        length > KZ_WRITER_PAYLOAD_MAX || at + length + KZ_WRITER_OVERHEAD > stream_.size() ||
        writer_crc({header + 1, length + KZ_WRITER_OVERHEAD - 1}) != 0)
      continue;
    requests_[at] = {header[1], header[4], {header + 6, header + 6 + length}};
  }
}

void WriterJudge::look() {
  while (const auto answer = board_.take_answer()) judge(*answer);
  if (!board_.failure().empty()) complain(board_.failure());
}

void WriterJudge::judge(const WriterAnswer& answer) {
  ++answers_;
  if (on_answer) on_answer(answer.type, answer.status());
  if (answer.status() == KZ_WRITER_DAMAGED) {
    if (answer.type != KZ_WRITER_REPLY || answer.number != 0 || answer.payload.size() != 2)
      complain("a report of damage with type " + std::to_string(answer.type) + ", number " +
               std::to_string(answer.number) + " and a payload of " +
               std::to_string(answer.payload.size()) + " bytes");
    return;
  }
  std::string why = "no request matches this answer";
  // The latest first: earlier ones may have been lost.
  for (auto place = requests_.rbegin(); place != requests_.rend(); ++place) {
    Request& request = place->second;
    if (request.answered || (request.type | KZ_WRITER_REPLY) != answer.type ||
        request.number != answer.number)
      continue;
    why = fault(request, answer);
    if (why.empty()) {
      request.answered = true;
      return;
    }
  }
  complain("answer of type " + std::to_string(answer.type & ~KZ_WRITER_REPLY) + ", " +
           status(answer.status()) + ": " + why);
}

std::string WriterJudge::fault(const Request& request, const WriterAnswer& answer) {
  const auto plain = [&](std::uint8_t wanted) {
    if (answer.status() != wanted) return "expected " + status(wanted);
    return answer.payload.size() == 2 ? std::string() : "the payload is too long";
  };
  const auto is = [&](const Bytes& wanted) {
    if (answer.status() != KZ_WRITER_OK) return "expected " + status(KZ_WRITER_OK);
    return std::equal(answer.payload.begin() + 2, answer.payload.end(), wanted.begin(),
                      wanted.end())
               ? std::string()
               : "the contents differ from the expected contents";
  };
  const std::size_t length = request.payload.size();
  const std::uint32_t address = request.number_at(0, 4);
  if (request.type == KZ_WRITER_INFO) {
    const bool loader = start_ == WriterStart::loader;
    return is(loader ? Bytes{KZ_WRITER_PROTOCOL, 1, 0x21, 0x28}
                     : Bytes{KZ_WRITER_PROTOCOL, 0, 0xff, 0xff});
  }
  if (request.type == KZ_WRITER_RATE) {
    const bool valid = length == 1 && request.payload[0] >= KZ_WRITER_BRR_MIN &&
                       request.payload[0] <= KZ_WRITER_BRR_MAX;
    return plain(valid ? KZ_WRITER_OK : KZ_WRITER_ARGUMENTS);
  }
  if (request.type == KZ_WRITER_WRITE) return write_fault(request, answer);
  if (!is_complete()) return plain(KZ_WRITER_UNKNOWN);
  switch (request.type) {
    case KZ_WRITER_ERASE: {
      if (length != 1 || request.payload[0] > 9) return plain(KZ_WRITER_ARGUMENTS);
      const std::uint32_t from = kBlocks[request.payload[0]], to = kBlocks[request.payload[0] + 1];
      if (is_protected(from)) return plain(KZ_WRITER_PROTECTED);
      const Bytes now = board_.memory(from, to - from);
      if (!std::ranges::all_of(now, [](std::uint8_t byte) { return byte == 0xff; }))
        return "the block is not erased";
      return plain(KZ_WRITER_OK);
    }
    case KZ_WRITER_SUM: {
      if (length != 8 || address >= kFlash) return plain(KZ_WRITER_ARGUMENTS);
      const Bytes now = board_.memory(address, std::min(request.number_at(4, 4), kFlash - address));
      unsigned sum = 0, sums = 0;
      for (const std::uint8_t byte : now) sums += sum += byte;
      Bytes wanted;
      put_number(wanted, writer_crc(now), 2);
      put_number(wanted, sum, 2);
      put_number(wanted, sums, 2);
      return is(wanted);
    }
    case KZ_WRITER_READ: {
      const std::uint32_t size = request.number_at(4, 2);
      if (length != 6 || size > KZ_WRITER_DATA_MAX || address > kFlash - size)
        return plain(KZ_WRITER_ARGUMENTS);
      return is(board_.memory(address, size));
    }
    case KZ_WRITER_RUN: {
      const bool blank = board_.memory(0, 2) == Bytes{0xff, 0xff};
      return plain(blank ? KZ_WRITER_NOTHING : KZ_WRITER_OK);
    }
    default:
      return plain(KZ_WRITER_UNKNOWN);
  }
}

std::string WriterJudge::write_fault(const Request& request, const WriterAnswer& answer) {
  const std::uint32_t address = request.number_at(0, 4);
  if (answer.payload.size() != 4) return "the payload does not have 4 bytes";
  if (request.payload.size() < 4 || (request.payload.size() - 4) % kLine != 0 ||
      address % kLine != 0) {
    if (answer.status() != KZ_WRITER_ARGUMENTS) return "expected the status ARGUMENTS";
    // Without a whole address there is no line to name.
    return request.payload.size() < 4 ? "" : line_fault(address, answer);
  }
  return address >> 16 == 0xff ? ram_fault(request, answer) : flash_fault(request, answer);
}

// The line named in an answer distinguishes requests that have the same number.
std::string WriterJudge::line_fault(std::uint32_t wanted, const WriterAnswer& answer) {
  const auto low = static_cast<std::uint32_t>(answer.payload[2] << 8 | answer.payload[3]);
  if (low == (wanted & 0xffff)) return "";
  return "the answer names the line " + hex(low) + " instead of " + hex(wanted);
}

std::string WriterJudge::ram_fault(const Request& request, const WriterAnswer& answer) {
  const std::uint32_t from = request.number_at(0, 4);
  const std::uint32_t to = from + static_cast<std::uint32_t>(request.payload.size()) - 4;
  std::uint8_t wanted = KZ_WRITER_OK;
  if (start_ == WriterStart::loader || from < writer_second_stage() || to > writer_program_end()) {
    wanted = KZ_WRITER_PROTECTED;
  } else if (from > filled_) {
    wanted = KZ_WRITER_ARGUMENTS;
  } else if (!std::equal(request.payload.begin() + 4, request.payload.end(),
                         writer_program().begin() + (from - kWriterRam))) {
    wanted = KZ_WRITER_PROTECTED;
  }
  if (answer.status() != wanted) return "expected " + status(wanted) + " for the line " + hex(from);
  const std::string fault = line_fault(from, answer);
  if (fault.empty() && wanted == KZ_WRITER_OK) filled_ = std::max(filled_, to);
  return fault;
}

// A line that cannot be written stays as it was, so it still shows why.
std::string WriterJudge::flash_fault(const Request& request, const WriterAnswer& answer) {
  const auto bytes = static_cast<std::uint32_t>(request.payload.size()) - 4;
  std::uint32_t at = request.number_at(0, 4);
  std::uint8_t wanted = KZ_WRITER_OK;
  if (at > kFlash - bytes) wanted = KZ_WRITER_ARGUMENTS;
  for (std::uint32_t k = 0; k < bytes && wanted == KZ_WRITER_OK; k += kLine) {
    const Bytes now = board_.memory(at, kLine);
    const auto data = request.payload.begin() + 4 + k;
    if (is_protected(at)) {
      wanted = KZ_WRITER_PROTECTED;
    } else if (!std::equal(now.begin(), now.end(), data)) {
      bool blank = true;
      for (std::uint32_t n = 0; n < kLine; ++n) blank = blank && (data[n] & ~now[n]) == 0;
      if (blank) return "the line at " + hex(at) + " is not written";
      wanted = KZ_WRITER_NOT_BLANK;
    } else {
      at += kLine;
    }
  }
  if (answer.status() != wanted) return "expected " + status(wanted) + " for the line " + hex(at);
  return line_fault(at, answer);
}

// It may have work that takes up to a second, and no room for a request. Once it has answered, it has
// to answer at once.
bool WriterJudge::alive() {
  constexpr auto ms = WriterBoard::kMillisecond;
  const auto answers_query = [&](std::uint8_t number, h8s::States patience) {
    const auto frame = writer_frame(KZ_WRITER_INFO, number, {});
    board_.pause(30 * ms);
    const h8s::States end = board_.send(frame);
    sent(frame);
    const std::size_t place = stream_.size() - frame.size();
    board_.run(end - board_.now() + patience, [&] {
      look();
      return requests_[place].answered || !complaint_.empty();
    });
    return requests_[place].answered;
  };
  board_.pause(30 * ms);
  board_.run(30 * ms, [this] { return look(), false; });
  for (int k = 0; k < 8; ++k) {
    if (answers_query(static_cast<std::uint8_t>(k), 400 * ms))
      return answers_query(0xee, 40 * ms);  // 14 bytes at 4,800 baud
  }
  return false;
}

void WriterJudge::judge_program() {
  const Bytes now = board_.memory(kWriterRam, ram_before_.size());
  for (std::size_t k = 0; k < now.size(); ++k) {
    const auto at = kWriterRam + static_cast<std::uint32_t>(k);
    const std::uint8_t wanted = at < filled_ ? writer_program()[k] : ram_before_[k];
    if (now[k] != wanted) return complain("the writer's own program was changed at " + hex(at));
  }
}

void WriterJudge::judge_flash() {
  std::vector<bool> open(kFlash, false);
  const auto touch = [&](std::uint32_t from, std::uint32_t to) {
    for (std::uint32_t at = from; at < std::min(to, kFlash); ++at) open[at] = !is_protected(at);
  };
  for (const auto& [place, request] : requests_) {
    const std::uint32_t address = request.number_at(0, 4);
    if (request.type == KZ_WRITER_WRITE && request.payload.size() > 4 && address < kFlash)
      touch(address, address + static_cast<std::uint32_t>(request.payload.size()) - 4);
    if (request.type == KZ_WRITER_ERASE && request.payload.size() == 1 && request.payload[0] < 10)
      touch(kBlocks[request.payload[0]], kBlocks[request.payload[0] + 1]);
  }
  const Bytes now = board_.memory(0, kFlash);
  for (std::uint32_t at = 0; at < kFlash; ++at) {
    if (now[at] != flash_before_[at] && !open[at])
      return complain("the flash was changed at " + hex(at) + ", which was not requested");
  }
  const auto& statistics = board_.chip().flash_statistics();
  for (const std::size_t block : {kVectorBlock, kLoaderBlock}) {
    if (!is_protected(kBlocks[block])) continue;
    if (statistics.blocks[block].erase_pulses != statistics_before_.blocks[block].erase_pulses ||
        statistics.blocks[block].program_pulses != statistics_before_.blocks[block].program_pulses)
      complain("an erase or program pulse was applied to the protected block EB" +
               std::to_string(block));
  }
  if (statistics.errors != statistics_before_.errors)
    complain("the flash's error protection was triggered");
}

void WriterJudge::finish() {
  look();
  if (complaint_.empty() && !alive()) complain("the writer no longer answers requests");
  judge_program();
  judge_flash();
  const auto& misuse = board_.chip().misuse();
  if (misuse.size() != misuse_before_)
    complain("misuse of the chip: " + misuse.back().text + " at " + hex(misuse.back().pc));
}

}  // namespace kaz::fuzz
