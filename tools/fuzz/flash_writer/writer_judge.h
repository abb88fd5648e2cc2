// Checks the flash writer's answers, and its changes of flash and RAM, against shared/flash/protocol.h.
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

// Observes one conversation with the writer. The judge shares no code with the writer, only the protocol's
// constants, and parses the requests itself. `board` must outlive the judge.
class WriterJudge {
 public:
  WriterJudge(WriterBoard& board, WriterStart start);

  // Call sent() with all bytes that are sent to the board.
  void sent(std::span<const std::uint8_t> bytes);
  // Takes and judges the board's answers. Call look() at least every 1/8 ms as long as the board may answer.
  void look();
  // Checks that the board still answers. Then judges flash, RAM and the emulator's reports of misuse.
  void finish();

  // Returns the first violation. Empty: no violation.
  const std::string& complaint() const { return complaint_; }
  std::size_t answers() const { return answers_; }
  // Returns the address after the stored part of the second stage.
  std::uint32_t filled() const { return filled_; }
  // Called with type and status of each answer.
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
  // Each of these functions returns the reason why the answer does not fit the request. Empty: the answer
  // fits.
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
  std::map<std::size_t, Request> requests_;  // key: position of the request in the stream
  std::size_t answers_ = 0;
  std::uint32_t filled_;
  Bytes flash_before_, ram_before_;
  h8s::FlashStatistics statistics_before_;
  std::size_t misuse_before_;
  std::string complaint_;
};

}  // namespace kaz::fuzz
