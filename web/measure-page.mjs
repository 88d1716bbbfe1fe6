// The built page in headless Chromium: time to the first body, times of its steps as its worker measures them, and memory over an accelerated hour.
// `npm run build && node measure-page.mjs [simulated seconds]`. It says what else the machine does: times of a busy machine are upper bounds.
import { existsSync, readFileSync } from "node:fs";
import { createServer } from "node:http";
import { loadavg } from "node:os";
import { dirname, extname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { chromium } from "playwright-core";

const FRAMES = 600;
const hour = Number(process.argv[2] ?? 3600);
const dist = join(dirname(fileURLToPath(import.meta.url)), "dist");
const TYPES = { ".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".wasm": "application/wasm" };
const server = createServer((request, response) => {
  const name = new URL(request.url, "http://page").pathname;
  const file = join(dist, name === "/" ? "index.html" : name);
  const found = file.startsWith(dist) && existsSync(file);
  response.writeHead(found ? 200 : 404, { "content-type": TYPES[extname(file)] ?? "application/octet-stream" });
  response.end(found ? readFileSync(file) : "");
});
await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
const browser = await chromium.launch({
  executablePath: process.env.CONTRAPPOSTO_CHROMIUM ?? "/usr/bin/chromium",
  args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
});
const page = await browser.newPage({ viewport: { width: 500, height: 400 } });
page.setDefaultTimeout(3_600_000);
const atRest = () => page.waitForFunction(() => document.querySelector("#stage").getAttribute("aria-busy") === "false");
const load = () => `load of the machine ${loadavg().map((x) => x.toFixed(1)).join(", ")}`;

const begin = performance.now();
await page.goto(`http://127.0.0.1:${server.address().port}/`, { waitUntil: "commit" });
await page.waitForFunction(() => JSON.parse(document.querySelector("#result").textContent).q);
console.log(`first body: ${Math.round(performance.now() - begin)} ms (${load()})`);
await page.waitForFunction(() => window.studio.skin());
console.log(`with its skin: ${Math.round(performance.now() - begin)} ms`);
await atRest();

await page.evaluate(async (frames) => {
  const { ask } = window.studio;
  await ask({ do: "grab", segment: "hand_r", point: [0, -0.08, 0] });
  for (let k = 0; k < frames; k++) {
    await ask({ do: "drag", target: [0.3 + 0.12 * Math.sin(0.13 * k), 1.05 + 0.25 * Math.sin(0.07 * k), 0.2 + 0.15 * Math.cos(0.11 * k)] });
    await new Promise(requestAnimationFrame);
  }
  await ask({ do: "release", hold: true });
  for (let k = 0; k < frames; k++) {
    await ask({ do: "settle" });
    await new Promise(requestAnimationFrame);
  }
}, FRAMES);
const times = await page.evaluate(() => window.studio.times());
for (const kind of ["drag", "settle"]) {
  const sorted = times[kind].slice(-FRAMES).sort((a, b) => a - b);
  const at = (share) => sorted[Math.floor(share * (sorted.length - 1))].toFixed(2);
  console.log(`${kind}: median ${at(0.5)} ms, p95 ${at(0.95)} ms, longest ${at(1)} ms of ${sorted.length} (${load()})`);
}

const memory = async (what) => {
  const [worker] = page.workers();
  const module = await worker.evaluate(() => self.memoryBytes());
  const [heap, shapes] = await page.evaluate(() => [performance.memory.usedJSHeapSize, window.studio.geometries()]);
  console.log(`${what}: module ${(module / 1e6).toFixed(1)} MB, page ${(heap / 1e6).toFixed(1)} MB, ${shapes} shapes`);
};
await page.selectOption("#speed", "600");
await page.click("#play");
for (let share = 0.1; share < 1.05; share += 0.1) {
  const due = Math.min(share, 1) * hour * 0.999;
  await page.waitForFunction((due) => JSON.parse(document.querySelector("#result").textContent).time >= due, due);
  await memory(`after ${Math.round(due)} s`);
}
await browser.close();
server.close();
server.closeAllConnections();
