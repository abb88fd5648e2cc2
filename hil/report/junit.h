// JUnit XML, as build servers read it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "hil/report/verdict.h"

namespace kaz::hil {

struct JunitCase {
  std::string group, name;
  std::optional<double> seconds;
  Verdict verdict = Verdict::passed;
  std::string message;  // why it failed or was skipped
  std::string detail;   // of a failed one
  std::string output;   // of any, if not empty
};

// Properties first, then cases.
class JunitSuite {
 public:
  struct Counts {
    int passed = 0, failed = 0, left_out = 0, undecided = 0;
    int errors = 0;  // of the machine, not of what is tested
  };
  JunitSuite(const std::string& name, const Counts& counts, double seconds);
  void property(const std::string& name, const std::string& value);
  void add(const JunitCase& one);
  // A case that the machine did not let end: port, disk. Neither passed nor failed.
  void add_error(const std::string& group, const std::string& name, const std::string& message);
  std::string finish();

 private:
  void end_properties();

  std::string text_;
  bool in_properties_ = true;
};

}  // namespace kaz::hil
