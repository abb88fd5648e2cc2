// The board's page in headless Chromium, opened from file://: frames, joints, potentiometers, watchdog, speed.
// SPDX-License-Identifier: Apache-2.0
// node page.mjs BOARD_SCRIPT IMAGE PAGE SCRIPT VECTORS FOLDER: pictures go to FOLDER. Exit status 77: no chromium.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { existsSync, mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";
import { small } from "./small_png.mjs";

const [native, image, built, scriptPath, vectorsPath, folder] = process.argv.slice(2);
const executablePath = ["/usr/bin/chromium", "/usr/bin/chromium-browser"].find((path) => existsSync(path));
if (!executablePath) {
  console.log("skipped: chromium is not installed (apt-get install chromium)");
  process.exit(77);
}
mkdirSync(folder, { recursive: true });
const script = readFileSync(scriptPath, "utf8");
// What the native board does with a script.
function onThisMachine(commands) {
  const done = spawnSync(native, ["--image", image, commands], { encoding: "utf8", maxBuffer: 1 << 26 });
  assert.equal(done.status, 0, `${native}: ${done.error ?? done.stderr}`);
  return done.stdout;
}

const browser = await chromium.launch({ executablePath, args: ["--no-sandbox"] });
const wrong = [];
try {
  const page = await browser.newPage({ viewport: { width: 1280, height: 900 } });
  page.setDefaultTimeout(60000);
  page.on("console", (message) => { if (message.type() === "error") wrong.push(message.text()); });
  page.on("pageerror", (error) => wrong.push(String(error)));
  page.on("request", (request) => { if (!/^(file|data|blob):/.test(request.url())) wrong.push(`asks for ${request.url()}`); });
  await page.goto(pathToFileURL(`${built}/index.html`).href);
  await page.waitForFunction(() => window.kaz?.simulated() > 200);
  const view = () => page.evaluate(() => window.kaz.view());
  const run = (ms) => page.evaluate((ticks) => window.kaz.run(ticks), ms);
  const text = (id) => page.locator(`#${id}`).textContent();

  // State for state and byte for byte, as on this machine.
  const expected = onThisMachine(script).split("\n");
  const got = (await page.evaluate((commands) => window.kaz.script(commands, true), script)).split("\n");
  expected.forEach((line, i) => assert.equal(got[i], line, `line ${i + 1} of the script's output`));
  console.log(`script: ${expected.length} lines equal`);

  // The codec against the golden vectors, which a codec in Python made.
  const vectors = JSON.parse(readFileSync(vectorsPath, "utf8")).messages;
  const coded = await page.evaluate((list) => list.map(({ message, fields, body }) => {
    const table = window.kaz.messages.find(({ name }) => name === message);
    const hex = [...window.kaz.pack(table, fields)].map((byte) => byte.toString(16).padStart(2, "0")).join("");
    return { hex, decoded: window.kaz.decode(body).values };
  }), vectors);
  assert(vectors.length > 100);
  vectors.forEach(({ name, body, fields }, i) => {
    assert.equal(coded[i].hex, body.slice(6), name);
    assert.deepEqual(coded[i].decoded, fields, name);
  });

  // Pause and step by the keyboard.
  await page.locator("h1").click();
  await page.evaluate(() => window.kaz.fresh(true));
  await page.keyboard.press(" ");
  await page.waitForFunction(() => window.kaz.running());
  await page.keyboard.press(" ");
  await page.waitForFunction(() => !window.kaz.running());
  await page.evaluate(() => window.kaz.fresh(true));
  const before = (await view()).states;
  await page.keyboard.press(".");
  assert.equal((await view()).states - before, 18432);
  await run(99);

  // A message filled in and sent: bytes before they go out, and the answer.
  await page.locator("#keep").check();
  await page.locator("#message").selectOption({ label: "telemetry (0x12)" });
  await page.locator("[name=period_ms]").fill("20");
  await page.locator("[name=selection]").fill("15");
  const preview = (await text("preview")).replaceAll(" ", "");
  await page.locator("#form button").click();
  await run(30);
  await page.locator("#message").selectOption({ label: "enable (0x02)" });
  await page.locator("[name='joint.1']").check();
  assert.equal(await page.locator("[name=mask]").inputValue(), "3");
  await page.locator("#form button").click();
  await run(30);
  await page.locator("#message").selectOption({ label: "targets (0x03)" });
  await page.locator("[name='joint.1']").check();
  await page.locator("[name=duration_ms]").fill("200");
  await page.locator("[name='angle.0']").fill("5000");
  await page.locator("[name='angle.1']").fill("-1000");
  await page.locator("#form button").click();
  await run(400);
  const entries = () => page.evaluate(() => window.kaz.entries());
  const answers = async (code) => (await entries()).filter(({ out, body }) => !out && parseInt(body.slice(2, 4), 16) === code);
  assert((await entries()).some(({ out, wire }) => out && wire === preview), "other bytes went out than were shown");
  assert.equal((await answers(0x92)).length, 1, "telemetry_reply");
  assert.equal((await answers(0x82)).length, 1, "enable_reply");
  assert.equal((await answers(0x82))[0].body.slice(-8), "00000003");
  assert.equal((await answers(0x83)).length, 1, "targets_reply");
  assert((await answers(0xc0)).length > 15, "telemetry");

  // The joints went there: by the firmware, by the stand, in telemetry, in the table.
  const moved = (await view()).joints;
  assert(Math.abs(moved[0].measured - 5000) < 120, `joint 0 is at ${moved[0].measured}`);
  assert(Math.abs(moved[0].angle - 0.5) < 0.012 && Math.abs(moved[1].angle + 0.1) < 0.012);
  const telemetry = async () => (await page.evaluate((body) => window.kaz.decode(body).values, (await answers(0xc0)).at(-1).body)).angle;
  assert(Math.abs((await telemetry())[0] - 5000) < 120);
  assert.match(await page.locator("#joints tbody tr").first().textContent(), /neck_pan28\.\d°2[789]\.\d°/);
  assert.match(await text("verdict"), /on: neck_pan, neck_tilt/);
  await page.screenshot({ path: `${folder}/moved.png` });

  // All of that again on this machine: what was sent, at the same times; the same bytes come back at the same states.
  const list = await entries();
  const commands = [];
  let at = 0;
  for (const { out, at: when, wire } of list) {
    if (!out) continue;
    if (when > at) commands.push(`run ${(when - at) / 18432}`);
    at = when;
    commands.push(`raw ${wire}`);
  }
  const end = (await view()).states;
  commands.push(`run ${(end - at) / 18432}`);
  const lines = onThisMachine(commands.join("\n")).trimEnd().split("\n");
  assert.deepEqual(list.filter(({ out }) => !out).map(({ at: when, wire }) => `${when} ${wire}`),
    lines.filter((line) => line.startsWith("in ")).map((line) => line.split(" ").slice(1, 3).join(" ")));
  const last = lines.at(-1).split(" ");
  const now = await view();
  assert.equal(last[3], String(now.chip_states), "states");
  assert.equal(last[5], String(now.instructions), "instructions");
  console.log(`by hand: ${list.length} entries, ${now.chip_states} states, equal`);

  // A hand turns a potentiometer, by the keyboard: the A/D code, the firmware and telemetry have it.
  const code = (await view()).joints[4].code;
  await page.locator("#hand-l_elbow").focus();
  for (let i = 0; i < 40; ++i) await page.keyboard.press("ArrowLeft");
  await run(400);
  const turned = (await view()).joints[4];
  assert(Math.abs(turned.hand - turned.angle) < 0.02, `the hand is at ${turned.hand}, the shaft at ${turned.angle}`);
  assert(turned.angle < -0.3 && Math.abs(turned.code - code) > 60, `code ${code} became ${turned.code}`);
  assert(Math.abs((await telemetry())[4] - 1e4 * turned.angle) < 100, "telemetry does not have it");
  await page.locator("[aria-label='let go of l_elbow']").click();

  // Bytes by hand: a wrong check is counted.
  await page.locator("#raw").fill("00 04 01 01 2f 82 bf be 00");
  await page.locator("#raw-form button[type=submit]").click();
  await run(20);
  await page.locator("#message").selectOption({ label: "statistics (0x0a)" });
  await page.locator("#form button").click();
  await run(30);
  const statistics = await page.evaluate((body) => window.kaz.decode(body).values, (await answers(0x8a)).at(-1).body);
  assert.equal(statistics.bad_check, 1);
  await page.locator("#raw").fill("0x4");
  await page.locator("#raw-form button[type=submit]").click();
  assert.match(await text("raw-note"), /hex/);
  await page.locator("#raw-copy").click();

  // The person stops sending: the link watchdog switches the motors off, and the page says so.
  assert((await view()).drivers);
  await page.locator("#keep").uncheck();
  await run(40);  // at most 40 ms since the last heartbeat, and the limit is 90
  assert((await view()).drivers, "off before the limit");
  await run(100);
  const silent = await view();
  assert(!silent.drivers && silent.servo.shutdown === 2, "the watchdog did not switch the motors off");
  assert.match(await text("verdict"), /off, latched: link lost/);
  await page.screenshot({ path: `${folder}/watchdog.png` });
  // `clear` forgets it.
  await page.locator("#message").selectOption({ label: "clear (0x08)" });
  await page.locator("#form button").click();
  await run(30);
  assert.match(await text("verdict"), /off: no joint is enabled/);

  // Power and reset.
  await page.locator("#power").click();
  await run(20);
  assert.match(await text("verdict"), /no power/);
  await page.locator("#power").click();
  await run(100);
  assert((await view()).servo.tick > 20 && (await view()).servo.tick < 100);
  await page.locator("#reset").click();
  await run(60);
  assert((await view()).servo.tick < 60);
  await page.locator("#registers summary").click();
  await page.waitForFunction(() => window.kaz.view().registers?.some(([, name]) => name === "TCR"));

  // A picture with something in it: a joint that follows its targets, its last reply opened.
  await page.locator("#registers summary").click();
  await page.evaluate(() => window.kaz.fresh(true));
  await page.locator("#keep").check();
  await run(60);
  const pick = (name) => page.locator("#message").selectOption({ label: name });
  await pick("telemetry (0x12)");
  await page.locator("[name=period_ms]").fill("100");
  await page.locator("[name=selection]").fill("1");
  await page.locator("#form button").click();
  await pick("enable (0x02)");
  await page.locator("[name=mask]").fill("1023");
  await page.locator("#form button").click();
  await run(40);
  await pick("targets (0x03)");
  await page.locator("[name=duration_ms]").fill("500");
  for (const angle of [8000, -6000, 3000, -9000]) {
    await page.locator("[name='angle.0']").fill(String(angle));
    await page.locator("#form button").click();
    for (let i = 0; i < 60; ++i) await run(30);
  }
  await page.locator("#show-telemetry").uncheck();
  await pick("joints (0x11)");
  await page.locator("#form button").click();
  await run(20);
  await page.locator("#log summary").first().click();
  await page.setViewportSize({ width: 1240, height: 1050 });
  await run(1);
  await page.evaluate(() => { for (const side of document.querySelectorAll("#left, aside")) side.scrollTop = 0; });
  writeFileSync(`${folder}/page.png`, await small(page, await page.screenshot()));
  await page.locator("#log summary").first().click();
  await page.locator("#show-telemetry").check();

  // Narrow, dark, and nothing sticks out.
  await page.locator("#theme").click();
  await page.setViewportSize({ width: 380, height: 800 });
  assert(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), "the page is wider than its window");
  await page.screenshot({ path: `${folder}/narrow.png` });
  await page.setViewportSize({ width: 1280, height: 900 });

  // Every control has a name.
  const nameless = await page.evaluate(() => [...document.querySelectorAll("button, input, select, meter")].filter((control) =>
    !(control.textContent?.trim() || control.getAttribute("aria-label") || control.labels?.length)).map(({ outerHTML }) => outerHTML));
  assert.deepEqual(nameless, []);

  // At rest with telemetry of everything each 20 ms: how fast, by the page's own clock.
  await page.evaluate(() => window.kaz.fresh(true));
  await page.locator("#keep").check();
  await run(60);
  await page.locator("#message").selectOption({ label: "telemetry (0x12)" });
  await page.locator("[name=period_ms]").fill("20");
  await page.locator("[name=selection]").fill("15");
  await page.locator("#form button").click();
  await page.locator("#pace").selectOption("0");
  await page.locator("#run").click();
  const speeds = [];
  for (let i = 0; i < 7; ++i) {
    const [from, ms] = await page.evaluate(() => [window.kaz.simulated(), performance.now()]);
    await page.waitForTimeout(1000);
    const [to, later] = await page.evaluate(() => [window.kaz.simulated(), performance.now()]);
    speeds.push((to - from) / (later - ms));
  }
  speeds.sort((a, b) => a - b);
  console.log(`speed at rest with telemetry: median ${speeds[3].toFixed(1)} x real time (${speeds.map((s) => s.toFixed(1)).join(" ")})`);
  assert(speeds.at(-1) > 1, "slower than the board itself");
  assert.match(await text("speed"), /× real time/);
  assert.deepEqual(wrong, [], "errors in the console, or requests");
} finally {
  await browser.close();
}
