// npm's @lerobot/web, unmodified, at the arm of `kaz sim --bus feetech`: reads, moves, releases, calibrates.
// SPDX-License-Identifier: Apache-2.0
// node lerobot.mjs KAZ ROBOT FOLDER
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { mkdirSync, rmSync } from "node:fs";
import { connect } from "node:net";
import { openWebSerial } from "./web_serial.mjs";

const client = (file) => import(`./node_modules/@lerobot/web/dist/${file}.js`);
const { readAllMotorPositions, readMotorPosition, lockMotors } = await client("utils/motor-communication");
const { WebSerialPortWrapper } = await client("utils/serial-port-wrapper");
const { teleoperate } = await client("teleoperate");
const { releaseMotors } = await client("release_motors");
const { calibrate } = await client("calibrate");

const [kaz, robot, folder] = process.argv.slice(2);
const port = `${folder}/arm`;
const ids = [1, 2, 3, 4, 5, 6];
const after = (ms) => new Promise((resolve) => setTimeout(resolve, ms));
const near = (value, expected, by, what) =>
  assert.ok(Math.abs(value - expected) <= by, `${what}: ${value}, expected ${expected} within ${by}`);

// Truth, by the control socket.
function status() {
  return new Promise((resolve, reject) => {
    const socket = connect(`${port}.ctl`, () => socket.write("status\n"));
    let text = "";
    socket.on("data", (data) => {
      text += data;
      if (text.includes("\n")) { socket.end(); resolve(JSON.parse(text)); }
    });
    socket.on("error", reject);
  });
}

rmSync(folder, { recursive: true, force: true });
mkdirSync(folder, { recursive: true });
const sim = spawn(kaz, ["sim", "--bus", "feetech", "--robot-file", robot, "--serial", port]);
let printed = "";
for (const stream of [sim.stdout, sim.stderr]) stream.on("data", (data) => { printed += data; });
const ended = new Promise((resolve) => sim.on("exit", resolve));
try {
  for (let i = 0; i < 200 && !printed.includes("ready"); ++i) await after(50);
  assert.match(printed, /ready: 6 servos/);
  const serial = openWebSerial(port, 1000000);
  const wrapper = new WebSerialPortWrapper(serial);
  const connection = { port: serial, robotType: "so100_follower", isConnected: true };

  // The arm falls until it lies; what the client reads then is where it is.
  await after(2500);
  const positions = await readAllMotorPositions(wrapper, ids);
  const truth = (await status()).servos;
  ids.forEach((id, i) => near(positions[i], truth[i].position, 2, `position of ${id}`));
  assert.ok(positions.some((position) => Math.abs(position - 2047) > 100), `it has not fallen: ${positions}`);

  // Off the floor, on which it would be held by friction.
  const operation = await teleoperate({ robot: connection, teleop: { type: "direct" } });
  operation.start();
  // One by one: its setMotorPositions() takes the port's only writer several times at once, and fails on any port.
  // It does not read the answer to a goal either: a request right behind one collides with that answer on the wire,
  // and an answer that was left is taken for a position (65532). So each is waited for here.
  const move = async (joint, position) => {
    assert.ok(await operation.teleoperator.moveMotor(joint, position));
    assert.equal((await wrapper.read(500)).length, 6);
  };
  await move("shoulder_lift", 2000);
  await move("elbow_flex", 2300);
  await move("gripper", 2400);
  await after(2500);
  const up = await readAllMotorPositions(wrapper, ids);
  near(up[1], 2000, 80, "shoulder_lift");
  near(up[2], 2300, 80, "elbow_flex");
  near(up[5], 2400, 30, "gripper");

  // It moves as a servo does: on the way first, there later.
  const start = await readMotorPosition(wrapper, 1);
  await move("shoulder_pan", start + 800);
  const way = [];
  while (way.length < 200 && !(way.at(-1) > start + 770)) way.push(await readMotorPosition(wrapper, 1));
  assert.ok(way.some((position) => position > start + 20 && position < start + 700), `its way: ${way}`);
  await after(1000);
  near(await readMotorPosition(wrapper, 1), start + 800, 30, "where it was sent");
  operation.stop();

  await lockMotors(wrapper, ids);
  assert.ok((await status()).servos.every((servo) => servo.torque === 1));
  await releaseMotors(connection);
  assert.ok((await status()).servos.every((servo) => servo.torque === 0));

  // Calibration: half a turn where it lies, then limits of what it saw.
  await after(2500);
  const calibration = await calibrate({ robot: connection });
  await after(4000);
  const centred = (await status()).servos;
  centred.forEach((servo) => near(servo.position, 2047, 2, `half turn of ${servo.joint}`));
  calibration.stop();
  const result = await calibration.result;
  assert.deepEqual(Object.keys(result), centred.map((servo) => servo.joint));
  for (const servo of centred) {
    const { range_min, range_max } = result[servo.joint];
    if (servo.joint === "wrist_roll") assert.deepEqual([range_min, range_max], [0, 4095]);
    else near(range_min, 2047, 3, `lower limit of ${servo.joint}`);
    assert.equal(servo.offset, result[servo.joint].homing_offset);
  }
  const limits = (await status()).servos;
  limits.forEach((servo) => {
    assert.equal(servo.min_angle, result[servo.joint].range_min);
    assert.equal(servo.max_angle, result[servo.joint].range_max);
  });

  const { servos, bytes_lost } = await status();
  assert.equal(bytes_lost, 0);
  for (const servo of servos) assert.equal(servo.bad_checksums + servo.framing_errors + servo.abandoned, 0);
  await serial.close();
} finally {
  sim.kill("SIGINT");
}
assert.equal(await ended, 0, printed);
process.stdout.write(printed);
process.exit(0);
