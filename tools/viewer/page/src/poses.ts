// The editor of poses: joints are set by sliders, poses kept with their times, played, saved and opened.
// SPDX-License-Identifier: Apache-2.0
// While `kaz run pose` runs. A file is what `kaz run play --poses` takes (docs/howto/watch.md).
import { saveFile } from "./save";

interface Pose { time_s: number; angles_rad: Record<string, number> }
interface File { format: string; poses: Pose[] }

const FORMAT = "kaz-poses-1";
const DEGREE = Math.PI / 180;
const STEP = 0.5;  // degrees, of a slider
const LONGEST_S = 600;
const KEPT = "poses";  // in the tab's storage: what is not saved outlives a reload

function element<T extends HTMLElement>(id: string): T { return document.getElementById(id) as T; }
// As the wire carries angles: units of 0.1 mrad.
const round = (rad: number) => Math.round(rad * 1e4) / 1e4;

export class Poses {
  private limits: Record<string, [number, number]> = {};
  // The angle is exact, where the slider has steps.
  private readonly sliders = new Map<string, { range: HTMLInputElement; text: HTMLOutputElement; rad: number }>();
  private poses: Pose[] = [];
  private allowed = false;
  private running = false;
  private measured: Record<string, number> | undefined;
  private playing = false;
  private follow = 0;  // messages of the board until the sliders go where the joints are held
  private readonly due = new Map<string, number>();  // targets that were not sent yet
  private timer = 0;

  constructor(private readonly send: (line: string) => void) {
    element("pose-keep").onclick = () => this.keep();
    element("pose-play").onclick = () => { this.note(""); this.send(`play ${this.text()}`); };
    element("pose-stop").onclick = () => this.send("stop");
    element("pose-end").onclick = () => this.send("end");
    element("pose-save").onclick = () => this.save();
    element<HTMLInputElement>("pose-open").onchange = (event) => void this.open(event.target as HTMLInputElement);
    this.poses = JSON.parse(sessionStorage.getItem(KEPT) ?? "[]") as Pose[];
    this.list();
  }

  private note(text: string): void { element("pose-note").textContent = text; }

  // Of the program that the page is connected to now.
  offer(allowed: boolean): void {
    this.allowed = allowed;
    this.running = false;
    this.measured = undefined;
    this.show();
    if (!allowed || Object.keys(this.limits).length > 0) return;
    void fetch(`hands.json${location.search}`).then((answer) => answer.json()).then((offer: { limits: Record<string, [number, number]> }) => {
      this.limits = offer.limits;
      this.show();
    });
  }

  behavior(name: string, phase: string): void {
    this.running = name === "pose";
    this.show();
    if (!this.running) return;
    if (phase.startsWith("refused: ")) this.note(phase);
    // The message that is on its way now may be older than the end of the motion.
    if (this.playing && phase !== "play") this.follow = 2;
    this.playing = phase === "play";
  }

  // The sliders begin where the joints are, and follow a motion when it ends.
  board(names: string[], target: number[], measured: number[]): void {
    if (!this.running) return;
    const first = this.measured === undefined;
    if (!first && (this.follow === 0 || --this.follow > 0)) return;
    const angle = (i: number) => (first || !Number.isFinite(target[i]) ? measured[i] : target[i]) ?? 0;
    this.measured = Object.fromEntries(names.map((name, i) => [name, angle(i)]));
    for (const name of this.sliders.keys()) if (!this.due.has(name)) this.place(name, this.measured[name] ?? 0);
  }

  private show(): void {
    element("poses").hidden = !this.allowed || !this.running;
    if (this.sliders.size > 0 || element("poses").hidden) return;
    for (const [name, [low, high]] of Object.entries(this.limits)) {
      const range = document.createElement("input");
      // Whole steps within the limits.
      const min = Math.ceil(low / DEGREE / STEP) * STEP, max = Math.floor(high / DEGREE / STEP) * STEP;
      Object.assign(range, { type: "range", min: String(min), max: String(max), step: String(STEP), id: `pose-of-${name}` });
      const label = document.createElement("label");
      label.htmlFor = range.id;
      label.textContent = name;
      const text = document.createElement("output");
      range.oninput = () => this.turn(name, Number(range.value) * DEGREE);
      element("pose-joints").append(label, range, text);
      this.sliders.set(name, { range, text, rad: 0 });
      this.place(name, this.measured?.[name] ?? 0);
    }
  }

  private place(name: string, rad: number): void {
    const slider = this.sliders.get(name);
    if (!slider) return;
    const [low, high] = this.limits[name] ?? [rad, rad];
    slider.rad = round(Math.min(high, Math.max(low, rad)));
    slider.range.value = String(slider.rad / DEGREE);
    slider.text.textContent = `${(slider.rad / DEGREE).toFixed(1).replace(/^-0\.0$/, "0.0")}°`;
  }

