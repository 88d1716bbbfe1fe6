// Size of the module and times of its steps, by kind: `node measure.mjs [FOLDER]`, the folder of a module, by default that of the page.
// 600 frames of a fixed path of the right hand, then 600 steps that settle. Each session does the same, so the fastest of seven runs of each call is its
// time on a core that does nothing else.
import { readFileSync } from "node:fs";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";
import { brotliCompressSync, gzipSync } from "node:zlib";

const FRAMES = 600;
const RUNS = 7;
const folder = resolve(process.argv[2] ?? join(dirname(fileURLToPath(import.meta.url)), "src", "module"));
const bytes = readFileSync(join(folder, "contrapposto_web_bg.wasm"));
const { initSync, Session } = await import(pathToFileURL(join(folder, "contrapposto_web.js")));
initSync({ module: bytes });

/** Times of all calls of a session by kind, ms. */
function run() {
  const session = new Session();
  const times = {};
  const ask = (request) => {
    const begin = performance.now();
    const answer = JSON.parse(session.call(JSON.stringify(request)));
    (times[request.do] ??= []).push(performance.now() - begin);
    if (answer.is === "refused") throw new Error(answer.sentence);
  };
  ask({ do: "open", scenario: "" });
  ask({ do: "grab", segment: "hand_r", point: [0, -0.08, 0] });
  for (let k = 0; k < FRAMES; k++) {
    ask({ do: "drag", target: [0.3 + 0.12 * Math.sin(0.13 * k), 1.05 + 0.25 * Math.sin(0.07 * k), 0.2 + 0.15 * Math.cos(0.11 * k)] });
  }
  ask({ do: "release", hold: true });
  for (let k = 0; k < FRAMES; k++) ask({ do: "settle" });
  session.free();
  return times;
}

const runs = Array.from({ length: RUNS }, run);
const size = (name, length) => console.log(`${name}: ${length} bytes`);
size("module", bytes.length);
size("gzip -9", gzipSync(bytes, { level: 9 }).length);
size("brotli", brotliCompressSync(bytes).length);
for (const kind of ["drag", "settle"]) {
  const fastest = runs[0][kind].map((_, i) => Math.min(...runs.map((times) => times[kind][i])));
  const sorted = fastest.sort((a, b) => a - b);
  const at = (share) => sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))].toFixed(2);
  console.log(`${kind}: median ${at(0.5)} ms, p95 ${at(0.95)} ms, longest ${at(1)} ms`);
}
