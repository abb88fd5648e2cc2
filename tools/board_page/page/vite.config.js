// One file, index.html, with script and style inside: a page opened by file:// may load no module.
// SPDX-License-Identifier: Apache-2.0
import { defineConfig } from "vite";

const inline = {
  name: "inline",
  enforce: "post",
  generateBundle(_options, bundle) {
    const page = bundle["index.html"];
    for (const [name, item] of Object.entries(bundle)) {
      if (item === page) continue;
      const text = item.type === "chunk" ? item.code.replaceAll("</script", "<\\/script") : String(item.source);
      const tag = item.type === "chunk" ? new RegExp(`<script[^>]*src="[^"]*${name}"[^>]*></script>`)
        : new RegExp(`<link[^>]*href="[^"]*${name}"[^>]*>`);
      if (!tag.test(page.source)) this.error(`index.html does not load ${name}`);
      page.source = page.source.replace(tag, () => item.type === "chunk"
        ? `<script type="module">${text}</script>` : `<style>${text}</style>`);
      delete bundle[name];
    }
  },
};

export default defineConfig({
  base: "./",
  plugins: [inline],
  build: { target: "es2022", chunkSizeWarningLimit: 4000, modulePreload: { polyfill: false } },
});