  // At most 20 times a second.
  private turn(name: string, rad: number): void {
    this.place(name, rad);
    this.due.set(name, this.sliders.get(name)?.rad ?? rad);
    if (this.timer !== 0) return;
    this.timer = window.setTimeout(() => {
      this.timer = 0;
      for (const [joint, angle] of this.due) this.send(`target ${joint} ${angle}`);
      this.due.clear();
    }, 50);
  }

  private angles(): Record<string, number> {
    return Object.fromEntries([...this.sliders].map(([name, { rad }]) => [name, rad]));
  }

  private keep(): void {
    const gap = Number(element<HTMLInputElement>("pose-gap").value);
    const last = this.poses.at(-1);
    const time = last ? round(last.time_s + gap) : 0;
    if (last && !(gap > 0)) return this.note("not kept: the time after the last pose must be greater than 0 s");
    if (time > LONGEST_S) return this.note(`not kept: the time of the pose, ${time} s, must be at most ${LONGEST_S} s`);
    this.note("");
    this.poses.push({ time_s: time, angles_rad: this.angles() });
    this.list();
  }

  private list(): void {
    sessionStorage.setItem(KEPT, JSON.stringify(this.poses));
    for (const id of ["pose-play", "pose-save"]) element<HTMLButtonElement>(id).disabled = this.poses.length === 0;
    element("pose-list").replaceChildren(...this.poses.map((pose, i) => {
      const row = document.createElement("li");
      row.className = "row";
      const time = document.createElement("input");
      Object.assign(time, { type: "number", min: "0", max: "600", step: "0.1", value: String(pose.time_s) });
      time.setAttribute("aria-label", `time of pose ${i + 1}, s`);
      time.onchange = () => {
        const given = time.value === "" ? NaN : Number(time.value);
        const free = given >= 0 && given <= LONGEST_S && this.poses.every((other) => other === pose || other.time_s !== given);
        this.note(free ? "" : `the time must be 0 to ${LONGEST_S} s and differ from those of other poses`);
        if (free) pose.time_s = given;
        this.poses.sort((a, b) => a.time_s - b.time_s);
        this.list();
      };
      const button = (text: string, act: () => void) => {
        const made = document.createElement("button");
        Object.assign(made, { type: "button", textContent: text, onclick: act });
        made.setAttribute("aria-label", `${text} pose ${i + 1}`);
        return made;
      };
      row.append(time, " s ",
        button("show", () => { for (const [name, rad] of Object.entries(pose.angles_rad)) this.turn(name, rad); }),
        button("replace", () => {
          pose.angles_rad = this.angles();
          this.list();
          this.note(`pose ${i + 1} replaced`);
        }),
        button("remove", () => {
          this.poses.splice(i, 1);
          this.list();
          const next = element("pose-list").children[Math.min(i, this.poses.length - 1)];
          (next?.querySelector<HTMLElement>("button:last-child") ?? element("pose-keep")).focus();
        }));
      return row;
    }));
  }

  private text(): string { return JSON.stringify({ format: FORMAT, poses: this.poses } satisfies File); }

  private save(): void {
    saveFile("poses.json", new Blob([this.text(), "\n"], { type: "application/json" }));
  }

  private async open(input: HTMLInputElement): Promise<void> {
    const file = input.files?.[0];
    input.value = "";
    if (!file) return;
    try {
      this.poses = this.parse(await file.text());
      this.list();
      this.note("");
    } catch (error) {
      this.note(`${file.name}: ${error instanceof Error ? error.message : String(error)}`);
    }
  }

  // What the program would refuse to play is not opened. Throws with a sentence.
  private parse(text: string): Pose[] {
    if (text.trim() === "") throw new Error("the file is empty");
    const read = JSON.parse(text) as Partial<File> | null;
    if (read === null || typeof read !== "object" || read.format !== FORMAT)
      throw new Error(`not a pose file: "format" must be "${FORMAT}"`);
    const poses: unknown = read.poses;
    if (!Array.isArray(poses) || poses.length === 0) throw new Error('"poses" must be a list of at least one pose');
    let before = -1;
    return poses.map((entry: unknown, i) => {
      const { time_s, angles_rad } = (entry ?? {}) as Partial<Pose>;
      const where = `pose ${i + 1}`;
      if (typeof time_s !== "number" || time_s <= before || time_s < 0 || time_s > LONGEST_S)
        throw new Error(`${where}: "time_s" must be a number, 0 to ${LONGEST_S}, greater than that of the pose before`);
      before = time_s;
      if (angles_rad === null || typeof angles_rad !== "object" || Object.keys(angles_rad).length === 0)
        throw new Error(`${where}: "angles_rad" must have the angle of at least one joint`);
      for (const [name, rad] of Object.entries(angles_rad)) {
        const limits = this.limits[name];
        if (!limits) throw new Error(`${where}: no joint is called ${name}`);
        // What a file rounds is within.
        if (typeof rad !== "number" || rad < limits[0] - 1e-4 || rad > limits[1] + 1e-4)
          throw new Error(`${where}: ${name} must be an angle from ${limits[0].toFixed(3)} to ${limits[1].toFixed(3)} rad`);
      }
      return { time_s, angles_rad };
    });
  }
}
