// A force is drawn by the mouse and made greater by a key, a hand snaps to a table, legs alone are ready, a percentile gives a size.
import assert from "node:assert/strict";
import { test } from "node:test";
import { atRest, close, open, result, slide, useBrowser } from "./browser.mjs";

useBrowser();

/** Where a part is on the screen, px. */
async function onScreen(page, part) {
  const [x, y] = await page.evaluate((part) => window.studio.onCanvas(part), part);
  const box = await page.locator("#canvas").boundingBox();
  return [box.x + x, box.y + y];
}

/** The document as a file. */
async function saved(page) {
  const answer = await page.evaluate(() => window.studio.ask({ do: "export" }));
  return answer.text;
}

test("a drag draws a force, which changes the torques and not the posture; keys make it greater; a button takes it off", async (t) => {
  const opened = await open();
  const { page } = opened;
  await atRest(page);
  await page.check("#pushing");
  const [x, y] = await onScreen(page, "right hand");
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + 30, y - 10, { steps: 6 });
  const told = await page.textContent("#notice");
  assert.match(told, /^\d+ N$/);
  await page.mouse.up();
  await page.waitForSelector("#off-hand_r");
  await atRest(page);
  const force = (text) => text.match(/force_n = \[([^\]]*)\]/)?.[1].split(",").map(Number);
  const drawn = force(await saved(page));
  t.diagnostic(`${told}: ${drawn}`);
  assert.ok(Math.abs(Math.hypot(...drawn) - parseFloat(told)) < 0.2, `${drawn} for ${told}`);
  assert.equal(await page.locator("#held li button").count(), 0, "a push holds nothing in place");
  // The right hand is the chosen part: a key pushes it forward by 10 N more.
  await page.selectOption("#part", { label: "right hand" });
  await page.focus("#canvas");
  await page.keyboard.press("ArrowUp");
  await page.waitForFunction((before) => document.querySelector("#off-hand_r")?.textContent !== before, await page.textContent("#off-hand_r"));
  await atRest(page);
  const pressed = force(await saved(page));
  assert.ok(Math.abs(pressed[0] - drawn[0] - 10) < 0.11 && Math.abs(pressed[1] - drawn[1]) < 0.11, `${drawn}, then ${pressed}`);
  await page.click("#off-hand_r");
  await page.waitForFunction(() => !document.querySelector("#off-hand_r"));
  assert.equal(force(await saved(page)), undefined);
  await page.click("#undo");
  await page.waitForSelector("#off-hand_r");
  await close(opened);
});

test("a hand that is dragged near to the top of a table is on it, and the page says so", async (t) => {
  const opened = await open();
  const { page } = opened;
  await atRest(page);
  await page.selectOption("#thing", "table");
  await page.fill("#thing-height", "0.9");
  await page.click("#put");
  await page.waitForSelector("#away-table-0");
  await atRest(page);
  // The tip of the fingers, the farthest point of the hand's shape from the wrist, goes above the table, then to 2 cm over its top.
  const tip = await page.evaluate(() => {
    const balls = window.studio.scene().segments.find(({ name }) => name === "hand_r").hulls.flat();
    const [x, y, z, radius] = balls.reduce((low, ball) => (ball[1] - ball[3] < low[1] - low[3] ? ball : low));
    return [x, y - radius, z];
  });
  const before = await page.evaluate(async (tip) => {
    const before = window.studio.place(tip);
    const ways = [[0.05, 0.35], [0.2, 0.35], [0.35, 0.3], [0.45, 0.2]].map(([ahead, up]) => [ahead, up, 0]);
    await window.studio.drag([...ways, [0.5, 0.92 - before[1], 0]], () => 30, tip);
    return before;
  }, tip);
  await page.waitForFunction(() => document.querySelector("#notice").textContent.startsWith("On the table"));
  await atRest(page);
  const height = await page.evaluate((tip) => window.studio.place(tip)[1], tip);
  t.diagnostic(`fingers at ${before}, then at ${height} m over the floor of a table of 0.9 m`);
  assert.ok(Math.abs(height - 0.9) < 0.005, `${height} m`);
  await close(opened);
});

test("the legs alone are ready; a percentile gives a size and its words", async () => {
  const opened = await open();
  const { page } = opened;
  await atRest(page);
  assert.equal(await page.isChecked("#passive"), true);
  await page.selectOption("#region", "legs");
  await page.check("#active");
  await page.waitForFunction(() => document.querySelector("#active").checked);
  await atRest(page);
  assert.match(await saved(page), /\[strategy\.of\]\s+legs = "active"/);
  await page.selectOption("#region", "arms");
  assert.equal(await page.isChecked("#passive"), true);
  await page.selectOption("#region", "");
  assert.deepEqual([await page.isChecked("#passive"), await page.isChecked("#active")], [false, false], "neither is that of the whole body");
  await page.selectOption("#sex", "male");
  // A button on top of the panel brings the part of the page into view, and the keyboard with it.
  await page.click("#jumps button:has-text('Body')");
  assert.equal(await page.evaluate(() => document.activeElement.closest("section")?.querySelector("h2").textContent), "Body");
  assert.ok(await page.evaluate(() => document.activeElement.getBoundingClientRect().bottom < innerHeight));
  await page.waitForFunction(() => document.querySelector("#percentiles").textContent.length > 0);
  await atRest(page);
  await slide(page, "#percentile", 5);
  await page.waitForFunction(() => document.querySelector("#percentiles").textContent.includes("no taller: 5; no heavier: 5"));
  await atRest(page);
  // 1.756 - 1.645 0.0686 m.
  assert.match(await saved(page), /stature_m = 1\.643\b/);
  assert.ok((await result(page)).q.length > 0);
  await close(opened);
});
