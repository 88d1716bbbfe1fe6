// A recorded motion is dropped on the page; the page in words, for those who do not see it.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { atRest, close, open, result, root, useBrowser } from "./browser.mjs";

useBrowser();

/** A file that is dropped on the page, as from a file manager. */
const drop = (page, name, text) =>
  page.evaluate(([name, text]) => {
    const given = new DataTransfer();
    given.items.add(new File([text], name));
    window.dispatchEvent(new DragEvent("drop", { dataTransfer: given, cancelable: true }));
  }, [name, text]);

test("a motion that is dropped is looked at moment by moment, a moment is kept, and a broken file is refused with its line", async () => {
  const opened = await open();
  const { page } = opened;
  await atRest(page);
  const before = await result(page);
  const elbow = before.names.indexOf("elbow_flex_r");
  const header = "arms\nversion=1\nnRows=3\nnColumns=2\ninDegrees=yes\nendheader\ntime\telbow_flex_r\n";
  await drop(page, "arms.mot", `${header}0\t10\n0.5\t50\n1\t90\n`);
  await page.waitForSelector("#moment");
  await atRest(page);
  const degrees = async () => ((await result(page)).q[elbow] * 180) / Math.PI;
  assert.ok(Math.abs((await degrees()) - 10) < 1e-9);
  await page.locator("#moment").evaluate((slider) => {
    slider.value = "2";
    slider.dispatchEvent(new Event("input", { bubbles: true }));
  });
  await page.waitForFunction((elbow) => Math.abs(JSON.parse(document.querySelector("#result").textContent).q[elbow] - Math.PI / 2) < 1e-9, elbow);
  assert.ok(Math.abs((await result(page)).external[elbow]) > 1, "the bent forearm weighs nothing");
  await page.click("#moment-close");
  await page.waitForFunction((q) => JSON.parse(document.querySelector("#result").textContent).q.join() === q, before.q.join());
  assert.equal(await page.isDisabled("#undo"), true);
  // Played from the beginning to the end, then kept.
  await drop(page, "arms.mot", `${header}0\t10\n0.5\t50\n1\t80\n`);
  await page.waitForSelector("#moment-play");
  await page.click("#moment-play");
  await page.waitForFunction(() => document.querySelector("#moment").value === "2");
  await atRest(page);
  await page.click("#moment-keep");
  await page.waitForFunction(() => !document.querySelector("#undo").disabled);
  await atRest(page);
  assert.ok(Math.abs((await degrees()) - 80) < 1e-6);
  assert.ok(await page.isHidden("#moment"));
  await drop(page, "arms.mot", `${header}0\tten\n`);
  await page.waitForFunction(() => /arms\.mot, line 8/.test(document.querySelector("#notice").textContent));
  await close(opened);
});

/** Roles that a reader stops at. */
const CONTROLS = ["button", "combobox", "slider", "radio", "spinbutton", "link", "textbox", "checkbox", "img", "image"];

test("every control has a name, changes are announced, and what is shown is told in words", async (t) => {
  const opened = await open();
  const { page, context } = opened;
  await atRest(page);
  const client = await context.newCDPSession(page);
  for (const thing of ["box", "handle", "floor"]) {
    await page.selectOption("#thing", thing);
    const { nodes } = await client.send("Accessibility.getFullAXTree");
    const seen = nodes.filter(({ ignored, role }) => !ignored && CONTROLS.includes(role?.value));
    const nameless = seen.filter(({ name }) => !name?.value?.trim());
    assert.ok(seen.length > 40, `only ${seen.length} controls`);
    assert.deepEqual(nameless.map(({ role, backendDOMNodeId }) => `${role.value} ${backendDOMNodeId}`), []);
    // Within a role no two controls have one name.
    const names = seen.map(({ role, name }) => `${role.value} ${name.value}`);
    assert.deepEqual(names.filter((name, i) => names.indexOf(name) !== i), []);
  }
  const tree = await page.locator("body").ariaSnapshot();
  assert.match(tree, /heading "(Can|Holds|Cannot).*" \[level=1\]/);
  const words = () => page.textContent("#described");
  const first = await words();
  t.diagnostic(first);
  const { verdict } = await result(page);
  assert.ok(first.startsWith(verdict.sentence), first);
  assert.match(first, /Highest load: .+ \d+ %.*Weight: .+ \d+ %, .+ \d+ %/);
  assert.match(tree, /status: "?(Can|Holds|Cannot)/);
  // Another posture is announced once it is at rest, with the group that now works hardest.
  await page.selectOption("#part", { label: "right hand" });
  for (let k = 0; k < 6; k++) await page.click("#move-forward");
  await atRest(page);
  const second = await words();
  t.diagnostic(second);
  assert.notEqual(second, first);
  const shown = await page.evaluate(() => window.studio.shown());
  const highest = Math.round(100 * Math.max(...shown.load));
  assert.ok(second.includes(`Highest load: `) && second.includes(` ${highest} %`), second);
  assert.equal(await page.getAttribute("#described", "aria-live"), "polite");
  await close(opened);
});

test("the report is the program's page: of a posture, and of a run with its decisions and the verdict of the page", async (t) => {
  const scenario = readFileSync(join(root, "scenarios", "stand-relaxed.toml")).toString("base64url");
  const opened = await open(`#scenario=${scenario}`);
  const { page, context, requests } = opened;
  await atRest(page);
  const charts = () => requests.filter((url) => /charts-.*\.txt$/.test(url)).length;
  assert.equal(charts(), 0, "the chart library is loaded before it is asked for");
  const report = async () => {
    const [download] = await Promise.all([page.waitForEvent("download"), page.click("#report")]);
    assert.equal(download.suggestedFilename(), "report.html");
    const file = await download.path();
    const other = await context.newPage();
    await other.setContent(readFileSync(file, "utf8"));
    await other.waitForFunction(() => document.querySelector(".js-plotly-plot"));
    const words = await other.evaluate(() => document.body.innerText);
    const faults = await other.evaluate(() => document.querySelectorAll("canvas").length);
    await other.close();
    return { words, canvases: faults };
  };
  const still = await report();
  assert.ok(still.words.includes((await result(page)).verdict.sentence), still.words.slice(0, 400));
  assert.ok(still.canvases > 0, "no body is drawn");
  assert.ok(!still.words.includes("Decisions"));
  await page.selectOption("#speed", "10");
  await page.click("#play");
  await page.waitForFunction(() => document.querySelectorAll("#log li").length > 0);
  await page.click("#play");
  await page.waitForFunction(() => document.querySelector("#play").getAttribute("aria-pressed") === "false");
  await atRest(page);
  const run = await report();
  const { verdict } = await result(page);
  assert.ok(run.words.includes(verdict.sentence), `${verdict.sentence} is not in ${run.words.slice(0, 400)}`);
  const decision = await page.textContent("#log li");
  t.diagnostic(decision);
  assert.match(run.words, /Decisions/);
  assert.ok(run.words.includes(decision.slice(decision.indexOf(": ") + 2).slice(0, 60)), run.words);
  assert.equal(charts(), 1);
  // The page goes on with its run.
  assert.equal((await result(page)).verdict.sentence, verdict.sentence);
  await close(opened);
});
