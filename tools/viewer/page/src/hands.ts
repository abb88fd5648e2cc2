// What the page does by hand to a simulated robot: faults, pushes, things that are dragged, pause and pace.
// SPDX-License-Identifier: Apache-2.0
import type { Scene } from "./scene";

interface Fault {
  name: string; of_joint: boolean; parameter: string; unit: string; low: number; high: number; initial: number;
  text: string;
}
interface Offer { faults: Fault[]; joints: string[]; links: string[] }

function element<T extends HTMLElement>(id: string): T { return document.getElementById(id) as T; }

export class Hands {
  private faults: Fault[] = [];
  private paused = false;
  private sent = 0;

  constructor(private readonly send: (line: string) => void, private readonly scene: Scene) {
    element("pause").onclick = () => this.pause(!this.paused);
    element("step").onclick = () => { this.pause(true); this.send("step 0.1"); };
    element<HTMLSelectElement>("pace").onchange = (event) => this.send(`pace ${(event.target as HTMLSelectElement).value}`);
    element("fault-name").onchange = () => this.choose();
    element("fault-clear").onclick = () => this.send("clear");
    element<HTMLFormElement>("fault-form").onsubmit = (event) => { event.preventDefault(); this.fault(); };
    for (const button of document.querySelectorAll<HTMLElement>("[data-push]")) {
      button.onclick = () => {
        const [x, y] = (button.dataset["push"] ?? "").split(" ").map(Number);
        const size = Number(element<HTMLInputElement>("push-size").value);
        this.send(`push ${element<HTMLSelectElement>("push-link").value} ${(x ?? 0) * size} ${(y ?? 0) * size} 0`);
      };
    }
  }

  // Of the program that the page is connected to now.
  offer(allowed: boolean): void {
    element("hands").hidden = !allowed;
    this.scene.onDrag = allowed ? (object, place) => this.drag(object, place) : undefined;
    this.paused = false;
    this.showPaused();
    if (!allowed || this.faults.length > 0) return;
    void fetch(`hands.json${location.search}`).then((answer) => answer.json()).then((offer: Offer) => {
      this.faults = offer.faults;
      fill("fault-name", offer.faults.map(({ name }) => name));
      fill("fault-joint", offer.joints);
      fill("push-link", offer.links);
      this.choose();
    });
  }

  // Of the run, whoever changed it.
  state({ paused, pace }: { paused: boolean; pace: number }): void {
    this.paused = paused;
    this.showPaused();
    const select = element<HTMLSelectElement>("pace");
    if (![...select.options].some(({ value }) => Number(value) === pace)) select.add(new Option(String(pace)));
    select.value = [...select.options].find(({ value }) => Number(value) === pace)?.value ?? "0";
  }

  // Whether it was one of these keys.
  key(key: string): boolean {
    if (element("hands").hidden || (key !== " " && key !== ".")) return false;
    if (key === " ") this.pause(!this.paused);
    else element("step").click();
    return true;
  }

  private pause(on: boolean): void {
    if (on !== this.paused) this.send(on ? "pause" : "go");
    this.paused = on;
    this.showPaused();
  }
  private showPaused(): void { element("pause").textContent = this.paused ? "resume" : "pause"; }

  private chosen(): Fault | undefined {
    return this.faults[element<HTMLSelectElement>("fault-name").selectedIndex];
  }

  private choose(): void {
    const fault = this.chosen();
    if (!fault) return;
    element("fault-joint-label").hidden = !fault.of_joint;
    element("fault-value-label").hidden = fault.parameter === "";
    element("fault-parameter").textContent = `${fault.parameter}${fault.unit === "" ? "" : `, ${fault.unit}`}`;
    const value = element<HTMLInputElement>("fault-value");
    value.min = String(fault.low);
    value.max = String(fault.high);
    value.value = String(fault.initial);
    element("fault-text").textContent = fault.text;
  }

  private fault(): void {
    const fault = this.chosen();
    if (!fault) return;
    const seconds = element<HTMLInputElement>("fault-time").value;
    const joint = fault.of_joint ? ` joint ${element<HTMLSelectElement>("fault-joint").value}` : "";
    const value = fault.parameter === "" ? "" : ` ${element<HTMLInputElement>("fault-value").value}`;
    this.send(`${seconds === "" ? "" : `for ${seconds} s `}${fault.name}${joint}${value}`);
  }

  private drag(object: string, place: [number, number, number] | undefined): void {
    if (!place) return this.send(`release ${object}`);
    const now = performance.now();
    if (now - this.sent < 30) return;
    this.sent = now;
    this.send(`hold ${object} ${place.map((x) => x.toFixed(4)).join(" ")}`);
  }
}

function fill(id: string, names: string[]): void {
  element<HTMLSelectElement>(id).replaceChildren(...names.map((name) => new Option(name)));
}
