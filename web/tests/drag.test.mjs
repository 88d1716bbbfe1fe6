// The mouse drags a hand, a weight hangs on it, undo takes both back; no request leaves the page.
import assert from "node:assert/strict";
import { test } from "node:test";
import { atRest, close, newPage, open, port, result, slide, useBrowser, withBody } from "./browser.mjs";

useBrowser();

/** Where a part is on the screen, px. */
async function onScreen(page, part) {
  const [x, y] = await page.evaluate((part) => window.studio.onCanvas(part), part);
  const box = await page.locator("#canvas").boundingBox();
  return [box.x + x, box.y + y];
}

test("the mouse drags a hand, 5 kg change the torques, undo brings the posture back; all requests go to the page's own server", async (t) => {
  const opened = await open();
  const { page, requests } = opened;
  await atRest(page);
  const standing = await result(page);
  const [x, y] = await onScreen(page, "right hand");
  const box = await page.locator("#canvas").boundingBox();
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + 60, y - 90, { steps: 12 });
  // The body follows as long as the button is pressed. The point of the hand that is measured is not the one that was pressed: it lies within, up
  // to 4 cm away, and turns about it.
  await page.waitForFunction(
    ([x, y]) => {
      const at = window.studio.onCanvas("right hand");
      const box = document.querySelector("#canvas").getBoundingClientRect();
      return Math.hypot(box.x + at[0] - x, box.y + at[1] - y) < 12;
    },
    [x + 60, y - 90],
  );
  assert.deepEqual(await page.locator("#canvas").boundingBox(), box, "the picture has moved under the pointer");
  await page.mouse.up();
  await page.waitForSelector("#free-hand_r");
  await atRest(page);
  const dragged = await result(page);
  const shoulder = dragged.names.indexOf("arm_flex_r");
  t.diagnostic(`shoulder flexed by ${dragged.q[shoulder] - standing.q[shoulder]} rad`);
  assert.ok(dragged.q[shoulder] - standing.q[shoulder] > 0.2, "the arm did not follow the mouse");

  await page.selectOption("#part", { label: "right hand" });
  await slide(page, "#weight", 5);
  await page.waitForFunction((before) => JSON.parse(document.querySelector("#result").textContent).external.join() !== before, dragged.external.join());
  await atRest(page);
  const loaded = await result(page);
  const change = loaded.external[shoulder] - dragged.external[shoulder];
  t.diagnostic(`external torque of the shoulder ${dragged.external[shoulder]}, with 5 kg ${loaded.external[shoulder]} N m`);
  // Shares of the weight are those of body and loads: 100 % together, but for the digits that are left out.
  const weights = (await page.textContent("#contacts")).match(/\d+(?= %)/g).map(Number);
  assert.ok(weights.length > 1 && Math.abs(weights.reduce((a, b) => a + b) - 100) <= weights.length / 2, String(weights));
  // 5 kg, 2 cm or more before the axis of the shoulder.
  assert.ok(Math.abs(change) > 5 * 9.81 * 0.02, `external torque of the shoulder changed by ${change} N m`);

  await page.click("#undo");
  await page.waitForFunction(() => document.querySelector("#weight").value === "0");
  await atRest(page);
  assert.deepEqual((await result(page)).q, dragged.q);
  // The same posture, its torques computed anew.
  const apart = (await result(page)).external.map((torque, i) => Math.abs(torque - dragged.external[i]));
  assert.ok(Math.max(...apart) < 1e-9, `external torques differ by ${Math.max(...apart)} N m`);
  await page.keyboard.press("Control+z");
  await page.waitForFunction(() => !document.querySelector("#free-hand_r"));
  await atRest(page);
  assert.deepEqual((await result(page)).q, standing.q);

  assert.ok(requests.some((url) => url.endsWith(".wasm")), "the worker's requests were not counted");
  const elsewhere = requests.filter((url) => new URL(url).origin !== `http://127.0.0.1:${port()}` && !/^(blob|data):/.test(url));
  assert.deepEqual(elsewhere, []);
  await close(opened);
});

