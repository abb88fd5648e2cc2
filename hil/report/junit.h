// Writes JUnit XML for build servers.
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
  std::string message;  // reason of a failure or skip
  std::string detail;   // details of a failure
  std::string output;   // output of the case, whatever the verdict; may be empty
};

// One test suite. All calls of property() must precede the cases. finish() ends the suite and returns the
// XML text.
class JunitSuite {
 public:
  struct Counts {
    int passed = 0, failed = 0, left_out = 0, undecided = 0;
    int errors = 0;  // errors of the machine, not of the tested object
  };
  JunitSuite(const std::string& name, const Counts& counts, double seconds);
  void property(const std::string& name, const std::string& value);
  void add(const JunitCase& one);
  // Adds a case that could not finish, for example because the port was lost or the disk is full. The case
  // counts neither as passed nor as failed.
  void add_error(const std::string& group, const std::string& name, const std::string& message);
  std::string finish();

 private:
  void end_properties();

  std::string text_;
  bool in_properties_ = true;
};

}  // namespace kaz::hil
