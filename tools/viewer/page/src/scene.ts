// The robot by its URDF, what stands around it, forces, the map on the floor.
// SPDX-License-Identifier: Apache-2.0
import * as THREE from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import URDFLoader, { type URDFRobot } from "urdf-loader";
import type { Grid, Intrinsics, Marker, Pose, Transform, Vector } from "./ros1";
import { textureOf, unwrap } from "./textures";

const towardSun = new THREE.Vector3(1.1, -1, 2);  // as sim/body/description/scene.h has it

export class Scene {
  readonly scene = new THREE.Scene();
  readonly camera = new THREE.PerspectiveCamera(40, 1, 0.01, 50);
  follow = true;
  private poses: Transform[] = [];
  // An object of the world is drawn to a place, m, or let go; the model's name.
  onDrag: ((object: string, place: [number, number, number] | undefined) => void) | undefined;
  frames = 0;
  robot: URDFRobot | undefined;
  private readonly renderer: THREE.WebGLRenderer;
  private readonly controls: OrbitControls;
  private readonly world = new THREE.Group();  // z up, as the robot has it
  private readonly nodes = new Map<string, THREE.Object3D>();
  private readonly objects = new THREE.Group();
  private readonly forces = new THREE.Group();
  private readonly floor = new THREE.Group();
  private readonly sun = new THREE.DirectionalLight(0xffffff, 2.2);
  private last = new THREE.Vector3();
  private dirty = true;
  private readonly frusta = new Map<string, THREE.LineSegments>();
  private showFrusta = true;
  // Without a graphics card a picture takes long. Then shadows get hard edges (1), then half of the lines go (0).
  private quality = 2;
  private drawn: number[] = [];  // times of the last pictures in a row, ms

