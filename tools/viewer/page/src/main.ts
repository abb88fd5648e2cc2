// The page: one client of the server, no more privileged than others.
// SPDX-License-Identifier: Apache-2.0
import { Client } from "./client";
import { Hands } from "./hands";
import { Joints } from "./joints";
import { drawMap } from "./map";
import { Plot, TorquePlot } from "./plot";
import { Poses } from "./poses";
import { type Grid, type Pose, readBoard, readCameraInfo, readCircles, readGrid, readJointStates, readMarkers, readPath, readPicture, readPoseStamped,
  readTransforms, type Reader, type Vector } from "./ros1";
import { savePicture } from "./save";
import { Scene } from "./scene";

function element<T extends HTMLElement>(id: string): T {
  const found = document.getElementById(id);
  if (!found) throw new Error(`the page has no element ${id}`);
  return found as T;
}
const output = (id: string, text: string) => { element(id).textContent = text; };

const dark = localStorage.getItem("theme") === "dark"
  || (localStorage.getItem("theme") === null && matchMedia("(prefers-color-scheme: dark)").matches);
document.documentElement.classList.toggle("dark", dark);
element("theme").onclick = () => {
  const now = document.documentElement.classList.toggle("dark");
  localStorage.setItem("theme", now ? "dark" : "light");
  plotDue = true;
};

