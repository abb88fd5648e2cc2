// Pictures of the page as PNG files.
// SPDX-License-Identifier: Apache-2.0

// Saves `sources` side by side, on the page's background color, as a file of this name.
export function savePicture(name: string, ...sources: (HTMLCanvasElement | ImageBitmap)[]): void {
  const picture = document.createElement("canvas");
  picture.width = sources.reduce((sum, { width }) => sum + width, 0);
  picture.height = Math.max(...sources.map(({ height }) => height));
  const context = picture.getContext("2d");
  if (!context) return;
  context.fillStyle = getComputedStyle(document.documentElement).getPropertyValue("--scene");
  context.fillRect(0, 0, picture.width, picture.height);
  let left = 0;
  for (const source of sources) {
    context.drawImage(source, left, 0);
    left += source.width;
  }
  picture.toBlob((blob) => { if (blob) saveFile(name, blob); }, "image/png");
}

export function saveFile(name: string, content: Blob): void {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(content);
  link.download = name;
  link.click();
  URL.revokeObjectURL(link.href);
}
