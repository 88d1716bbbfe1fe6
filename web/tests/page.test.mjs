// The page in headless Chromium: lets time run until the tired hip asks, saves the scenario, opens broken files, moves a part by keys.
import assert from "node:assert/strict";
import { execFileSync, spawnSync } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, rmSync } from "node:fs";
import { createServer } from "node:http";
import { tmpdir } from "node:os";
import { dirname, extname, join } from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath } from "node:url";
import { gzipSync } from "node:zlib";
import { chromium } from "playwright-core";

const web = dirname(dirname(fileURLToPath(import.meta.url))), root = dirname(web), dist = join(web, "dist");
const TYPES = { ".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".wasm": "application/wasm", ".svg": "image/svg+xml" };
// This machine may be busy and has no graphics card: waits are long, bounds on times are the measuring test's alone.
const PATIENCE = 180_000;
// Of everything that the first visit loads, compressed by gzip, bytes.
const MOST_LOADED = 1_600_000;

let server, browser, url;

before(async () => {
  server = createServer((request, response) => {
    const name = new URL(request.url, "http://page").pathname;
    const file = join(dist, name === "/" ? "index.html" : name);
    const found = file.startsWith(dist) && existsSync(file);
    response.writeHead(found ? 200 : 404, { "content-type": TYPES[extname(file)] ?? "application/octet-stream" });
    response.end(found ? readFileSync(file) : "");
  });
  await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
  url = `http://127.0.0.1:${server.address().port}/`;
  browser = await chromium.launch({
    executablePath: process.env.CONTRAPPOSTO_CHROMIUM ?? "/usr/bin/chromium",
    args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-quic", "--no-first-run",
      "--disable-background-networking", "--disable-component-update", "--disable-sync"],
  });
});

after(async () => {
  await browser?.close();
  server?.close();
});

async function open(hash = "", viewport = { width: 700, height: 500 }) {
  const context = await browser.newContext({ viewport, acceptDownloads: true });
  context.setDefaultTimeout(PATIENCE);
  const page = await context.newPage();
  page.on("pageerror", (error) => assert.fail(error));
  await page.goto(url + hash, { waitUntil: "commit" });
  await page.waitForFunction(() => JSON.parse(document.querySelector("#result").textContent).q);
  return page;
}

const result = async (page) => JSON.parse(await page.textContent("#result"));

test("time runs until the tired hip asks; the saved scenario gives the same verdict in the program", async (t) => {
  const scenario = readFileSync(join(root, "scenarios", "stand-relaxed.toml"));
  const page = await open(`#scenario=${scenario.toString("base64url")}`);
  await page.selectOption("#speed", "10");
  await page.click("#play");
  await page.waitForFunction(() => document.querySelector("#asking").textContent.includes("hip"));
  await page.click("#play");
  await page.waitForFunction(() => document.querySelector("#play").getAttribute("aria-pressed") === "false");
  await page.waitForTimeout(500);
  assert.ok((await page.locator("#log li").count()) > 0);
  const { verdict, time } = await result(page);
  const [download] = await Promise.all([page.waitForEvent("download"), page.click("#export")]);
  const folder = mkdtempSync(join(tmpdir(), "studio-"));
  const file = join(folder, "studio.toml");
  await download.saveAs(file);
  await page.context().close();
  const program = process.env.CONTRAPPOSTO_PROGRAM;
  const command = program ? [program] : ["cargo", "run", "--quiet", "--locked", "--manifest-path", join(root, "Cargo.toml"), "--"];
  const run = spawnSync(command[0], [...command.slice(1), "simulate", file, "--no-report", "--no-suggest"], { encoding: "utf8" });
  rmSync(folder, { recursive: true });
  t.diagnostic(`after ${time} s: ${verdict.sentence}`);
  assert.equal(run.stdout.split("\n")[0], verdict.sentence, run.stderr);
});

test("a broken file is refused in a sentence with its line, and the body stays", async () => {
  const page = await open();
  const before = await result(page);
  const drop = (name, text) => page.locator("input[type=file]").setInputFiles({ name, mimeType: "text/plain", buffer: Buffer.from(text) });
  await drop("broken.toml", "format = 1\n[model]\nadult = 3\n");
  await page.waitForFunction(() => document.querySelector("#notice").textContent.includes("line 3"));
  await drop("body.osim", "<OpenSimDocument><Model></Model>");
  await page.waitForFunction(() => document.querySelector("#notice").textContent.includes("body.osim"));
  await drop("photo.png", "x");
  await page.waitForFunction(() => document.querySelector("#notice").textContent.includes(".toml"));
  assert.deepEqual((await result(page)).names, before.names);
  await page.context().close();
});

test("every control is reached by the keyboard, and arrow keys on the picture move a part; on a phone nothing is cut off", async () => {
  const page = await open("", { width: 390, height: 780 });
  const wide = await page.evaluate(() => document.documentElement.scrollWidth);
  assert.ok(wide <= 390, `the page is ${wide} px wide`);
  await page.focus("#canvas");
  await page.keyboard.press("PageUp");
  await page.waitForSelector("#free-hand_r");
  const seen = new Set();
  for (let k = 0; k < 60 && !seen.has("link"); k++) {
    await page.keyboard.press("Tab");
    seen.add(await page.evaluate(() => document.activeElement.id));
  }
  for (const id of ["part", "weight", "move-up", "play", "speed", "joint", "sex", "stature", "mass", "export", "open", "link"]) {
    assert.ok(seen.has(id), `${id} is not reached: ${[...seen]}`);
  }
  await page.context().close();
});

test("what a first visit loads is small", (t) => {
  const files = execFileSync("find", [dist, "-type", "f"], { encoding: "utf8" }).trim().split("\n");
  const sizes = files.map((file) => [file.slice(dist.length + 1), gzipSync(readFileSync(file), { level: 9 }).length]);
  sizes.forEach(([name, size]) => t.diagnostic(`${name}: ${size} bytes compressed`));
  const whole = sizes.reduce((sum, [, size]) => sum + size, 0);
  assert.ok(whole < MOST_LOADED, `${whole} bytes`);
});
