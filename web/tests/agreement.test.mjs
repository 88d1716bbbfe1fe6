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

// The answers of both to the same requests, which must be the same texts, to the last digit of each number.
function both(requests) {
  const [ours, theirs] = [inModule(requests), natively(requests)];
  assert.equal(ours.length, theirs.length);
  ours.forEach((answer, i) => {
    assert.ok(answer === theirs[i], `answer ${i} to ${JSON.stringify(requests[i]).slice(0, 100)} differs`);
    assert.ok(!answer.startsWith('{"is":"refused"'), answer);
  });
  return ours.map((answer) => JSON.parse(answer));
}

test("200 drags, torques of a joint, a load: the module and the native program give the same bytes", () => {
  const answers = both(drags(200));
  assert.equal(answers[0].is, "scene");
});

test("ten minutes of stand-relaxed: the module and the native program give the same bytes", () => {
  const last = both(run("stand-relaxed", 600)).at(-1);
  assert.ok(last.log.length > 1, JSON.stringify(last.log));
});

test("settling: the module and the native program give the same bytes", () => {
  const answers = both([{ do: "open", scenario: "" }, ...Array.from({ length: 100 }, () => ({ do: "settle" }))]);
  const [first, last] = [answers[1], answers.at(-1)].map(({ load }) => load.reduce((sum, share) => sum + share * share, 0));
  assert.ok(last < first, `effort ${first}, ${last}`);
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
