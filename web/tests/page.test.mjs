// The page in headless Chromium: lets time run until the tired hip asks, saves the scenario, opens broken files, moves a part by keys.
import assert from "node:assert/strict";
import { execFileSync, spawnSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
import { gzipSync } from "node:zlib";
import { atRest, close, dist, open, result, root, useBrowser, web } from "./browser.mjs";

// Compressed by gzip, bytes: the module of the solver, and everything that the first visit loads, of which the skin (0.29 MB) comes after the first
// picture; then the module with all readers and writers, which is loaded where a model file is opened or a file for other programs is asked for.
// The licence of the skin is loaded where it is read, and does not count.
const MOST_MODULE = 1_000_000;
const MOST_LOADED = 1_450_000;
const MOST_LATER = 1_300_000;

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

test("a tired hip that is relaxed slouches onto its ligaments, one that is ready does not", async (t) => {
  const scenario = readFileSync(join(root, "scenarios", "stand-relaxed.toml"));
  const ends = {};
  for (const kind of ["passive", "active"]) {
    const opened = await open(`#scenario=${scenario.toString("base64url")}`);
    const { page } = opened;
    await atRest(page);
    await page.check(`#${kind}`);
    await atRest(page);
    await page.selectOption("#speed", "10");
    await page.click("#play");
    await page.waitForFunction(() => JSON.parse(document.querySelector("#result").textContent).time > 10);
    const { names, q } = await result(page);
    const degrees = (name) => (180 / Math.PI) * q[names.indexOf(name)];
    ends[kind] = { list: degrees("pelvis_list"), adduction: degrees("hip_adduction_r") };
    await close(opened);
  }
  t.diagnostic(JSON.stringify(ends));
  // Adduction stretches the ligaments that hold the standing hip from about 20 degrees on, and lowers the pelvis on the other side.
  assert.ok(ends.passive.adduction > 20 && Math.abs(ends.passive.list) > 10, "relaxed: no slouch");
  assert.ok(ends.active.adduction < 12 && Math.abs(ends.active.list) < 6, "ready: a slouch");
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

test("a model file that is dropped loads the module that reads it, and its body has no skin; the scenario of another one brings the adult back", async () => {
  const opened = await open();
  const { page, requests } = opened;
  const modules = () => new Set(requests.filter((url) => url.endsWith(".wasm"))).size;
  assert.equal(modules(), 1);
  const drop = (name, text) => page.locator("input[type=file]").setInputFiles({ name, mimeType: "text/plain", buffer: Buffer.from(text) });
  const link = (name) => `<link name="${name}"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>`;
  const hinge = '<joint name="hinge" type="revolute"><parent link="base"/><child link="bar"/><axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="20" velocity="1"/></joint>';
  await drop("arm.urdf", `<robot name="arm"><link name="base"/>${link("bar")}${hinge}</robot>`);
  await page.waitForFunction(() => JSON.parse(document.querySelector("#result").textContent).names.includes("hinge"));
  assert.equal(modules(), 2);
  assert.equal(await page.isDisabled("#figure"), true);
  await atRest(page);
  await drop("stand.toml", 'format = 1\n[model]\nadult = { sex = "male", stature_m = 1.8, mass_kg = 80 }\n[floor]\n');
  await page.waitForFunction(() => JSON.parse(document.querySelector("#result").textContent).names.includes("elbow_flex_r"));
  await page.waitForFunction(() => window.studio.skin());
  assert.equal(modules(), 2);
  await close(opened);
});

test("the module of the solver is below 1 MB, and what a first visit loads is small", (t) => {
  const files = execFileSync("find", [dist, "-type", "f"], { encoding: "utf8" }).trim().split("\n");
  const packed = (bytes) => gzipSync(bytes, { level: 9 }).length;
  const all = readFileSync(join(web, "src", "module", "all", "contrapposto_web_bg.wasm"));
  const sizes = files.map((file) => ({ name: file.slice(dist.length + 1), bytes: readFileSync(file) }));
  const isLater = ({ name, bytes }) => bytes.equals(all) || /(charts|skin-license)-.*\.txt$/.test(name);
  const [later, first] = [sizes.filter(isLater), sizes.filter((file) => !isLater(file))];
  sizes.forEach(({ name, bytes }) => t.diagnostic(`${name}: ${packed(bytes)} bytes compressed`));
  const modules = first.filter(({ name }) => name.endsWith(".wasm"));
  assert.deepEqual([modules.length, later.length], [1, 3]);
  assert.ok(packed(modules[0].bytes) < MOST_MODULE, `the module has ${packed(modules[0].bytes)} bytes`);
  assert.ok(packed(all) < MOST_LATER, `the module of all has ${packed(all)} bytes`);
  const whole = first.reduce((sum, { bytes }) => sum + packed(bytes), 0);
  assert.ok(whole < MOST_LOADED, `${whole} bytes`);
});
