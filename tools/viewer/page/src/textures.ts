// The renderer's textures (sim/render/model/texture.h), which the server has as pictures.
// SPDX-License-Identifier: Apache-2.0
import * as THREE from "three";

const textures = new Map<string, Promise<THREE.Texture>>();

// Rejects if the server has no texture of this name. Its coordinates are meters along the surface.
export function textureOf(name: string): Promise<THREE.Texture> {
  let texture = textures.get(name);
  if (!texture) {
    texture = load(name);
    textures.set(name, texture);
    texture.catch(() => textures.delete(name));  // the next server may have it
  }
  return texture;
}

async function load(name: string): Promise<THREE.Texture> {
  const periods = await fetch("textures.json").then((answer) => answer.json()) as Record<string, number>;
  const period = periods[name];
  if (period === undefined) throw new Error(`no texture ${name}`);
  const texture = await new THREE.TextureLoader().loadAsync(`textures/${name}.png`);
  texture.wrapS = texture.wrapT = THREE.RepeatWrapping;
  texture.repeat.setScalar(1 / period);
  texture.flipY = false;
  texture.colorSpace = THREE.SRGBColorSpace;
  texture.anisotropy = 4;
  return texture;
}

// Texture coordinates of a box, m, as sim/render/model/mesh_box.cpp has them.
export function unwrap(box: THREE.BoxGeometry): void {
  const at = box.getAttribute("position"), normal = box.getAttribute("normal"), uv = box.getAttribute("uv");
  for (let i = 0; i < uv.count; ++i) {
    const u = Math.abs(normal.getX(i)) > 0.5 ? at.getY(i) : at.getX(i);
    const v = Math.abs(normal.getZ(i)) > 0.5 ? at.getY(i) : at.getZ(i);
    uv.setXY(i, u, v);
  }
}