  constructor(private readonly canvas: HTMLCanvasElement) {
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true, preserveDrawingBuffer: true });
    this.renderer.shadowMap.enabled = true;
    this.camera.up.set(0, 0, 1);
    this.camera.position.set(1.05, -0.85, 0.55);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.target.set(0.2, 0, 0.13);
    this.controls.listenToKeyEvents(canvas);
    this.controls.addEventListener("change", () => { this.dirty = true; });
    this.controls.update();
    const sun = this.sun;
    this.light(new THREE.Vector3());
    sun.castShadow = true;
    sun.shadow.normalBias = 0.004;  // m; without it edges of boxes that face the sun have dark dashes
    sun.shadow.mapSize.set(1024, 1024);
    const across = sun.shadow.camera;
    across.left = across.bottom = -1.2;
    across.right = across.top = 1.2;
    this.scene.add(new THREE.HemisphereLight(0xffffff, 0x8a8f98, 1.6), sun, sun.target, this.world);
    this.world.add(this.objects, this.forces, this.floor);
    canvas.addEventListener("pointerdown", (event) => this.grasp(event));
    new ResizeObserver(() => { this.dirty = true; }).observe(canvas);
  }

  setRobot(urdf: string): void {
    const loader = new URDFLoader();
    loader.packages = { kaz: new URL("robot", document.baseURI).href };
    loader.workingPath = new URL("robot/", document.baseURI).href;
    if (this.robot) this.world.remove(...Object.values(this.robot.links));
    this.robot = loader.parse(urdf);
    // It comes again with a new connection; the objects of the scene stay.
    for (const [name, node] of this.nodes) if (node.parent !== this.objects) this.nodes.delete(name);
    // Each link is placed by itself: poses come in the world's frame.
    for (const [name, link] of Object.entries(this.robot.links)) {
      link.matrixAutoUpdate = true;
      this.nodes.set(name, link);
    }
    const links = Object.values(this.robot.links);
    this.world.add(...links);
    for (const link of links) {
      for (const child of [...link.children]) if ("isURDFJoint" in child) link.remove(child);
      link.traverse((part) => { part.castShadow = true; });
    }
    this.setPoses(this.poses);
  }

  setObjects(markers: Marker[]): void {
    for (const [name, node] of this.nodes) if (node.parent === this.objects) this.nodes.delete(name);
    this.objects.clear();
    for (const marker of markers) {
      const flat = marker.scale[2] < 1e-3;
      const mesh = new THREE.Mesh(shapeOf(marker), this.materialOf(marker));
      mesh.castShadow = !flat;
      mesh.receiveShadow = true;
      place(mesh, marker.pose);
      this.frame(marker.frame).add(mesh);
    }
    this.setPoses(this.poses);
  }

  // Textures are of boxes and planes; round objects keep their color.
  private materialOf(marker: Marker): THREE.Material {
    const [red, green, blue] = marker.color;
    const color = new THREE.Color().setRGB(red, green, blue, THREE.SRGBColorSpace);
    if (marker.texture === "" || marker.type !== 1) return new THREE.MeshStandardMaterial({ color, roughness: 0.8 });
    const material = new THREE.MeshLambertMaterial({ color });
    textureOf(marker.texture).then((texture) => {
      material.map = texture;
      material.needsUpdate = this.dirty = true;
    }, () => {});  // the surface keeps its color
    return material;
  }

  setForces(markers: Marker[], shown: boolean): void {
    for (const child of this.forces.children) (child as THREE.ArrowHelper).dispose();
    this.forces.clear();
    for (const marker of shown ? markers : []) {
      if (marker.type !== 0 || marker.action !== 0) continue;
      const turn = new THREE.Quaternion(...marker.pose.turn);
      const along = new THREE.Vector3(1, 0, 0).applyQuaternion(turn);
      this.forces.add(new THREE.ArrowHelper(along, new THREE.Vector3(...marker.pose.position), marker.scale[0],
        0xe69f00, 0.012, 0.008));
    }
    this.dirty = true;
  }

  // Kept, since a robot or objects may come after them.
  setPoses(transforms: Transform[]): void {
    this.poses = transforms;
    for (const transform of transforms) {
      const node = this.nodes.get(transform.child);
      if (node) place(node, transform);
    }
    const root = this.robot && this.nodes.get(this.robot.urdfName) ? this.nodes.get(this.robot.urdfName)
      : this.nodes.get("trunk");
    if (root) {
      if (this.follow) {
        const moved = root.position.clone().sub(this.last).setZ(0);
        this.camera.position.add(moved);
        this.controls.target.add(moved);
      }
      this.last.copy(root.position);
      this.light(root.position);
    }
    this.dirty = true;
  }

  // What an eye sees, up to a quarter of a metre; `link` is an optical frame: x right, y down, z ahead.
  setFrustum(link: string, k: Intrinsics): void {
    const node = this.nodes.get(link);
    if (!node || this.frusta.get(link)?.parent === node) return;
    const far = 0.25;
    const corner = (u: number, v: number) => new THREE.Vector3((u - k.cx) / k.fx * far, (v - k.cy) / k.fy * far, far);
    const corners = [corner(0, 0), corner(k.width, 0), corner(k.width, k.height), corner(0, k.height)];
    const points = corners.flatMap((at, i) => [new THREE.Vector3(), at, at, corners[(i + 1) % 4] ?? at]);
    const lines = new THREE.LineSegments(new THREE.BufferGeometry().setFromPoints(points),
      new THREE.LineBasicMaterial({ color: 0x0072b2, transparent: true, opacity: 0.6 }));
    lines.visible = this.showFrusta;
    this.frusta.set(link, lines);
    node.add(lines);
    this.dirty = true;
  }
  setFrustaShown(shown: boolean): void {
    this.showFrusta = shown;
    for (const lines of this.frusta.values()) lines.visible = shown;
    this.dirty = true;
  }

  // The object under the pointer follows it in the plane through it that faces the camera, above the floor.
  private grasp(down: PointerEvent): void {
    if (!this.onDrag || down.button !== 0) return;
    const ray = new THREE.Raycaster();
    const aim = (event: PointerEvent) => {
      const box = this.canvas.getBoundingClientRect();
      ray.setFromCamera(new THREE.Vector2(2 * (event.clientX - box.left) / box.width - 1,
        1 - 2 * (event.clientY - box.top) / box.height), this.camera);
    };
    aim(down);
    const movable = [...this.nodes].filter(([, node]) => node.parent === this.objects);
    const hit = ray.intersectObjects(movable.map(([, node]) => node), true)[0];
    const grasped = hit ? movable.find(([, node]) => node.getObjectById(hit.object.id) !== undefined)
      : this.nearest(movable, down);
    if (!grasped) return;
    const [name, node] = grasped;
    const object = name.split("/")[0] ?? name;
    this.controls.enabled = false;
    this.canvas.setPointerCapture(down.pointerId);
    const plane = new THREE.Plane().setFromNormalAndCoplanarPoint(
      this.camera.getWorldDirection(new THREE.Vector3()), node.getWorldPosition(new THREE.Vector3()));
    const move = (event: PointerEvent) => {
      aim(event);
      const at = ray.ray.intersectPlane(plane, new THREE.Vector3());
      if (at) this.onDrag?.(object, [at.x, at.y, Math.max(0.01, at.z)]);
    };
    const end = () => {
      this.controls.enabled = true;
      this.canvas.removeEventListener("pointermove", move);
      this.onDrag?.(object, undefined);
    };
    this.canvas.addEventListener("pointermove", move);
    for (const type of ["pointerup", "pointercancel"]) this.canvas.addEventListener(type, end, { once: true });
    move(down);
  }

  // What is small, far or rolling is missed by a few pixels.
  private nearest(among: [string, THREE.Object3D][], event: PointerEvent): [string, THREE.Object3D] | undefined {
    const reach = 20;  // px
    const box = this.canvas.getBoundingClientRect();
    let found: [string, THREE.Object3D] | undefined;
    let least = reach;
    for (const each of among) {
      const [x, y] = this.onCanvas(each[0]) ?? [Infinity, Infinity];
      const distance = Math.hypot(x - (event.clientX - box.left), y - (event.clientY - box.top));
      if (distance < least) [found, least] = [each, distance];
    }
    return found;
  }

  // Where a link, an object or a place in the world is on the canvas, px; undefined if it is behind the camera.
  onCanvas(what: string | Vector): [number, number] | undefined {
    const at = typeof what === "string" ? this.nodes.get(what)?.getWorldPosition(new THREE.Vector3())
      : new THREE.Vector3(...what);
    if (!at) return undefined;
    this.camera.updateMatrixWorld();
    at.project(this.camera);
    if (at.z > 1) return undefined;
    return [(at.x + 1) / 2 * this.canvas.clientWidth, (1 - at.y) / 2 * this.canvas.clientHeight];
  }

  setMap(grid: Grid): void {
    const pixels = new Uint8Array(4 * grid.width * grid.height);
    grid.cells.forEach((cell, i) => {
      pixels.set(cell < 0 ? [0, 0, 0, 0] : cell > 50 ? [213, 94, 0, 200] : [0, 114, 178, 50], 4 * i);
    });
    const texture = new THREE.DataTexture(pixels, grid.width, grid.height);
    texture.needsUpdate = true;
    const [w, h] = [grid.width * grid.resolution, grid.height * grid.resolution];
    const plane = new THREE.Mesh(new THREE.PlaneGeometry(w, h),
      new THREE.MeshBasicMaterial({ map: texture, transparent: true, depthWrite: false }));
    plane.position.set(grid.origin.position[0] + w / 2, grid.origin.position[1] + h / 2, 0.002);
    this.floor.clear();
    this.floor.add(plane);
    this.dirty = true;
  }

  // How many meshes the scene has.
  meshes(): number {
    let count = 0;
    this.world.traverse((part) => { if (part instanceof THREE.Mesh) ++count; });
    return count - this.forces.children.length;  // each arrow has one
  }

  // Whether there is a robot to be seen.
  loaded(): boolean { return this.robot !== undefined && this.poses.length > 0; }

  pose(link: string): number[] | undefined {
    const node = this.nodes.get(link);
    return node && [...node.position.toArray(), ...node.quaternion.toArray()];
  }

  draw(): void {
    if (!this.dirty) { this.drawn = []; return; }
    this.dirty = false;
    this.adapt(performance.now());
    this.render(this.quality === 0 ? 0.5 : Math.min(devicePixelRatio, this.quality));
  }

  // The canvas, drawn with all of the screen's pixels until the next draw().
  sharp(): HTMLCanvasElement {
    this.render(devicePixelRatio);
    this.dirty = true;
    return this.canvas;
  }

  private render(ratio: number): void {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (width === 0 || height === 0) return;
    this.renderer.setPixelRatio(ratio);
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.renderer.render(this.scene, this.camera);
    ++this.frames;
  }

  private adapt(now: number): void {
    const [count, longest] = [8, 90];
    this.drawn.push(now);
    if (this.drawn.length <= count) return;
    const mean = (now - (this.drawn[0] ?? now)) / count;
    this.drawn = [];
    if (mean < longest || this.quality === 0) return;
    this.quality -= 1;
    this.renderer.shadowMap.type = THREE.BasicShadowMap;
    this.scene.traverse((node) => {
      if (node instanceof THREE.Mesh) for (const one of [node.material].flat()) (one as THREE.Material).needsUpdate = true;
    });
  }

  // The shadow map covers what is around the robot. It moves in steps, so that edges of shadows do not shimmer.
  private light(at: THREE.Vector3): void {
    const step = 0.2;  // m
    this.sun.target.position.set(Math.round(at.x / step) * step, Math.round(at.y / step) * step, 0);
    this.sun.position.copy(this.sun.target.position).add(towardSun);
  }

  private frame(name: string): THREE.Object3D {
    if (name === "world") return this.objects;
    let node = this.nodes.get(name);
    if (!node) {
      node = new THREE.Group();
      this.objects.add(node);
      this.nodes.set(name, node);
    }
    return node;
  }
}

function place(node: THREE.Object3D, pose: Pose): void {
  node.position.set(...pose.position);
  node.quaternion.set(...pose.turn);
}

function shapeOf(marker: Marker): THREE.BufferGeometry {
  const [x, y, z] = marker.scale;
  if (marker.type === 2) return new THREE.SphereGeometry(x / 2, 32, 20);
  if (marker.type === 3) return new THREE.CylinderGeometry(x / 2, x / 2, z, 40).rotateX(Math.PI / 2);
  const box = new THREE.BoxGeometry(x, y, z);
  unwrap(box);
  return box;
}
