// Judges what the flash writer answers and what it leaves in flash and RAM, by shared/flash/protocol.h.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "tools/fuzz/flash_writer/writer_board.h"

namespace kaz::fuzz {

// Watches one conversation. Every byte that goes to the board has to pass sent(). It shares nothing
// with the writer but the protocol's constants: it finds the requests in the bytes itself.
class WriterJudge {
 public:
  WriterJudge(WriterBoard& board, WriterStart start);

  void sent(std::span<const std::uint8_t> bytes);
  // Takes and judges what the board has answered. Call at least once in 1/8 ms while it may answer.
  void look();
  // Checks that the board answers; then flash, RAM and the emulator's reports are judged.
  void finish();

  // The first error; empty: none.
  const std::string& complaint() const { return complaint_; }
  std::size_t answers() const { return answers_; }
  // The second stage is there up to here.
  std::uint32_t filled() const { return filled_; }
  // Calls `seen(type, status)` for each answer.
  std::function<void(std::uint8_t, std::uint8_t)> on_answer;

 private:
  struct Request {
    std::uint8_t type = 0, number = 0;
    std::vector<std::uint8_t> payload;
    bool answered = false;
    std::uint32_t number_at(std::size_t at, std::size_t bytes) const;
  };
  using Bytes = std::vector<std::uint8_t>;

  void complain(const std::string& what);
  void judge(const WriterAnswer& answer);
  // Why the answer is none to the request; empty: it is.
  std::string fault(const Request& request, const WriterAnswer& answer);
  std::string write_fault(const Request& request, const WriterAnswer& answer);
  static std::string line_fault(std::uint32_t wanted, const WriterAnswer& answer);
  std::string ram_fault(const Request& request, const WriterAnswer& answer);
  std::string flash_fault(const Request& request, const WriterAnswer& answer);
  bool is_protected(std::uint32_t address) const;
  bool is_complete() const;
  bool alive();
  void judge_program();
  void judge_flash();

  WriterBoard& board_;
  WriterStart start_;
  Bytes stream_;
  std::map<std::size_t, Request> requests_;  // by their place in the stream
  std::size_t answers_ = 0;
  std::uint32_t filled_;
  Bytes flash_before_, ram_before_;
  h8s::FlashStatistics statistics_before_;
  std::size_t misuse_before_;
  std::string complaint_;
};

}  // namespace kaz::fuzz
