// The servo board in a page: the chip runs here, a person is the host.
// SPDX-License-Identifier: Apache-2.0
import "./view/style.css";
import "./style.css";
import { Chip, type View } from "./chip";
import { element, put } from "./dom";
import { Joints } from "./joints";
import { Log } from "./log";
import { MessageForm } from "./message_form";
import { decode, flagsOf, joints, pack, messages, reasonOf, unpack } from "./protocol";
import { Plot } from "./view/plot";

const STATES_PER_MS = 18432, BUDGET_MS = 12, SHOW_MS = 100;
const root = document.documentElement;
// Storage may be refused: a page of file:// in some browsers.
const stored = (() => { try { return localStorage.getItem("theme"); } catch { return null; } })();
root.classList.toggle("dark", stored === "dark" || (stored === null && matchMedia("(prefers-color-scheme: dark)").matches));
element("theme").onclick = () => {
  const dark = root.classList.toggle("dark");
  try { localStorage.setItem("theme", dark ? "dark" : "light"); } catch { /* as above */ }
  show();
};

const chip = await Chip.load();
let running = true, stopped = chip.begin(true), powered = true;
let simulated = 0;         // ms since the page began
let due = 0;               // of `simulated`, by the pace
let last = performance.now();
let measured = { at: last, simulated: 0, speed: 0 };
let view: View = chip.view(false);
let shownAt = 0, plotted = -1;  // when, by the page's clock; states of the plot's newest point

const log = new Log();
const plot = new Plot(element("plot", HTMLCanvasElement));
const table = new Joints(() => chip, () => show());
const form = new MessageForm(() => chip, () => show());

const pace = element("pace", HTMLSelectElement), runButton = element("run", HTMLButtonElement);
const keep = element("keep", HTMLInputElement), keepMs = element("keep-ms", HTMLInputElement);
const chosen = element("joint", HTMLSelectElement), broken = element("broken", HTMLInputElement);
const registers = element("registers", HTMLDetailsElement);
const open = new Set<number>();
for (const [i, { name }] of joints.entries()) chosen.add(new Option(name, String(i)));

function advance(milliseconds: number): void {
  if (stopped || milliseconds <= 0) return;
  stopped = chip.run(milliseconds);
  simulated += milliseconds;
}

// As much as the pace wants, at most what leaves time for the page.
const channel = new MessageChannel();
channel.port1.onmessage = () => slice();
function slice(): void {
  const begin = performance.now(), times = Number(pace.value);
  if (running && !stopped) {
    due += times * Math.min(begin - last, 100);
    if (times === 0) {
      do advance(2); while (performance.now() - begin < BUDGET_MS && !stopped);
    } else {
      while (due >= 1 && performance.now() - begin < BUDGET_MS && !stopped) {
        const piece = Math.min(2, Math.floor(due));
        advance(piece);
        due -= piece;
      }
      due = Math.min(due, 100 * times);  // what a slow machine or a hidden page has missed is not made up for
    }
  }
  last = begin;
  if (begin - measured.at >= 500) {
    measured = { at: begin, simulated, speed: (simulated - measured.simulated) / (begin - measured.at) };
  }
  if (begin - shownAt >= SHOW_MS) show();
  if (running && times === 0 && !document.hidden) channel.port2.postMessage(0); else setTimeout(slice, 4);
}

function setRunning(on: boolean): void {
  running = on;
  put(runButton, on ? "pause" : "run");
  show();
}
function step(): void {
  setRunning(false);
  advance(1);
  show();
}
runButton.onclick = () => setRunning(!running);
element("step").onclick = step;
element("reset").onclick = () => { chip.reset(); stopped = ""; show(); };
element("power").onclick = () => {
  powered = !powered;
  chip.power(powered);
  stopped = "";
  put(element("power"), powered ? "cut the power" : "switch the power on");
  element("power").setAttribute("aria-pressed", String(!powered));
  show();
};
addEventListener("keydown", (event) => {
  const target = event.target as HTMLElement;
  if (event.ctrlKey || event.altKey || event.metaKey || /^(INPUT|SELECT|BUTTON|SUMMARY|TEXTAREA)$/.test(target.tagName)) return;
  if (event.key === " ") { event.preventDefault(); setRunning(!running); }
  if (event.key === ".") step();
});
const keepAlive = () => { chip.keepAlive(keep.checked ? Math.max(1, Number(keepMs.value) || 1) : 0); };
keep.onchange = keepMs.oninput = keepAlive;
element("supply").oninput = () => { chip.supply(Number(element("supply", HTMLInputElement).value) || 0); };
chosen.onchange = () => { plot.joint = Number(chosen.value); broken.checked = open.has(plot.joint); show(); };
broken.onchange = () => {
  if (broken.checked) open.add(plot.joint); else open.delete(plot.joint);
  chip.potOpen(plot.joint, broken.checked);
};
registers.ontoggle = () => show();

function list(target: HTMLElement, rows: [string, string][]): void {
  while (target.children.length > 2 * rows.length) target.lastChild?.remove();
  for (const [i, [term, text]] of rows.entries()) {
    if (!target.children[2 * i]) target.append(document.createElement("dt"), document.createElement("dd"));
    put(target.children[2 * i], term);
    put(target.children[2 * i + 1], text);
  }
}
const hex = (value: number, digits: number) => value.toString(16).padStart(digits, "0");

