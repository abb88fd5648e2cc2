// A screenshot as a PNG of few colours, which takes a third of the bytes: for the documentation.
// SPDX-License-Identifier: Apache-2.0
import { crc32 as nodeCrc, deflateSync } from "node:zlib";

const table = Array.from({ length: 256 }, (_, n) => {
  for (let k = 0; k < 8; ++k) n = n & 1 ? 0xedb88320 ^ n >>> 1 : n >>> 1;
  return n >>> 0;
});
const crc32 = nodeCrc ?? ((bytes) => ~bytes.reduce((crc, byte) => table[(crc ^ byte) & 255] ^ crc >>> 8, ~0) >>> 0);

function chunk(name, data) {
  const body = Buffer.concat([Buffer.from(name, "latin1"), data]);
  const out = Buffer.alloc(body.length + 8);
  out.writeUInt32BE(data.length);
  body.copy(out, 4);
  out.writeUInt32BE(crc32(body) >>> 0, body.length + 4);
  return out;
}

// `page` of any document decodes `png`; `colors`, at most 256: the most frequent ones, each pixel takes the nearest.
export async function small(page, png, colors = 16) {
  const { width, height, base64 } = await page.evaluate(async (source) => {
    const image = new Image();
    image.src = `data:image/png;base64,${source}`;
    await image.decode();
    const canvas = new OffscreenCanvas(image.width, image.height), context = canvas.getContext("2d");
    context.drawImage(image, 0, 0);
    const { data } = context.getImageData(0, 0, image.width, image.height);
    let text = "";
    for (let i = 0; i < data.length; i += 0x8000) text += String.fromCharCode(...data.subarray(i, i + 0x8000));
    return { width: image.width, height: image.height, base64: btoa(text) };
  }, png.toString("base64"));
  const rgba = Buffer.from(base64, "base64");
  const pixels = Array.from({ length: width * height }, (_, i) => rgba.readUInt32BE(4 * i) >>> 8);
  const counts = new Map();
  for (const color of pixels) counts.set(color, (counts.get(color) ?? 0) + 1);
  const palette = [];
  const distance = (a, b) => [16, 8, 0].reduce((sum, shift) => sum + ((a >> shift & 255) - (b >> shift & 255)) ** 2, 0);
  for (const [color] of [...counts].sort((a, b) => b[1] - a[1])) {
    if (palette.length < colors && palette.every((other) => distance(color, other) > 900)) palette.push(color);
  }
  const nearest = new Map([...counts.keys()].map((color) => [color,
    palette.reduce((best, other, i) => distance(color, other) < distance(color, palette[best]) ? i : best, 0)]));
  const bits = palette.length <= 16 ? 4 : 8, stride = Math.ceil(width * bits / 8) + 1;
  const rows = Buffer.alloc(stride * height);
  pixels.forEach((color, i) => {
    const x = i % width, at = Math.floor(i / width) * stride + 1 + Math.floor(x * bits / 8);
    rows[at] |= nearest.get(color) << (bits === 8 || x % 2 === 1 ? 0 : 4);
  });
  const header = Buffer.alloc(13);
  header.writeUInt32BE(width);
  header.writeUInt32BE(height, 4);
  header.set([bits, 3, 0, 0, 0], 8);
  return Buffer.concat([Buffer.from("89504e470d0a1a0a", "hex"), chunk("IHDR", header),
    chunk("PLTE", Buffer.from(palette.flatMap((color) => [color >> 16, color >> 8 & 255, color & 255]))),
    chunk("IDAT", deflateSync(rows, { level: 9 })), chunk("IEND", Buffer.alloc(0))]);
}