test("a press without a motion, and one beside the body, change nothing", async () => {
  const opened = await open();
  const { page } = opened;
  await atRest(page);
  const before = await result(page);
  const [x, y] = await onScreen(page, "right hand");
  await page.mouse.click(x, y);
  await atRest(page);
  await page.mouse.click(20, y);
  await atRest(page);
  assert.equal(await page.isDisabled("#undo"), true);
  assert.deepEqual((await result(page)).names, before.names);
  await close(opened);
});

test("twenty changes leave as many shapes on the graphics card as none", async (t) => {
  const opened = await open();
  const { page } = opened;
  await atRest(page);
  await page.evaluate(() => new Promise(requestAnimationFrame));
  const before = await page.evaluate(() => window.studio.geometries());
  for (let k = 0; k < 10; k++) {
    // Another body, then the same body in other postures: a change ends the settling after the one before.
    await slide(page, "#stature", k % 2 ? 1.65 : 1.85);
    await slide(page, "#weight", k + 1);
    await page.waitForFunction((weight) => document.querySelector("#weight").value === weight, String(k + 1));
    await page.waitForTimeout(200);
  }
  await atRest(page);
  await page.waitForTimeout(500);
  const after = await page.evaluate(() => window.studio.geometries());
  t.diagnostic(`${before} shapes, then ${after}`);
  assert.ok(before > 10, "nothing was drawn");
  assert.ok(after <= before + 3, `${before} shapes became ${after}`);
  await close(opened);
});

test("where a drag ends depends on the places of the pointer alone, not on the times at which they come", async (t) => {
  const ways = Array.from({ length: 30 }, (_, k) => [0.012 * k, 0.3 * Math.sin(0.1 * k), 0.1 * Math.sin(0.23 * k)]);
  const ends = [];
  for (const [pause, picture] of [[0, 0], [30, 0], ["by chance", 0], [10, 120]]) {
    const opened = await newPage();
    const { page } = opened;
    // Pictures that come late.
    await page.addInitScript((late) => {
      const request = window.requestAnimationFrame.bind(window);
      if (late) window.requestAnimationFrame = (draw) => request(() => setTimeout(draw, late));
    }, picture);
    await page.goto(`http://127.0.0.1:${port()}/`, { waitUntil: "commit" });
    await withBody(page);
    await atRest(page);
    await page.evaluate(([ways, pause]) => window.studio.drag(ways, () => (typeof pause === "number" ? pause : 90 * Math.random())), [ways, pause]);
    await page.waitForSelector("#free-hand_r");
    await atRest(page);
    ends.push(await result(page));
    await close(opened);
  }
  const elbow = ends[0].names.indexOf("elbow_flex_r");
  t.diagnostic(`elbow ${ends.map(({ q }) => q[elbow]).join(", ")} rad`);
  for (const end of ends.slice(1)) {
    assert.deepEqual(end.q, ends[0].q);
    assert.deepEqual(end.external, ends[0].external);
  }
});

test("the mouse puts a foot elsewhere: it stands there, the other one stays, undo brings it back", async (t) => {
  const opened = await open();
  const { page } = opened;
  await atRest(page);
  const standing = await result(page);
  const patches = () => page.evaluate(() => window.studio.shown().patches);
  const before = await patches();
  await page.click("#view-right");
  const [x, y] = await onScreen(page, "right foot");
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + 35, y - 20, { steps: 10 });
  await page.mouse.up();
  await page.waitForFunction(() => !document.querySelector("#undo").disabled);
  await atRest(page);
  assert.equal(await page.isHidden("#notice"), true, await page.textContent("#notice"));
  const ways = (await patches()).map((corner, i) => corner.map((x, k) => x - before[i][k]));
  t.diagnostic(JSON.stringify(ways));
  const far = ([x, , z]) => Math.hypot(x, z);
  const [moved, stayed] = [ways.filter((way) => far(way) > 0.05), ways.filter((way) => far(way) < 1e-3)];
  assert.deepEqual([moved.length, stayed.length], [4, 4]);
  assert.ok(ways.every(([, up]) => Math.abs(up) < 1e-3), "a sole is off the floor");
  assert.equal(await page.locator("#held button").count(), 0);
  await page.click("#undo");
  await page.waitForFunction((q) => JSON.parse(document.querySelector("#result").textContent).q.join() === q, standing.q.join());
  await close(opened);
});