function verdict(): string {
  const { servo, power } = view;
  if (!power) return "no power: nothing drives the motors";
  if (!servo) return "off";
  if (servo.shutdown) return `off, latched: ${reasonOf(servo.shutdown)}${servo.detail < joints.length ? ` (${joints[servo.detail]?.name})` : ""}`
    + "; the message clear forgets it";
  if (servo.status & 4) return "held where they were by the link watchdog: the message clear lets them off";
  return servo.enabled ? `on: ${joints.filter((_, i) => servo.enabled >>> i & 1).map(({ name }) => name).join(", ")}`
    : "off: no joint is enabled";
}

function show(): void {
  shownAt = performance.now();
  view = chip.view(registers.open);
  log.add(chip.line());
  log.draw();
  table.show(view);
  put(element("time"), `${(view.states / STATES_PER_MS / 1000).toFixed(3)} s`);
  put(element("speed"), running && !stopped ? `${measured.speed.toFixed(measured.speed < 10 ? 1 : 0)} × real time` : "paused");
  put(element("stopped"), stopped && `the chip has stopped: ${stopped.split("\n")[0]}; reset it, or switch it off and on`);
  element("stopped").title = stopped;
  put(element("verdict"), verdict());
  element("safety").classList.toggle("on", view.power && (view.servo?.enabled ?? 0) !== 0);
  element("safety").classList.toggle("latched", view.power && (view.servo?.shutdown ?? 0) !== 0);
  const { servo } = view;
  put(element("shutdown"), servo && view.power ? reasonOf(servo.shutdown)
    + (servo.shutdown ? ` at ${servo.shutdown_tick} ms after the reset` : "") : "–");
  put(element("status"), servo && view.power ? flagsOf("STATUS", servo.status & 255).join(", ") || "nothing" : "–");
  const silence = servo && view.power ? servo.silent_ms : 0, limit = servo?.watchdog_ms ?? 0;
  const meter = element("watchdog", HTMLMeterElement);
  meter.max = limit || 1;
  meter.value = Math.min(silence, limit || 1);
  put(element("silence"), servo && view.power ? `${silence} ms without a valid frame, limit ${limit} ms` : "–");
  put(element("volts"), `${view.supply_volts.toFixed(2)} V at ${view.supply_amperes.toFixed(2)} A; drivers ${view.driver_celsius.toFixed(1)} °C`);
  if (view.states !== plotted && view.servo && view.power) plot.add({
    seconds: view.states / STATES_PER_MS / 1000, names: joints.map(({ name }) => name),
    target: view.joints.map(({ target }) => target / 1e4), measured: view.joints.map(({ measured: angle }) => angle / 1e4),
    duty: view.joints.map(({ duty }) => view.drivers ? duty : 0),
  });
  plotted = view.states;
  plot.draw();
  list(element("chip"), [
    ["states", `${view.chip_states.toLocaleString("en")} since power-on`], ["instructions", view.instructions.toLocaleString("en")],
    ["PC", `${hex(view.pc, 6)} ${view.symbol}`], ["next", `${view.next}${view.asleep ? " (asleep)" : ""}`],
    ["CCR", `${hex(view.ccr, 2)} ${[..."IUHUNZVC"].map((flag, i) => view.ccr >> 7 - i & 1 ? flag : "·").join("")}`],
    ["ER0 to ER3", view.er.slice(0, 4).map((er) => hex(er, 8)).join(" ")], ["ER4 to ER7", view.er.slice(4).map((er) => hex(er, 8)).join(" ")],
  ]);
  list(element("pins"), [
    ...Object.entries(view.ports).map(([port, level]): [string, string] =>
      [`${port} 7…0`, (level >>> 0).toString(2).padStart(8, "0") + (port === "P4" ? ` drivers ${view.drivers ? "on" : "off"}, multiplexer ${level & 7}` : "")]),
    ["PW0 to PW15", `${view.pw.join(" ")} of 256`], ["TMO0, TMO1", `${view.tmo.join(" ")} of 256`],
  ]);
  if (view.registers) {
    const units = new Map<string, string[]>();
    for (const [unit, name, , size, value] of view.registers)
      units.set(unit, [...units.get(unit) ?? [], `${name} ${hex(value, 2 * size)}`]);
    const target = registers.querySelector("dl");
    if (target) list(target, [...units].map(([unit, texts]) => [unit, texts.join("  ")]));
  }
}

// A new board, with the supply, wires and heartbeats that the page shows.
function begin(noise: boolean): void {
  stopped = chip.begin(noise);
  chip.supply(Number(element("supply", HTMLInputElement).value) || 0);
  for (const joint of open) chip.potOpen(joint, true);
  if (!powered) chip.power(false);
  keepAlive();
  log.clear();
  form.preview();
  show();
}

element("joint").dispatchEvent(new Event("change"));
keepAlive();
slice();

// For the test of the page (tests/system/board_page).
Object.assign(window, { kaz: {
  view: () => view, entries: () => log.entries, decode, pack, unpack, messages, simulated: () => simulated,
  speed: () => measured.speed, running: () => running,
  // Exactly so many ticks, while it is paused.
  run: (milliseconds: number) => { advance(milliseconds); show(); return stopped; },
  fresh: (noise: boolean) => { setRunning(false); begin(noise); },
  script: (commands: string, noise: boolean) => { setRunning(false); const text = chip.script(commands, noise); show(); return text; },
} });
