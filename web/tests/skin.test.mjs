// The skin in the page: its vertices are where its bones carry them, it is dragged as the wooden figure is, which stays as a choice.
import assert from "node:assert/strict";
import { test } from "node:test";
import { atRest, close, open, slide, useBrowser } from "./browser.mjs";

useBrowser();

/** A point turned by a quaternion x, y, z, w: v + 2 u x (u x v + w v). */
function turned([x, y, z], [i, j, k, w]) {
  const [a, b, c] = [j * z - k * y + w * x, k * x - i * z + w * y, i * y - j * x + w * z];
  return [x + 2 * (j * c - k * b), y + 2 * (k * a - i * c), z + 2 * (i * b - j * a)];
}

/** The vertices of a skin, each carried by its bones. */
function carried({ vertices, heads, bones, weights }, places) {
  return vertices.flatMap((vertex, v) => {
    const at = [0, 0, 0];
    bones[v].forEach((bone, i) => {
      const place = places[bone];
      const there = turned(vertex.map((x, k) => x - heads[bone][k]), place.slice(3));
      there.forEach((x, k) => (at[k] += (weights[v][i] / 255) * (x + place[k])));
    });
    return at;
  });
}

async function onScreen(page, part) {
  const [x, y] = await page.evaluate((part) => window.studio.onCanvas(part), part);
  const box = await page.locator("#canvas").boundingBox();
  return [box.x + x, box.y + y];
}

test("the adult has a skin whose vertices follow its bones, before and after a drag by the mouse, and after another size", async (t) => {
  const opened = await open();
  const { page } = opened;
  await page.waitForFunction(() => window.studio.skin());
  await atRest(page);
  const check = async (what) => {
    const [drawn, { skin }, shown] = await page.evaluate(async () => [window.studio.skin(), await window.studio.ask({ do: "skin" }), window.studio.shown()]);
    const expected = carried(skin, shown.bones);
    assert.equal(drawn.length, expected.length);
    const apart = Math.max(...drawn.map((x, i) => Math.abs(x - expected[i])).filter((_, i) => i % 7 === 0));
    t.diagnostic(`${what}: ${drawn.length / 3} vertices, farthest ${apart} m`);
    assert.ok(apart < 1e-5, `${what}: a vertex is ${apart} m away`);
    return Math.max(...drawn.filter((_, i) => i % 3 === 1));
  };
  await check("standing");
  const [x, y] = await onScreen(page, "right hand");
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + 50, y - 80, { steps: 10 });
  // The hand is under the mouse; which joints have brought it there depends on how many steps lay between two moves.
  const box = await page.locator("#canvas").boundingBox();
  await page.waitForFunction(([x, y]) => {
    const hand = window.studio.onCanvas("right hand");
    return Math.hypot(hand[0] - x, hand[1] - y) < 5;
  }, [x + 50 - box.x, y - 80 - box.y]);
  await page.mouse.up();
  await page.waitForSelector("#free-hand_r");
  await atRest(page);
  await check("with a hand ahead");
  await slide(page, "#stature", 1.9);
  await page.waitForFunction(() => Math.max(...(window.studio.skin() ?? []).filter((_, i) => i % 3 === 1)) > 1.8);
  await atRest(page);
  const top = await check("1.90 m tall");
  assert.ok(Math.abs(top - 1.9) < 0.06, `${top} m`);
  await close(opened);
});

test("the wooden figure is a choice, and what an imported body has", async () => {
  const opened = await open();
  const { page } = opened;
  await page.waitForFunction(() => window.studio.skin());
  await atRest(page);
  const picture = () => page.locator("#canvas").screenshot();
  const skin = await picture();
  await page.selectOption("#figure", "wooden");
  await page.waitForFunction(() => window.studio.figure() === "wooden");
  assert.notDeepEqual(await picture(), skin);
  await page.selectOption("#figure", "person");
  await page.waitForFunction(() => window.studio.figure() === "person");
  assert.deepEqual(await picture(), skin);
  const arm = '<robot name="arm"><link name="base"/><link name="bar"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link><joint name="hinge" type="revolute"><parent link="base"/><child link="bar"/><axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="20" velocity="1"/></joint></robot>';
  await page.locator("input[type=file]").setInputFiles({ name: "arm.urdf", mimeType: "text/plain", buffer: Buffer.from(arm) });
  await page.waitForFunction(() => window.studio.figure() === "wooden" && document.querySelector("#figure").disabled);
  await close(opened);
});
