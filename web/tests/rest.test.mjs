// Ways to rest, mirror, looking back, help and tour, and what a reload keeps.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { atRest, close, open, result, root, slide, useBrowser, withBody } from "./browser.mjs";

useBrowser();

const scenario = (name) => `#scenario=${readFileSync(join(root, "scenarios", `${name}.toml`)).toString("base64url")}`;

test("ways to rest are searched for, the search can be stopped, a press goes to one of them and undo comes back", async (t) => {
  const opened = await open(scenario("stand-relaxed-feet-fixed"));
  const { page } = opened;
  await atRest(page);
  await page.click("#rest");
  await page.waitForFunction(() => /[1-9]\d* postures/.test(document.querySelector("#rest-told").textContent));
  // The page goes on while the search does.
  await page.click("#view-front");
  await page.click("#rest-stop");
  await page.waitForFunction(() => document.querySelector("#rest-told").textContent.includes("stopped"));
  assert.equal(await page.locator("#ways li").count(), 0);
  await page.click("#rest");
  await page.waitForSelector("#way-2");
  const words = await page.locator("#ways button span").allTextContents();
  t.diagnostic(words.join(" | "));
  const efforts = words.map((text) => Number(/effort ([\d.]+)/.exec(text)[1]));
  assert.deepEqual(efforts, [...efforts].sort((a, b) => a - b));
  assert.match(words[0], /on ligaments: .*(hip|knee|ankle)/);
  await page.waitForFunction(() => [...document.querySelectorAll("#ways img")].every((img) => img.naturalWidth === 192));
  const before = await result(page);
  await page.click("#way-2");
  await page.waitForFunction((q) => JSON.parse(document.querySelector("#result").textContent).q.join() !== q, before.q.join());
  await atRest(page);
  const there = await result(page);
  const effort = there.verdict.sentence === (await page.getAttribute("#way-2", "title"));
  assert.ok(effort, `${there.verdict.sentence} is not the sentence of the way`);
  await page.click("#undo");
  await page.waitForFunction((q) => JSON.parse(document.querySelector("#result").textContent).q.join() === q, before.q.join());
  await close(opened);
});

test("left and right are exchanged, with the weight; a reload keeps it", async () => {
  const opened = await open();
  const { page } = opened;
  await atRest(page);
  await page.selectOption("#part", { label: "right hand" });
  await page.click("#move-forward");
  await page.waitForSelector("#free-hand_r");
  await slide(page, "#weight", 4);
  await page.waitForFunction(() => document.querySelector("#weight").value === "4");
  await atRest(page);
  const before = await result(page);
  await page.click("#mirror");
  await page.waitForSelector("#free-hand_l");
  await atRest(page);
  const image = await result(page);
  const elbow = (side) => before.names.indexOf(`elbow_flex_${side}`);
  for (const key of ["q", "external"]) assert.ok(Math.abs(image[key][elbow("l")] - before[key][elbow("r")]) < 1e-6);
  await page.selectOption("#part", { label: "left hand" });
  assert.equal(await page.inputValue("#weight"), "4");
  await page.reload();
  await withBody(page);
  await page.waitForSelector("#free-hand_l");
  await atRest(page);
  assert.deepEqual((await result(page)).q, image.q);
  await close(opened);
});

test("a run is looked at as it was, and “now” returns; the picture stays where it is while time runs", async () => {
  const opened = await open(scenario("stand-relaxed"));
  const { page } = opened;
  await atRest(page);
  const place = () => page.evaluate(() => [document.querySelector("#canvas").getBoundingClientRect().top + scrollY, document.querySelector("#canvas").clientHeight]);
  const before = await place();
  await page.selectOption("#speed", "10");
  await page.click("#play");
  await page.waitForFunction(() => JSON.parse(document.querySelector("#result").textContent).time > 8);
  assert.deepEqual(await place(), before);
  await page.click("#play");
  await page.waitForFunction(() => document.querySelector("#play").getAttribute("aria-pressed") === "false");
  await atRest(page);
  const now = await result(page);
  const look = (time) => page.locator("#past").evaluate((slider, time) => {
    slider.value = time;
    slider.dispatchEvent(new Event("input", { bubbles: true }));
  }, String(time));
  await look(2);
  await page.waitForFunction(() => JSON.parse(document.querySelector("#result").textContent).time <= 2);
  assert.notDeepEqual((await result(page)).q, now.q);
  assert.match(await page.textContent("#clock"), /^(1\.9\d|2\.00)\u00a0s$/);
  await page.click("#now");
  await page.waitForFunction((time) => JSON.parse(document.querySelector("#result").textContent).time === time, now.time);
  assert.deepEqual((await result(page)).q, now.q);
  await close(opened);
});

test("help and tour by the keyboard alone", async () => {
  const opened = await open();
  const { page } = opened;
  await page.focus("#help");
  await page.keyboard.press("Enter");
  await page.waitForSelector("#help-text[open]");
  const fits = await page.locator("#help-text").evaluate((dialog) => dialog.getBoundingClientRect().bottom <= innerHeight);
  assert.ok(fits, "the help is longer than the screen");
  await page.focus("#tour");
  await page.keyboard.press("Enter");
  for (let step = 1; step <= 6; step++) {
    await page.waitForFunction((step) => document.querySelector("#tip p").textContent.startsWith(`${step} of 6`), step);
    assert.equal(await page.locator(".pointed").count(), 1);
    await page.keyboard.press("Enter");
  }
  assert.ok(await page.isHidden("#tip"));
  assert.equal(await page.evaluate(() => document.activeElement.id), "help");
  await close(opened);
});
