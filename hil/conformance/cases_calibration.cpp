// Cases of docs/reference/protocol.md, chapter Calibration.
// SPDX-License-Identifier: Apache-2.0
#include <vector>

#include "hil/conformance/suite.h"

namespace kaz::hil {
namespace {

struct Values {
  std::vector<long> centre, scale;
  bool operator==(const Values&) const = default;
};

Values values_of(const Reply& calibration) {
  Values values;
  for (int j = 0; j < KZ_JOINTS; ++j) {
    values.centre.push_back(calibration.number("centre", j));
    values.scale.push_back(calibration.number("scale", j));
  }
  return values;
}

Bytes calibrate_all(const Values& values) {
  Put put;
  put.u32(KZ_ALL_JOINTS);
  for (const long centre : values.centre) put.s16(centre);
  for (const long scale : values.scale) put.s16(scale);
  return put;
}

Bytes calibrate_one(int joint, long centre, long scale) {
  return Put().u32(1L << joint).s16(centre).s16(scale);
}

// Nominal values: centre of joints.def, 95 degrees with the sense of the potentiometer.
Values nominal() {
  Values values;
#define KZ_JOINT(index, name, pwm, port, bit, mux, input, sign, pot_centre) \
  values.centre.push_back(KZ_POT_CENTRE(pot_centre, sign));                 \
  values.scale.push_back((sign)*16581);
#include "shared/board/joints.def"
#undef KZ_JOINT
  return values;
}

void expect_valid(Board& b) {
  const Reply now = b.done("calibration");
  const bool stored = now["sequence"] != 0;
  equal("UNCALIBRATED", now.flag(KZ_STATUS_UNCALIBRATED), !stored);
  if (stored) {
    within("source", now["source"], KZ_CALIBRATION_A, KZ_CALIBRATION_B);
  } else {
    equal("source", now["source"], KZ_CALIBRATION_NOMINAL);
    check(values_of(now) == nominal(),
          "the board has no stored calibration, but does not use the nominal values");
  }
}

// Changes the calibration for the time of `then` and stores the old values again.
template <class Then>
void with_stored(Board& b, Then then) {
  const Values old = values_of(b.done("calibration"));
  const auto back = [&] {
    b.done("calibrate", calibrate_all(old));
    b.done("store_calibration", {}, 3000);
  };
  try {
    then(old);
  } catch (const Failed&) {
    b.begin(0);
    back();
    throw;
  }
  back();
}

void add_use(Chapter& to) {
  to.add("reported",
         "`calibration` reports the values, their source, the copy number and the flash wear.",
         "CAL-1", [](Board& b) {
           const Reply now = b.done("calibration");
           within("erasures of A", now["erases_a"], 0, 100);
           within("erasures of B", now["erases_b"], 0, 100);
           for (int j = 0; j < KZ_JOINTS; ++j) {
             const Values usual = nominal();
             const auto i = static_cast<std::size_t>(j);
             within("center of joint " + std::to_string(j), now.number("centre", j),
                    usual.centre[i] - KZ_CENTRE_TOLERANCE, usual.centre[i] + KZ_CENTRE_TOLERANCE);
           }
         });
  to.add(
      "nominal",
      "If a calibration is stored, the board uses the stored values. If no calibration is stored, "
      "the board uses nominal values and sets UNCALIBRATED.",
      "CAL-5", [](Board& b) { expect_valid(b); });
  to.add("set", "`calibrate` changes only the values of the joints in the request's mask.", "CAL-2",
         [](Board& b) {
           const Values before = values_of(b.done("calibration"));
           b.done("calibrate", calibrate_one(3, before.centre[3] + 200, before.scale[3] - 100));
           const Values after = values_of(b.done("calibration"));
           Values wanted = before;
           wanted.centre[3] += 200;
           wanted.scale[3] -= 100;
           check(after == wanted, "the values differ from the values that were set");
         });
  to.add("set-all", "`calibrate` sets all 18 joints at once.", "CAL-2", [](Board& b) {
    Values wanted = nominal();
    for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
      wanted.centre[j] += 10 * static_cast<long>(j) - 90;
      wanted.scale[j] += 7 * static_cast<long>(j);
    }
    b.done("calibrate", calibrate_all(wanted));
    check(values_of(b.done("calibration")) == wanted,
          "the values differ from the values that were set");
  });
  to.add("angle-follows", "A new center changes the reported angles immediately.", "CAL-2",
         [](Board& b) {
           const Values before = values_of(b.done("calibration"));
           const long angle = b.angle(0);
           b.done("calibrate", calibrate_one(0, before.centre[0] + 1000, before.scale[0]));
           b.wait(5);
           within("angle", b.angle(0), angle + 960, angle + 1040);
         });
  to.add(
      "angle-follows-scale", "A new scale changes the reported angles immediately.", "CAL-2",
      [](Board& b) {
        b.bench().place_joint(0, 0.8);
        b.done("calibrate", calibrate_one(0, 0, 16581 * 9 / 8));
        b.wait(20);
        within("angle", b.angle(0), 8950, 9050);
      },
      kBench);
  to.add("until-reset", "A reset discards values that were not stored.", "CAL-2", [](Board& b) {
    const Values before = values_of(b.done("calibration"));
    b.done("calibrate", calibrate_one(2, before.centre[2] + 100, before.scale[2]));
    b.reset_by_command();
    check(values_of(b.done("calibration")) == before, "a calibration in RAM survived a reset");
  });
  to.add(
      "armed", "`calibrate` and `store_calibration` are refused while a motor is on.", "CAL-2",
      [](Board& b) {
        const Values now = values_of(b.done("calibration"));
        b.enable(1);
        b.refused("calibrate", calibrate_one(1, now.centre[1], now.scale[1]), KZ_REFUSED_ARMED);
        b.refused("store_calibration", {}, KZ_REFUSED_ARMED);
        b.enable(0);
        b.done("calibrate", calibrate_one(1, now.centre[1], now.scale[1]));
      },
      kMotion);
  const Values usual = nominal();
  for (const int joint : {0, 1, 6, 17}) {
    const auto i = static_cast<std::size_t>(joint);
    const long centre = usual.centre[i], scale = usual.scale[i];
    const long quarter = (scale > 0 ? scale : -scale) / 4;
    to.add("range-" + std::to_string(joint),
           "For joint " + std::to_string(joint) +
               ", a center or scale too far from nominal is refused with RANGE.",
           "CAL-2", [=](Board& b) {
             const Values before = values_of(b.done("calibration"));
             for (const long wrong :
                  {centre - KZ_CENTRE_TOLERANCE - 1, centre + KZ_CENTRE_TOLERANCE + 1}) {
               b.refused("calibrate", calibrate_one(joint, wrong, scale), KZ_REFUSED_RANGE, joint);
             }
             for (const long wrong : {scale - quarter - 2, scale + quarter + 2, -scale, 0L}) {
               b.refused("calibrate", calibrate_one(joint, centre, wrong), KZ_REFUSED_RANGE, joint);
             }
             check(values_of(b.done("calibration")) == before, "a refused calibration was applied");
             b.done("calibrate",
                    calibrate_one(joint, centre - KZ_CENTRE_TOLERANCE, scale - quarter + 1));
             b.done("calibrate",
                    calibrate_one(joint, centre + KZ_CENTRE_TOLERANCE, scale + quarter - 1));
           });
  }
}

void add_store(Chapter& to) {
  to.add(
      "store", "Stored values are used after a reset.", "CAL-4",
      [](Board& b) {
        with_stored(b, [&](const Values& old) {
          Values wanted = old;
          for (std::size_t j = 0; j < KZ_JOINTS; ++j) wanted.centre[j] += 5 + static_cast<long>(j);
          const long number = b.done("calibration")["sequence"];
          b.done("calibrate", calibrate_all(wanted));
          const Reply stored = b.done("store_calibration", {}, 3000);
          check(stored["sequence"] != number && stored["sequence"] != 0,
                "the new copy has the same number as the previous copy");
          b.reset_by_command();
          const Reply after = b.done("calibration");
          check(values_of(after) == wanted, "the stored values are not used after the reset");
          equal("number of the copy", after["sequence"], stored["sequence"]);
          check(!after.flag(KZ_STATUS_UNCALIBRATED), "UNCALIBRATED is set");
          within("source", after["source"], KZ_CALIBRATION_A, KZ_CALIBRATION_B);
        });
      },
      kFlash);
  to.add(
      "store-answers",
      "The board replies to `store_calibration` within 3 s and increases the number of the copy "
      "by 1.",
      "CAL-3",
      [](Board& b) {
        long number = b.done("calibration")["sequence"];
        for (int n = 0; n < 3; ++n) {
          const Time start = b.now();
          const Reply stored = b.done("store_calibration", {}, 3000);
          check(seconds(b.now() - start) < 3.0 + seconds(b.slack()), "storing took more than 3 s");
          equal("number of the copy", stored["sequence"], number + 1);
          ++number;
        }
      },
      kFlash);
  to.add(
      "store-many",
      "When a flash block is full, storing continues in the other block, and the wear is reported.",
      "CAL-1",
      [](Board& b) {
        const Reply before = b.done("calibration");
        Reply stored = b.done("store_calibration", {}, 3000);
        for (int n = 0; n < 12; ++n) stored = b.done("store_calibration", {}, 3000);
        equal("number of the copy", stored["sequence"], before["sequence"] + 13);
        const long erases = stored["erases_a"] + stored["erases_b"];
        within("erasures for 13 copies", erases - before["erases_a"] - before["erases_b"], 1, 4);
        b.reset_by_command();
        equal("number of the copy after a reset", b.done("calibration")["sequence"],
              stored["sequence"]);
      },
      kFlash | kBench);  // 13 copies are much for the life of a real part
  to.add(
      "power-lost",
      "If power is lost while the board stores a copy, the old or the new copy remains valid.",
      "CAL-4",
      [](Board& b) {
        with_stored(b, [&](const Values& old) {
          b.done("store_calibration", {}, 3000);
          Values wanted = old;
          for (int n = 0; n < 12; ++n) {
            const Values before = values_of(b.done("calibration"));
            wanted.centre[0] = old.centre[0] + 10 + n;
            b.done("calibrate", calibrate_all(wanted));
            b.write(b.request_bytes("store_calibration"));
            b.wait(2 + static_cast<int>(b.random()() % 12));
            b.bench().set_power(false);
            b.wait(20);
            b.bench().set_power(true);
            b.wait(200);
            b.forget_frames();  // the answer, if the store was quicker
            const Reply after = b.done("calibration");
            check(values_of(after) == before || values_of(after) == wanted,
                  "neither the old nor the new values are used");
            check(!after.flag(KZ_STATUS_UNCALIBRATED), "no valid copy is left");
          }
        });
      },
      kFlash | kBench);
}

}  // namespace

void add_calibration_cases(Cases& all) {
  Chapter to(all, "calibration", kNothing);
  add_use(to);
  add_store(to);
}

}  // namespace kaz::hil
