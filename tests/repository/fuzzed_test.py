# fuzzed.py finds a reader of outside bytes that is planted in a copy of the tree.
# SPDX-License-Identifier: Apache-2.0
"""usage: fuzzed_test.py ROOT"""

import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(sys.argv.pop(1))
FUZZED = pathlib.Path(__file__).with_name("fuzzed.py")
FOLDERS = ("shared", "sim", "host", "hil", "vision", "tools", "firmware", "python", "examples",
           "docs/results")

# The code, and what fuzzed.py says the file reads by.
PLANTED = {
    "auto a = ordered_json::parse(text);": "parse",
    "auto a = nlohmann::ordered_json::parse(text);": "parse",
    "using Json = nlohmann::json; auto a = Json::parse(text, nullptr, false);": "parse",
    "auto a = nlohmann::json::parse<std::string>(text);": "parse",
    "bool a = nlohmann::json::accept(text);": "accept",
    "bool a = json::sax_parse(text, &handler);": "sax_parse",
    "auto a = json::from_cbor(bytes);": "from_cbor",
    "auto a = read(fd, bytes, size);": "::read",
    "if (ready) read(fd, bytes, size);": "::read",
    "return ::read(fd, bytes, size);": "::read",
    "auto a = std::bind(::read, fd);": "::read",
    "auto a = std::bind(recv, fd);": "recv",
    "auto a = stream.read(bytes, deadline);": "read",
    "auto a = stream->read(bytes, deadline);": "read",
    "auto a = kaz::read_whole_file(path, 1 << 20);": "read_whole_file",
    "auto a = KAZ_TRY(read_whole_file(path, 1 << 20));": "read_whole_file",
    "boost::asio::async_read(socket, buffer, done);": "async_read",
    "socket.async_read_some(buffer, done);": "async_read_some",
    "auto a = recvmsg(fd, &message, 0);": "recvmsg",
    "auto a = std::fread(bytes, 1, size, file);": "fread",
    "auto a = preadv2(fd, parts, 1, 0, 0);": "preadv2",
    "std::ifstream file(path);": "ifstream",
    "std::cin >> number;": "cin",
    "auto a = std::from_chars(first, last, number);": "from_chars",
    "auto a = std::stoi(text);": "stoi",
    "auto a = 1'000 + read(fd, 'x');": "::read",
    "auto a = kaz::parse_number<int>(text);": "parse_number",
    "kaz::StateReader from(bytes);": "StateReader",
    "auto a = cv::imread(path);": "imread",
    '#include <tinyxml2.h>': "<tinyxml2.h>",
    '#include "png.h"': "<png.h>",
}
HARMLESS = """
// ordered_json::parse(text), read(fd, bytes, size)
const char* const kText = "read(fd, bytes, size)";
/* std::ifstream file(path); */
kaz::Result<int> read_my_header(int thread);
int a = read_my_header(1);
std::jthread worker([] { std::this_thread::yield(); });
"""


class Fuzzed(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.tree = pathlib.Path(folder.name)
        for name in FOLDERS:
            shutil.copytree(ROOT / name, cls.tree / name, ignore=shutil.ignore_patterns("node_modules"))

    def faults(self):
        run = subprocess.run([sys.executable, "-B", FUZZED, self.tree], stdout=subprocess.PIPE, text=True)
        self.assertEqual(run.returncode, 1, run.stdout)
        return run.stdout

    def test_finds_what_is_planted(self):
        folder = self.tree / "tools/planted"
        folder.mkdir()
        plants = {f"tools/planted/{number}.cpp": plant for number, plant in enumerate(PLANTED.items())}
        for name, (code, _) in plants.items():
            (self.tree / name).write_text(f"{code}\n")
        (folder / "harmless.cpp").write_text(HARMLESS)
        (folder / "unknown.cpp").write_text("#include <yaml-cpp/yaml.h>\n")
        (self.tree / "tools/viewer/page/other.ts").write_text("")
        (self.tree / "tools/planted/page/src").mkdir(parents=True)
        (self.tree / "tools/planted/page/src/planted.ts").write_text("JSON.parse(text)\n")
        # Files that have a target, a reason, and a reason for all files of a folder.
        listed = {"hil/fuzz/grammar.cpp": "auto a = Json::parse(text);\n",
                  "tools/bus/verb_bus.cpp": "auto a = ::recv(fd, bytes, size, 0);\n",
                  "sim/h8s/chip/adc.cpp": "auto a = ::read(fd, bytes, size);\n"}
        for name, code in listed.items():
            with (self.tree / name).open("a") as file:
                file.write(code)
        text = self.faults()
        for name, (code, by) in plants.items():
            self.assertRegex(text, rf"(?m)^{name}: reads by (\S+ )*{re.escape(by)} ", code)
        for name, by in zip(listed, ("parse", "recv", "::read")):
            self.assertRegex(text, rf"(?m)^{name}: reads by \(([^)]* )?{by}[ )].* names \(")
        self.assertIn("unknown.cpp: <yaml-cpp/yaml.h> is neither in", text)
        self.assertIn("planted/page/src/planted.ts: reads by script", text)
        self.assertNotIn("harmless.cpp", text)
        self.assertEqual(len(text.splitlines()), len(plants) + len(listed) + 2, text)


if __name__ == "__main__":
    unittest.main()
