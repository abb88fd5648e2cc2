// Elements of index.html by id.
// SPDX-License-Identifier: Apache-2.0
export function element<T extends HTMLElement = HTMLElement>(id: string, type?: new () => T): T {
  const found = document.getElementById(id);
  if (!(found instanceof (type ?? HTMLElement))) throw new Error(`index.html has no ${id}`);
  return found as T;
}
// Sets text only where it differs: screen readers and selections are left alone.
export function put(node: Node | null | undefined, text: string): void {
  if (node && node.textContent !== text) node.textContent = text;
}