const token = new URLSearchParams(location.search).get("token");
const client = new Client(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/`, token);
// May things be done here? Not with the token of a program that ended.
const trusted = () => token !== null && !client.refused;
const scene = new Scene(element<HTMLCanvasElement>("view"));
const plot = new Plot(element<HTMLCanvasElement>("plot"));
const torque = new TorquePlot(element<HTMLCanvasElement>("torque"));
let plotDue = true;
let time = 0;
let forces = true;
let end: number | undefined;
let playing = true;
let grid: Grid | undefined;
let path: Pose[] = [];
let robot: Pose | undefined;
let pictures = 0;

client.onState = (open) => {
  const refused = token === null ? "this address has no token" : "this address has another run's token";
  const absent = client.refused
    ? `not connected: ${refused}; open the address that the program printed` : "not connected: the program has ended or cannot be reached; trying again";
  output("connection", open ? "live" : absent);
  output("loading", open ? "loading…" : absent);
  element("player").hidden = true;
};
client.onInfo = (info) => {
  end = info.capabilities.includes("playbackControl") ? info.end : undefined;
  element("player").hidden = end === undefined;
  if (end !== undefined) output("connection", "recording");
  element("locked").hidden = trusted() || !(end !== undefined || info.capabilities.includes("clientPublish"));
  output("locked", token !== null && client.refused ? "another run's token: open the address that this run printed to control it"
    : "open the address with its token to control");
  hands.offer(trusted() && info.capabilities.includes("clientPublish"));
  poses.offer(trusted() && info.capabilities.includes("clientPublish"));
};
client.onTime = (seconds) => { time = seconds; };
client.onParameter = (name, value) => { if (name === "no_pictures") output("no-eyes", value); };
client.onRefusal = (sentence) => output("refusal", sentence);
client.on("/robot_description", (r) => scene.setRobot(r.text()));
client.on("/tf", (r) => scene.setPoses(readTransforms(r)));
client.on("/scene", (r) => scene.setObjects(readMarkers(r)));
client.on("/contacts", (r) => scene.setForces(readMarkers(r), forces));
client.on("/faults", (r) => output("fault", r.text()));
client.on("/run/pace", (_r, _s, data) =>
  hands.state(JSON.parse(new TextDecoder().decode(data)) as { paused: boolean; pace: number }));
client.on("/behavior", (_r, _s, data) => {
  const state = JSON.parse(new TextDecoder().decode(data)) as { behavior?: string; phase?: string };
  if (state.phase === undefined) return;
  output("phase", `${state.behavior ?? ""}: ${state.phase}`);
  poses.behavior(state.behavior ?? "", state.phase);
});

const joints = new Joints((chosen) => { plot.joints = torque.joints = chosen; plotDue = true; });
client.on("/joint_states", (r) => { torque.add(readJointStates(r)); plotDue = true; });
client.on("/board/state", (r) => {
  const state = readBoard(r);
  joints.offer(state.names, "neck_pan");
  element("no-board").hidden = true;
  element("board").hidden = false;
  plot.add(state);
  poses.board(state.names, state.target, state.measured);
  plotDue = true;
  output("supply", state.supply > 0 ? `${state.supply.toFixed(2)} V` : "not reported yet");
  const flags = ["motors on", "moving", "holding", "unlocked", "raw drive", "telemetry", "uncalibrated", "missed a tick"];
  output("status", flags.filter((_, i) => (state.status >> i & 1) !== 0).join(", ") || "motors off");
  output("worst", state.worstTick > 0 ? `${(100 * state.worstTick).toFixed(0)} % of the tick period` : "not reported yet");
  output("link", `${state.toBoard} to the board, ${state.toHost} from it, ${state.damaged} damaged`);
  output("shutdown", state.shutdown || "no");
});

const shown = new Map<string, Blob>();  // the newest picture, by element
function showPicture(id: string, r: Reader): void {
  const picture = readPicture(r);
  const image = element<HTMLImageElement>(id);
  const blob = new Blob([new Uint8Array(picture.data)], { type: `image/${picture.format}` });
  shown.set(id, blob);
  const url = URL.createObjectURL(blob);
  const old = image.src;
  image.src = url;
  if (old.startsWith("blob:")) URL.revokeObjectURL(old);
  element("no-eyes").hidden = true;
  element("save-eyes").hidden = false;
  ++pictures;
}
client.on("/eyes/left", (r) => showPicture("left", r));
client.on("/eyes/right", (r) => showPicture("right", r));

client.on("/eyes/left/camera_info", (r) => scene.setFrustum("left_eye", readCameraInfo(r)));
client.on("/eyes/right/camera_info", (r) => scene.setFrustum("right_eye", readCameraInfo(r)));
client.on("/eyes/left/annotations", (r) => {
  const circle = element("ball-mark");
  const image = element<HTMLImageElement>("left");
  const ball = readCircles(r)[0];
  circle.hidden = ball === undefined || image.naturalWidth === 0;
  if (ball === undefined || image.naturalWidth === 0) return;
  const percent = (px: number, of: number) => `${(100 * px / of).toFixed(2)}%`;
  circle.style.left = percent(ball.x - ball.diameter / 2, image.naturalWidth);
  circle.style.top = percent(ball.y - ball.diameter / 2, image.naturalHeight);
  circle.style.width = percent(ball.diameter, image.naturalWidth);
  circle.style.height = percent(ball.diameter, image.naturalHeight);
});
const modules = element<HTMLSelectElement>("module");
modules.onchange = () => {
  const topic = modules.value === "" ? undefined : modules.value;
  element("made").hidden = topic === undefined;
  client.watch(topic);
};
client.onWatched = (r) => showPicture("made", r);
client.onTopics = () => {
  const offered = client.offered("/vision/");
  for (const topic of offered) {
    if (![...modules.options].some(({ value }) => value === topic))
      modules.add(new Option(topic.slice("/vision/".length), topic));
  }
  element("module-row").hidden = modules.options.length < 2;
};

function showMap(): void {
  if (!grid) return;
  element("map-section").hidden = false;
  drawMap(element<HTMLCanvasElement>("map"), grid, path, robot);
}
client.on("/map", (r) => { grid = readGrid(r); scene.setMap(grid); showMap(); });
client.on("/map/path", (r) => { path = readPath(r); showMap(); });
client.on("/map/robot", (r) => { robot = readPoseStamped(r); showMap(); });

const pictureName = (what: string) => `kaz-${what}-${time.toFixed(2)}s.png`;
element("save-view").onclick = () => savePicture(pictureName("view"), scene.sharp());
// Not from the page's images: they are empty while the next picture is being decoded.
element("save-eyes").onclick = async () => {
  const eyes = ["left", "right"].flatMap((id) => shown.get(id) ?? []);
  savePicture(pictureName("eyes"), ...await Promise.all(eyes.map((eye) => createImageBitmap(eye))));
};

const hands = new Hands((line) => client.hand(line), scene);
const poses = new Poses((line) => client.hand(line));

const scrub = element<HTMLInputElement>("scrub");
const speed = element<HTMLSelectElement>("speed");
const control = (play: boolean, seek?: number) => client.control(play, Number(speed.value), seek);
client.onPlayback = (state) => {
  playing = state.status === 0;
  time = state.seconds;
  output("play", playing ? "pause" : "play");
};
element("restart").onclick = () => control(true, 0);
element("play").onclick = () => control(!playing);
speed.onchange = () => control(playing);
scrub.oninput = () => { if (end !== undefined) control(playing, end * Number(scrub.value) / 1000); };
element<HTMLInputElement>("follow").onchange = (event) => { scene.follow = (event.target as HTMLInputElement).checked; };
element<HTMLInputElement>("frusta").onchange = (event) => {
  scene.setFrustaShown((event.target as HTMLInputElement).checked);
};
element<HTMLInputElement>("forces").onchange = (event) => {
  forces = (event.target as HTMLInputElement).checked;
  if (!forces) scene.setForces([], false);
};
addEventListener("keydown", (event) => {
  if (event.target instanceof HTMLSelectElement || event.target instanceof HTMLInputElement
    || event.target instanceof HTMLButtonElement) return;
  if (hands.key(event.key)) return event.preventDefault();
  if (end === undefined) return;
  if (event.key === " ") control(!playing);
  else if (event.key === ",") control(playing, Math.max(0, time - 1));
  else if (event.key === ".") control(playing, Math.min(end, time + 1));
  else return;
  event.preventDefault();
});

function draw(): void {
  output("time", `${time.toFixed(2)} s`);
  if (end !== undefined && document.activeElement !== scrub) scrub.value = String(1000 * time / end);
  if (plotDue) { plotDue = false; plot.draw(); torque.draw(); }
  element("loading").hidden = scene.loaded();
  scene.draw();
  requestAnimationFrame(draw);
}
client.open();
requestAnimationFrame(draw);

// What tests read.
declare global { interface Window { kaz: object } }
window.kaz = {
  pose: (link: string) => scene.pose(link),
  onCanvas: (what: string | Vector) => scene.onCanvas(what),
  frames: () => scene.frames, plotted: () => plot.count(), target: (joint: string) => plot.target(joint),
  meshes: () => scene.meshes(), pictures: () => pictures, time: () => time, playing: () => playing,
};
