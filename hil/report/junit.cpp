// A test suite as XML, line by line.
// SPDX-License-Identifier: Apache-2.0
#include "hil/report/junit.h"

#include "hil/report/page.h"
#include "shared/base/xml_text.hpp"

namespace kaz::hil {

JunitSuite::JunitSuite(const std::string& name, const Counts& counts, double seconds) {
  text_ = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuite name=\"" + xml_text(name) +
          "\" tests=\"" +
          std::to_string(counts.passed + counts.failed + counts.left_out + counts.undecided +
                         counts.errors) +
          "\" failures=\"" + std::to_string(counts.failed) + "\" errors=\"" +
          std::to_string(counts.errors) + "\" skipped=\"" +
          std::to_string(counts.left_out + counts.undecided) + "\" time=\"" + fixed(seconds, 3) +
          "\">\n  <properties>\n";
}

void JunitSuite::property(const std::string& name, const std::string& value) {
  text_ += "    <property name=\"" + xml_text(name) + "\" value=\"" + xml_text(value) + "\"/>\n";
}

void JunitSuite::end_properties() {
  if (in_properties_) text_ += "  </properties>\n";
  in_properties_ = false;
}

void JunitSuite::add_error(const std::string& group, const std::string& name,
                           const std::string& message) {
  end_properties();
  text_ += "  <testcase classname=\"" + xml_text(group) + "\" name=\"" + xml_text(name) +
           "\"><error message=\"" + xml_text(message) + "\"/></testcase>\n";
}

void JunitSuite::add(const JunitCase& one) {
  end_properties();
  std::string inside;
  if (one.verdict == Verdict::left_out || one.verdict == Verdict::undecided) {
    const std::string why = one.verdict == Verdict::undecided ? "undecided: " : "";
    inside = "<skipped message=\"" + xml_text(why + one.message) + "\"/>";
  } else if (one.verdict == Verdict::failed) {
    inside =
        "<failure message=\"" + xml_text(one.message) + "\">" + xml_text(one.detail) + "</failure>";
  }
  if (!one.output.empty()) inside += "<system-out>" + xml_text(one.output) + "</system-out>";
  text_ += "  <testcase classname=\"" + xml_text(one.group) + "\" name=\"" + xml_text(one.name);
  if (one.seconds) text_ += "\" time=\"" + fixed(*one.seconds, 3);
  text_ += inside.empty() ? "\"/>\n" : "\">" + inside + "</testcase>\n";
}

std::string JunitSuite::finish() {
  end_properties();
  return text_ + "</testsuite>\n";
}

}  // namespace kaz::hil
