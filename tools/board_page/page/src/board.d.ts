// What emscripten writes (board.js), as far as it is used here.
// SPDX-License-Identifier: Apache-2.0
export interface Module {
  ccall(name: string, returns: "string" | "number" | null, types: string[], words: unknown[]): unknown;
}
export default function create(): Promise<Module>;
