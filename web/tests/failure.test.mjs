// What the page does where something fails: a worker that ends, a run that cannot be kept, a run and a drag at once.
import assert from "node:assert/strict";
import { test } from "node:test";
import { atRest, close, newPage, open, port, result, slide, useBrowser, withBody } from "./browser.mjs";

useBrowser();

const notice = (page, text) => page.waitForFunction((text) => document.querySelector("#notice").textContent.includes(text), text);

for (const [how, end, then] of [
  ["ends while nothing is asked of it", () => self.close(), async () => {}],
  ["fails at a request", () => void (JSON.parse = () => { throw new Error("a defect"); }), (page) => page.click("#move-up")],
]) {
  test(`a worker that ${how} is followed by another with the last state`, async () => {
    const opened = await open();
    const { page } = opened;
    await atRest(page);
    await page.selectOption("#part", { label: "right hand" });
    await page.click("#move-up");
    await page.waitForSelector("#free-hand_r");
    await slide(page, "#weight", 5);
    await page.waitForFunction(() => document.querySelector("#weight").value === "5");
    await atRest(page);
    const before = await result(page);
    const [worker] = page.workers();
    await worker.evaluate(end).catch(() => undefined);
    await then(page);
    await notice(page, "began anew");
    await atRest(page);
    assert.deepEqual((await result(page)).names, before.names);
    assert.equal(await page.inputValue("#weight"), "5");
    assert.ok(await page.isVisible("#free-hand_r"), "the hand is not held any more");
    assert.deepEqual((await result(page)).q, before.q);
    // It works again.
    await slide(page, "#weight", 2);
    await atRest(page);
    assert.equal(await page.isDisabled("#undo"), false);
    assert.notDeepEqual((await result(page)).external, before.external);
    await close(opened);
  });
}

/** Before the page begins: its worker refuses `stop` with `take`, as a session does whose posture cannot be kept. */
function refuseToKeep() {
  const post = Worker.prototype.postMessage;
  Worker.prototype.postMessage = function (message) {
    if (message.request?.do !== "stop" || !message.request.take) return post.call(this, message);
    const answer = { is: "refused", sentence: "the elbow is outside its range" };
    this.dispatchEvent(new MessageEvent("message", { data: { kind: "answer", id: message.id, answer, ms: 0 } }));
  };
}

test("a posture of a run that cannot be kept: the page says how to end the run, and that works", async () => {
  const opened = await newPage();
  const { page } = opened;
  await page.addInitScript(refuseToKeep);
  await page.goto(`http://127.0.0.1:${port()}/`, { waitUntil: "commit" });
  await withBody(page);
  await atRest(page);
  await page.click("#play");
  await page.waitForFunction(() => JSON.parse(document.querySelector("#result").textContent).time > 0);
  await page.click("#keep");
  await notice(page, "Back to the start");
  assert.ok(await page.isVisible("#back"));
  await page.click("#back");
  await page.waitForSelector("#back", { state: "hidden" });
  assert.equal((await result(page)).time, null);
  await page.click("#move-up");
  await page.waitForSelector("#free-hand_r");
  await close(opened);
});

test("play, pause and other controls in quick succession leave the clock and the session of one mind", async () => {
  const opened = await open();
  const { page } = opened;
  await page.selectOption("#part", { label: "right hand" });
  // All at once, while the body still settles.
  await page.evaluate(() => ["play", "play", "move-up", "play", "keep", "play", "back", "move-up"].forEach((id) => document.getElementById(id).click()));
  await atRest(page);
  assert.equal(await page.getAttribute("#play", "aria-pressed"), "false");
  assert.equal(await page.isHidden("#notice"), true, await page.textContent("#notice"));
  assert.ok(await page.isVisible("#free-hand_r"));
  await page.click("#play");
  await page.waitForFunction(() => JSON.parse(document.querySelector("#result").textContent).time > 0);
  assert.equal(await page.getAttribute("#play", "aria-pressed"), "true");
  await page.click("#move-up");
  await atRest(page);
  assert.equal(await page.getAttribute("#play", "aria-pressed"), "false");
  assert.equal((await result(page)).time, null);
  await close(opened);
});
