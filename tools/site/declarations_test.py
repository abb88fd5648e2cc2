# Tests of what is read from a header, and of how its comments become Markdown.
# SPDX-License-Identifier: Apache-2.0
import unittest

import api
import declarations

HEADER = """// A lamp on a pin.
// SPDX-License-Identifier: Apache-2.0
//
// Bits:
//   0  on
//   1  blinking
#ifndef KAZ_LAMP_H
#define KAZ_LAMP_H

#include <string>

namespace kaz {

#define LAMP_BITS 2  // of a byte
#define LAMP_MASK \\
  3

// Brightness of a lamp.
struct Level {
  double share = 0;  // 0..1
};

namespace lamp_detail {
int hidden();
}  // namespace lamp_detail

class Lamp {
 public:
  explicit Lamp(int pin) : pin_(pin) {}
  // Switches it on, at `level`.
  void on(const Level& level = {}) {
    if (level.share > 0) {
      lit_ = true;  // not shown
    }
  }
  bool lit() const { return lit_; }  // now

  // ---- Faults

  // Empty: none.
  std::string fault() const;
  enum class Kind { led, bulb };
  std::function<void(int)> changed = [](int) {};  // called in on()
                                                  // and at its end

 private:
  void drive(int duty);
  bool lit_ = false;
};

// Of all lamps.
template <class T>
T sum(const std::vector<Lamp>& lamps, T first = T{1, 2});
inline bool operator==(const Level& a, const Level& b) {
  return a.share == b.share;
}

}  // namespace kaz

#endif
"""


class Declarations(unittest.TestCase):
    def setUp(self):
        self.top, self.items = declarations.read_header(HEADER)
        self.types = {item.name: item for item in self.items if item.kind == "type"}
        self.all = "\n".join(self.shown(self.items))

    def shown(self, items):
        for item in items:
            yield item.code
            yield from self.shown(item.members)

    def test_top_without_licence(self):
        self.assertEqual(self.top[0], "A lamp on a pin.")
        self.assertNotIn("SPDX", " ".join(self.top))

    def test_private_and_bodies_are_left_out(self):
        for hidden in ("drive", "lit_", "hidden", "not shown", "return", "KAZ_LAMP_H", "#include"):
            self.assertNotIn(hidden, self.all)

    def test_functions(self):
        members = self.types["Lamp"].members
        self.assertEqual(members[0].code, "explicit Lamp(int pin);")
        self.assertEqual(members[1].code, "void on(const Level& level = {});\nbool lit() const;  // now")
        self.assertEqual((members[1].names, members[1].text),
                         (["on", "lit"], ["Switches it on, at `level`."]))
        self.assertIn("T sum(const std::vector<Lamp>& lamps, T first = T{1, 2});", self.all)
        self.assertIn("inline bool operator==(const Level& a, const Level& b);", self.all)

    def test_section(self):
        sections = [item.name for item in self.types["Lamp"].members if item.kind == "section"]
        self.assertEqual(sections, ["Faults"])

    def test_constants_types_and_variables(self):
        self.assertIn("#define LAMP_BITS 2  // of a byte\n#define LAMP_MASK \\\n  3", self.all)
        self.assertIn("double share = 0;  // 0..1", self.types["Level"].code)
        self.assertIn("enum class Kind { led, bulb };", self.all)
        self.assertRegex(self.all,
                         r"changed = \[\]\(int\) \{\};  // called in on\(\)\n +// and at its end")


class Comments(unittest.TestCase):
    def markdown(self, *lines):
        documents = {
            "host/link/link.h": "api/include/host/link/link.h", "host/link/tty_link.h": "api/x/tty_link.h"
        }
        return api.Prose("host/link/link.h", documents).markdown(list(lines))

    def test_paragraphs_lists_and_columns(self):
        self.assertEqual(self.markdown("One", "and two.", "", "Three."), "One and two.\n\nThree.\n")
        self.assertEqual(self.markdown("Then", "- one", "  more", "- two"), "Then\n\n- one more\n- two\n")
        self.assertIn("```text\n0  on\n1  off\n```", self.markdown("Bits:", "  0  on", "  1  off"))

    def test_signs_of_markdown_are_text(self):
        self.assertEqual(self.markdown("a * b * c, <T>, x[0], `as_is * 2`, KZ_RX_*"),
                         "a \\* b \\* c, \\<T\\>, x\\[0\\], `as_is * 2`, KZ\\_RX\\_\\*\n")
        self.assertEqual(self.markdown("1986. It was."), "1986\\. It was.\n")

    def test_headers_are_links(self):
        self.assertEqual(self.markdown("See tty_link.h, link.h and other.h."),
                         "See [tty_link.h](../../../x/tty_link.h.md), link.h and other.h.\n")


unittest.main()
