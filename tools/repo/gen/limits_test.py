# The joints' limits: what is written, and what is refused where.
# SPDX-License-Identifier: Apache-2.0
import contextlib
import io
import os
import tempfile
import unittest

import limits

JOINTS = """// table
KZ_JOINT( 0, pan, 0, 3, 0, 0, 0, 1, 0)
KZ_JOINT( 1, tilt, 1, 3, 1, 0, 1, -1, 150)
"""
ROBOT = """<robot name="r">
  <joint name="pan" type="revolute"><limit lower="-1.5707" upper="1.57079"/></joint>
  <joint name="tilt" type="revolute">
    <limit lower="-0.5" upper="1"/>
  </joint>
</robot>
"""


class Limits(unittest.TestCase):
    def generate(self, robot, joints=JOINTS):
        """(exit code, header, message)"""
        with tempfile.TemporaryDirectory() as folder:
            paths = [os.path.join(folder, name) for name in ("robot.urdf", "joints.def", "out.h")]
            for path, text in zip(paths, (robot, joints)):
                with open(path, "w", encoding="utf-8") as out:
                    out.write(text)
            message = io.StringIO()
            with contextlib.redirect_stderr(message):
                code = limits.main(paths)
            header = ""
            if os.path.exists(paths[2]):
                with open(paths[2], encoding="utf-8") as source:
                    header = source.read()
            return code, header, message.getvalue()

    def refused(self, robot, where, what):
        code, header, message = self.generate(robot)
        self.assertEqual((code, header), (1, ""))
        self.assertIn(where, message)
        self.assertIn(what, message)

    def test_limits_are_rounded_inwards(self):
        code, header, _ = self.generate(ROBOT)
        self.assertEqual(code, 0)
        self.assertIn("#define KZ_LIMIT_LOWER_pan (-15707)\n#define KZ_LIMIT_UPPER_pan (15707)\n", header)
        self.assertIn("#define KZ_LIMIT_LOWER_tilt (-5000)\n#define KZ_LIMIT_UPPER_tilt (10000)\n", header)

    def test_missing_joint(self):
        self.refused(ROBOT.replace('"tilt"', '"nod"'), "robot.urdf:1:", "no joint 'tilt'")

    def test_missing_limit(self):
        self.refused(ROBOT.replace('<limit lower="-0.5" upper="1"/>', ""), "robot.urdf:3:", "no <limit>")

    def test_missing_upper(self):
        self.refused(ROBOT.replace(' upper="1"', ""), "robot.urdf:4:", "no 'upper'")

    def test_no_number(self):
        self.refused(ROBOT.replace('"-0.5"', '"half"'), "robot.urdf:4:", "is no number")

    def test_empty_range(self):
        self.refused(ROBOT.replace('"-0.5"', '"1.5"'), "robot.urdf:4:", "not below")

    def test_outside_the_potentiometer(self):
        # Mirrored, centre 15 degrees: code 1019 is at 15 - 507 * 190 / 1024 = -79.07 degrees, -1.3801 rad.
        self.refused(ROBOT.replace('"-0.5"', '"-1.3802"'), "robot.urdf:4:", "-1.3801")

    def test_damaged_xml(self):
        self.refused(ROBOT.replace("</robot>", ""), "robot.urdf:7:", "not well-formed")


if __name__ == "__main__":
    unittest.main()
