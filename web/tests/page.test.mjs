// The page in headless Chromium: lets time run until the tired hip asks, saves the scenario, opens broken files, moves a part by keys.
import assert from "node:assert/strict";
import { execFileSync, spawnSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
import { gzipSync } from "node:zlib";
import { close, dist, open, result, root, useBrowser } from "./browser.mjs";

// Of everything that the first visit loads, compressed by gzip, bytes; the skin (0.29 MB) is loaded after the first picture.
const MOST_LOADED = 1_600_000;

useBrowser();

test("time runs until the tired hip asks; the saved scenario gives the same verdict in the program", async (t) => {
  const scenario = readFileSync(join(root, "scenarios", "stand-relaxed.toml"));
  const opened = await open(`#scenario=${scenario.toString("base64url")}`);
  const { page } = opened;
  await page.selectOption("#speed", "10");
  await page.click("#play");
  await page.waitForFunction(() => document.querySelector("#asking").textContent.includes("hip"));
  await page.click("#play");
  await page.waitForFunction(() => document.querySelector("#play").getAttribute("aria-pressed") === "false");
  assert.ok((await page.locator("#log li").count()) > 0);
  const [download] = await Promise.all([page.waitForEvent("download"), page.click("#export")]);
  const folder = mkdtempSync(join(tmpdir(), "studio-"));
  const file = join(folder, "studio.toml");
  await download.saveAs(file);
  // The file waits for the step that was under way at the pause; the sentence of that step is the one to compare.
  const { verdict, time } = await result(page);
  await close(opened);
  const program = process.env.CONTRAPPOSTO_PROGRAM;
  const command = program ? [program] : ["cargo", "run", "--quiet", "--locked", "--manifest-path", join(root, "Cargo.toml"), "--"];
  const run = spawnSync(command[0], [...command.slice(1), "simulate", file, "--no-report", "--no-suggest"], { encoding: "utf8" });
  rmSync(folder, { recursive: true });
  t.diagnostic(`after ${time} s: ${verdict.sentence}`);
  assert.equal(run.stdout.split("\n")[0], verdict.sentence, run.stderr);
});

test("picture, body and motion come out as files, and findings stand below the picture", async () => {
  const opened = await open();
  const { page } = opened;
  await page.waitForFunction(() => window.studio.skin());
  for (const [id, name, head] of [["png", "studio.png", "\u0089PNG"], ["gltf", "studio.glb", "glTF"], ["bvh", "studio.bvh", "HIERARCHY"]]) {
    const [download] = await Promise.all([page.waitForEvent("download"), page.click(`#${id}`)]);
    assert.equal(download.suggestedFilename(), name);
    const bytes = readFileSync(await download.path());
    assert.equal(bytes.subarray(0, head.length).toString("latin1"), head);
    // A picture of the body, not an empty one; a body with its skin.
    assert.ok(bytes.length > { png: 8_000, gltf: 300_000, bvh: 2_000 }[id], `${name}: ${bytes.length} bytes`);
  }
  assert.ok((await page.locator("#lines li").count()) > 0);
  await close(opened);
});

test("a box, a bag, a tool, a handle, a step, a seat and a table are put there and taken away", async (t) => {
  const opened = await open();
  const { page } = opened;
  await page.waitForFunction(() => document.querySelector("#stage").getAttribute("aria-busy") === "false");
  for (const word of ["bag", "box", "tool", "handle", "step", "seat", "table"]) {
    await page.selectOption("#thing", word);
    await page.click("#put");
    await page.waitForSelector(`#away-${word}-0`);
    t.diagnostic(`${word}: ${(await result(page)).verdict.sentence}`);
    await page.click(`#away-${word}-0`);
    await page.waitForFunction((word) => !document.querySelector(`#away-${word}-0`), word);
  }
  await page.selectOption("#thing", "box");
  await page.fill("#thing-mass", "500");
  await page.click("#put");
  assert.equal(await page.locator("#things li").count(), 0, "a box of 500 kg is not put there");
  await close(opened);
});

test("a broken file is refused in a sentence with its line, and the body stays", async () => {
  const opened = await open();
  const { page } = opened;
  const before = await result(page);
  const drop = (name, text) => page.locator("input[type=file]").setInputFiles({ name, mimeType: "text/plain", buffer: Buffer.from(text) });
  await drop("broken.toml", "format = 1\n[model]\nadult = 3\n");
  await page.waitForFunction(() => document.querySelector("#notice").textContent.includes("line 3"));
  await drop("body.osim", "<OpenSimDocument><Model></Model>");
  await page.waitForFunction(() => document.querySelector("#notice").textContent.includes("body.osim"));
  await drop("photo.png", "x");
  await page.waitForFunction(() => document.querySelector("#notice").textContent.includes(".toml"));
  assert.deepEqual((await result(page)).names, before.names);
  await close(opened);
});

test("every control is reached by the keyboard, and arrow keys on the picture move a part; on a phone nothing is cut off", async () => {
  const opened = await open("", { width: 390, height: 780 });
  const { page } = opened;
  const wide = await page.evaluate(() => document.documentElement.scrollWidth);
  assert.ok(wide <= 390, `the page is ${wide} px wide`);
  await page.focus("#canvas");
  await page.keyboard.press("PageUp");
  await page.waitForSelector("#free-hand_r");
  const seen = new Set();
  for (let k = 0; k < 80 && !seen.has("link"); k++) {
    await page.keyboard.press("Tab");
    seen.add(await page.evaluate(() => document.activeElement.id));
  }
  for (const id of ["part", "weight", "move-up", "play", "speed", "joint", "figure", "mirror", "sex", "stature", "mass", "export", "open", "link"]) {
    assert.ok(seen.has(id), `${id} is not reached: ${[...seen]}`);
  }
  await close(opened);
});

test("what a first visit loads is small", (t) => {
  const files = execFileSync("find", [dist, "-type", "f"], { encoding: "utf8" }).trim().split("\n");
  const sizes = files.map((file) => [file.slice(dist.length + 1), gzipSync(readFileSync(file), { level: 9 }).length]);
  sizes.forEach(([name, size]) => t.diagnostic(`${name}: ${size} bytes compressed`));
  const whole = sizes.reduce((sum, [, size]) => sum + size, 0);
  assert.ok(whole < MOST_LOADED, `${whole} bytes`);
});
