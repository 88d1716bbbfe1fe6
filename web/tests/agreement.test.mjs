// The module of the page and the native program give the same: 200 drags, settling, torques, ten minutes of a run.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { test } from "node:test";
import { fileURLToPath } from "node:url";

const web = dirname(dirname(fileURLToPath(import.meta.url))), root = dirname(web);
const twin = join(process.env.CARGO_TARGET_DIR ?? join(root, "target"), "debug", "examples", "twin");
const { initSync, Session } = await import("../src/module/contrapposto_web.js");
initSync({ module: readFileSync(join(web, "src", "module", "contrapposto_web_bg.wasm")) });

const scenario = (name) => readFileSync(join(root, "scenarios", `${name}.toml`), "utf8");

// A hand along a closed figure before the body.
function drags(count) {
  const point = (k) => [0.3 + 0.12 * Math.sin(0.13 * k), 1.05 + 0.25 * Math.sin(0.07 * k), 0.2 + 0.15 * Math.cos(0.11 * k)];
  const requests = [{ do: "open", scenario: "" }, { do: "grab", segment: "hand_r", point: [0, -0.08, 0] }];
  for (let k = 0; k < count; k++) requests.push({ do: "drag", target: point(k) });
  return [...requests, { do: "balance", coordinate: "elbow_flex_r" }, { do: "release", hold: true }, { do: "load", segment: "hand_r", mass: 5 }];
}

function run(name, seconds) {
  const calls = Array.from({ length: seconds }, () => ({ do: "play", samples: 30 }));
  return [{ do: "open", scenario: scenario(name).replace(/duration_s = \d+/, "duration_s = 600") }, ...calls];
}

function inModule(requests) {
  const session = new Session();
  return requests.map((request) => session.call(JSON.stringify(request)));
}

function natively(requests) {
  const input = requests.map((request) => JSON.stringify(request)).join("\n");
  const { stdout, status, error } = spawnSync(twin, { input, encoding: "utf8", maxBuffer: 1 << 30 });
  assert.equal(status, 0, String(error ?? "the twin ended badly"));
  return stdout.trimEnd().split("\n");
}

// The greatest difference of two answers, in shares of numbers above 1; texts and shapes must be equal.
function difference(a, b, path) {
  if (typeof a === "number" && typeof b === "number") return Math.abs(a - b) / Math.max(1, Math.abs(a));
  if (typeof a === "object" && a !== null && b !== null && typeof b === "object") {
    assert.deepEqual(Object.keys(a), Object.keys(b), path);
    return Math.max(0, ...Object.keys(a).map((key) => difference(a[key], b[key], `${path}.${key}`)));
  }
  assert.equal(a, b, path);
  return 0;
}

// The answers of both to the same requests.
function both(requests) {
  const [ours, theirs] = [inModule(requests), natively(requests)].map((answers) => answers.map((text) => JSON.parse(text)));
  assert.equal(ours.length, theirs.length);
  ours.forEach((answer, i) => assert.notEqual(answer.is, "refused", `${JSON.stringify(requests[i])}: ${answer.sentence}`));
  return [ours, theirs];
}

test("200 drags, torques of a joint, a load: the module agrees with the native program to 1e-9", (t) => {
  const [ours, theirs] = both(drags(200));
  const greatest = Math.max(...ours.map((answer, i) => difference(answer, theirs[i], String(i))));
  t.diagnostic(`greatest difference ${greatest}`);
  assert.ok(greatest < 1e-9, String(greatest));
});

// Probably the libraries of the two differ in the last digit of sines and exponentials. Where a body descends to its posture of least effort, a search
// passes through postures that depend on that digit; the posture that it comes to does not.
test("ten minutes of stand-relaxed: the same decisions; postures to 1e-9, torques to 1e-8, but within one second of descent", (t) => {
  const [ours, theirs] = both(run("stand-relaxed", 600));
  const told = (answers) => answers.map(({ asking, decisions, ended }) => ({ asking, decisions, ended }));
  assert.deepEqual(told(ours), told(theirs));
  const sentences = (answers) => answers.at(-1).log.map(({ time, sentence }) => [time, sentence]);
  assert.deepEqual(sentences(ours), sentences(theirs));
  assert.deepEqual(ours.at(-1).shown.verdict.sentence, theirs.at(-1).shown.verdict.sentence);
  // Sine and cosine of the two differ in last digits, so descents end at the same minimum, not at the same digits of it. Tissue and weight make
  // torques of a difference of posture: up to about 100 N m of a radian.
  const apart = ({ shown: a }, { shown: b }) =>
    Math.max(difference(a.q, b.q, "q"), ...["external", "passive", "active"].map((key) => 0.1 * difference(a[key], b[key], key)));
  const differences = ours.slice(1).map((answer, i) => apart(answer, theirs[i + 1]));
  const far = differences.filter((one) => one > 1e-9);
  t.diagnostic(`answers that differ by more: ${far.length} of ${differences.length}; of the others ${Math.max(...differences.filter((one) => one <= 1e-9))}`);
  assert.ok(far.length <= 1, `${far.length} seconds differ, by ${Math.max(...far)} at most`);
  assert.ok(differences.at(-1) < 1e-9);
});

test("settling comes to the same effort and verdict", (t) => {
  const requests = [{ do: "open", scenario: "" }, ...Array.from({ length: 100 }, () => ({ do: "settle" }))];
  const [ours, theirs] = both(requests).map((answers) => answers.at(-1));
  const effort = ({ load }) => load.reduce((sum, share) => sum + share * share, 0);
  t.diagnostic(`efforts ${effort(ours)}, ${effort(theirs)}`);
  assert.ok(Math.abs(effort(ours) - effort(theirs)) < 1e-6);
  assert.equal(ours.verdict.kind, theirs.verdict.kind);
});

test("the same requests twice give the same bytes", () => {
  const requests = [...drags(60), ...Array.from({ length: 60 }, () => ({ do: "settle" })), { do: "play", samples: 100 }, { do: "export" }];
  assert.deepEqual(inModule(requests), inModule(requests));
});

test("the module with all readers and writers gives the same bytes", async () => {
  const all = await import("../src/module/all/contrapposto_web.js");
  all.initSync({ module: readFileSync(join(web, "src", "module", "all", "contrapposto_web_bg.wasm")) });
  const requests = [...drags(60), ...Array.from({ length: 60 }, () => ({ do: "settle" })), { do: "play", samples: 100 }, { do: "export" }];
  const session = new all.Session();
  assert.deepEqual(requests.map((request) => session.call(JSON.stringify(request))), inModule(requests));
  // A run is drawn by that module from its course.
  const first = inModule([{ do: "open", scenario: "" }, { do: "play", samples: 10 }, { do: "bvh" }]).map((text) => JSON.parse(text)).at(-1);
  assert.equal(first.is, "elsewhere");
  const ask = (session, request) => JSON.parse(session.call(JSON.stringify(request)));
  const other = new all.Session();
  assert.equal(ask(other, { do: "restore", state: first.state }).is, "scene");
  const whole = new all.Session();
  for (const request of [{ do: "open", scenario: "" }, { do: "play", samples: 10 }]) ask(whole, request);
  assert.deepEqual(ask(other, { do: "bvh", course: first.course }), ask(whole, { do: "bvh" }));
});

test("a scenario that is broken is refused in a sentence", () => {
  const [answer] = inModule([{ do: "open", scenario: "format = 1\n[model]\nadult = 3\n" }]).map((text) => JSON.parse(text));
  assert.equal(answer.is, "refused");
  assert.match(answer.sentence, /line 3, column 9/);
});
