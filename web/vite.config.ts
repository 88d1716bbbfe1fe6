import { createHash } from "node:crypto";
import { readFileSync, readdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { defineConfig, type Plugin } from "vite";

/** Writes the names of all files of the page, and a digest of them, into the service worker. */
function filesForServiceWorker(): Plugin {
  let folder = "dist";
  const worker = "service-worker.js";
  return {
    name: "files-for-service-worker",
    apply: "build",
    configResolved: (config) => void (folder = join(config.root, config.build.outDir)),
    closeBundle(error?: Error) {
      if (error) return;
      const entries = readdirSync(folder, { recursive: true, withFileTypes: true }).filter((entry) => entry.isFile());
      const paths = entries.map((entry) => join(entry.parentPath, entry.name)).filter((path) => !path.endsWith(worker)).sort();
      const digest = createHash("sha256");
      for (const path of paths) digest.update(path.slice(folder.length)).update(readFileSync(path));
      const names = paths.map((path) => path.slice(folder.length + 1).replaceAll("\\", "/"));
      const listed = ["./", ...names.filter((name) => name !== "index.html")];
      const text = readFileSync(join(folder, worker), "utf8");
      const written = text
        .replace('BUILD = "none"', `BUILD = "${digest.digest("hex").slice(0, 16)}"`)
        .replace("FILES = []", `FILES = ${JSON.stringify(listed)}`);
      if (written === text) throw new Error(`${worker} has no place for the names of files`);
      writeFileSync(join(folder, worker), written);
    },
  };
}

/** Leaves indentation and whole lines of comment out of three's shaders, which are texts that no minifier reads: 1.5 kB, compressed. */
function shadersWithoutIndentation(): Plugin {
  return {
    name: "shaders-without-indentation",
    apply: "build",
    enforce: "pre",
    transform(code, id) {
      if (!/[\\/]node_modules[\\/]three[\\/]/.test(id)) return null;
      return code.replace(/\n[ \t]*\/\/[^\n]*(?=\n)/g, "").replace(/\n\s+/g, "\n").replace(/(\\n)(?:\\n|\\t)+/g, "$1");
    },
  };
}

// Relative addresses: the page works from any folder of any file server.
export default defineConfig({
  base: "./",
  plugins: [shadersWithoutIndentation(), filesForServiceWorker()],
  build: { target: "es2022", modulePreload: { polyfill: false }, assetsInlineLimit: 0, chunkSizeWarningLimit: 900 },
  worker: { format: "es" },
});
