// The editor of poses: joints are set by sliders, poses kept with their times, played, saved and opened.
// SPDX-License-Identifier: Apache-2.0
// While `kaz run pose` runs. A file is what `kaz run play --poses` takes (docs/reference/poses.md).

interface Pose { time_s: number; angles_rad: Record<string, number> }
interface File { format: string; poses: Pose[] }

const FORMAT = "kaz-poses-1";
const DEGREE = Math.PI / 180;
const STEP = 0.5;  // degrees, of a slider

function element<T extends HTMLElement>(id: string): T { return document.getElementById(id) as T; }
// As the wire carries angles: units of 0.1 mrad.
const round = (rad: number) => Math.round(rad * 1e4) / 1e4;

export class Poses {
  private limits: Record<string, [number, number]> = {};
  private readonly sliders = new Map<string, { range: HTMLInputElement; text: HTMLOutputElement }>();
  private poses: Pose[] = [];
  private allowed = false;
  private running = false;
  private measured: Record<string, number> | undefined;
  private readonly due = new Map<string, number>();  // targets that were not sent yet
  private timer = 0;

  constructor(private readonly send: (line: string) => void) {
    element("pose-keep").onclick = () => this.keep();
    element("pose-play").onclick = () => { if (this.poses.length > 0) this.send(`play ${this.text()}`); };
    element("pose-stop").onclick = () => this.send("stop");
    element("pose-end").onclick = () => this.send("end");
    element("pose-save").onclick = () => this.save();
    element<HTMLInputElement>("pose-open").onchange = (event) => void this.open(event.target as HTMLInputElement);
  }

  // Of the program that the page is connected to now.
  offer(allowed: boolean): void {
    this.allowed = allowed;
    this.running = false;
    this.measured = undefined;
    this.show();
    if (!allowed || Object.keys(this.limits).length > 0) return;
    void fetch("hands.json").then((answer) => answer.json()).then((offer: { limits: Record<string, [number, number]> }) => {
      this.limits = offer.limits;
      this.show();
    });
  }

  behavior(name: string): void {
    this.running = name === "pose";
    this.show();
  }

  // The first of a run is where the sliders begin.
  board(names: string[], measured: number[]): void {
    if (this.measured || !this.running) return;
    this.measured = Object.fromEntries(names.map((name, i) => [name, measured[i] ?? 0]));
    for (const name of this.sliders.keys()) this.place(name, this.measured[name] ?? 0);
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
      this.sliders.set(name, { range, text });
      this.place(name, this.measured?.[name] ?? 0);
    }
  }

  private place(name: string, rad: number): void {
    const slider = this.sliders.get(name);
    if (!slider) return;
    slider.range.value = String(rad / DEGREE);
    slider.text.textContent = `${(rad / DEGREE).toFixed(1)}°`;
  }

  // At most 20 times a second.
  private turn(name: string, rad: number): void {
    this.place(name, rad);
    const [low, high] = this.limits[name] ?? [rad, rad];
    this.due.set(name, round(Math.min(high, Math.max(low, rad))));
    if (this.timer !== 0) return;
    this.timer = window.setTimeout(() => {
      this.timer = 0;
      for (const [joint, angle] of this.due) this.send(`target ${joint} ${angle}`);
      this.due.clear();
    }, 50);
  }

  private angles(): Record<string, number> {
    return Object.fromEntries([...this.sliders].map(([name, { range }]) => [name, round(Number(range.value) * DEGREE)]));
  }

  private keep(): void {
    const gap = Number(element<HTMLInputElement>("pose-gap").value);
    const last = this.poses.at(-1);
    this.poses.push({ time_s: last ? round(last.time_s + (gap > 0 ? gap : 1)) : 0, angles_rad: this.angles() });
    this.list();
  }

  private list(): void {
    element("pose-list").replaceChildren(...this.poses.map((pose, i) => {
      const row = document.createElement("li");
      row.className = "row";
      const time = document.createElement("input");
      Object.assign(time, { type: "number", min: "0", max: "600", step: "0.1", value: String(pose.time_s) });
      time.setAttribute("aria-label", `time of pose ${i + 1}, s`);
      time.onchange = () => {
        pose.time_s = Math.min(600, Math.max(0, Number(time.value)));
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
        button("replace", () => { pose.angles_rad = this.angles(); }),
        button("remove", () => { this.poses.splice(i, 1); this.list(); }));
      return row;
    }));
  }

  private text(): string { return JSON.stringify({ format: FORMAT, poses: this.poses } satisfies File); }

  private save(): void {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([this.text(), "\n"], { type: "application/json" }));
    link.download = "poses.json";
    link.click();
    URL.revokeObjectURL(link.href);
  }

  private async open(input: HTMLInputElement): Promise<void> {
    const file = input.files?.[0];
    input.value = "";
    if (!file) return;
    const note = element("pose-note");
    try {
      const read = JSON.parse(await file.text()) as File;
      const good = read.format === FORMAT && Array.isArray(read.poses) && read.poses.every(({ time_s, angles_rad }) =>
        Number.isFinite(time_s) && typeof angles_rad === "object" && Object.values(angles_rad).every(Number.isFinite));
      if (!good) throw new Error(`it is no file of poses: "format" must be "${FORMAT}"`);
      this.poses = read.poses;
      this.list();
      note.textContent = "";
    } catch (error) {
      note.textContent = `${file.name}: ${error instanceof Error ? error.message : String(error)}`;
    }
  }
}
