// Runs the session beside the page: requests in, answers out, in their order.
import init, { Session, last_panic, version } from "./module/contrapposto_web.js";
import address from "./module/contrapposto_web_bg.wasm?url";
import addressOfAll from "./module/all/contrapposto_web_bg.wasm?url";
import chartsAddress from "./module/charts.txt?url";
import skinAddress from "./module/adult.skin?url";
import type { Answer, FromWorker, Request, ToWorker } from "./messages";

// The module calls this function while it searches.
Object.assign(self, { tellSought: (count: number) => send({ kind: "sought", count }) });

let session: Session | undefined;
/** The module with the readers of model files and the writers of files for other programs; its session stands in place of the first one after that
 * has opened such a model. */
let all: Promise<typeof import("./module/all/contrapposto_web.js")> | undefined;
let lastPanic = last_panic;
let skin: Uint8Array | undefined;
let charts: string | undefined;
/** Most samples of one call. */
const MOST_SAMPLES = 100_000;

function send(message: FromWorker): void {
  self.postMessage(message);
}

const call = (session: Session, request: Request) => JSON.parse(session.call(JSON.stringify(request))) as Answer;

/** A session of the module with all readers and writers. */
async function sessionOfAll(): Promise<Session> {
  all ??= import("./module/all/contrapposto_web.js").then(async (module) => {
    await module.default({ module_or_path: addressOfAll });
    return module;
  });
  // A load that has failed, without a network, is tried again.
  const module = await all.catch((error: unknown) => {
    all = undefined;
    throw error;
  });
  lastPanic = () => last_panic() || module.last_panic();
  const made: Session = new module.Session();
  if (skin) made.take_skin(skin);
  if (charts !== undefined) made.take_charts(charts);
  return made;
}

/** Answers with the module that can. */
async function answerOf(request: Request): Promise<Answer> {
  if (!session) throw new Error("the session has ended");
  const answer = call(session, request);
  if (answer.is !== "elsewhere") return answer;
  const other = await sessionOfAll().catch(() => undefined);
  if (!other) return { is: "refused", sentence: "the part of the studio for model files and other programs could not be loaded; is there a network?" };
  if (request.do === "open" || request.do === "open_model") {
    const opened = call(other, request);
    // A file that is refused leaves the session as it is.
    if (opened.is === "scene") session = other;
    else other.free();
    return opened;
  }
  try {
    const restored = call(other, { do: "restore", state: answer.state });
    if (restored.is === "refused") return restored;
    if (request.do !== "report") return call(other, { ...request, course: answer.course ?? undefined } as Request);
    // The same run again.
    for (let left = answer.samples; left > 0; left -= MOST_SAMPLES) {
      const played = call(other, { do: "play", samples: Math.min(left, MOST_SAMPLES) });
      if (played.is === "refused") return played;
    }
    return call(other, request);
  } finally {
    other.free();
  }
}

async function answer({ id, request }: ToWorker): Promise<void> {
  const begin = performance.now();
  try {
    if (request.do === "report") await Promise.all([loadSkin(), loadCharts()]);
    if (request.do === "skin" || (request.do === "gltf" && !request.wooden)) await loadSkin();
    const answer = await answerOf(request);
    send({ kind: "answer", id, answer, ms: performance.now() - begin });
  } catch (error) {
    // After a panic nothing in the module can be trusted: the page starts another worker.
    session = undefined;
    send({ kind: "broken", id, sentence: lastPanic() || String(error) });
  }
}

/** Loads the file of the skin, once; a file that cannot be had is told by the answer to the request. */
async function loadSkin(): Promise<void> {
  if (skin) return;
  const response = await fetch(skinAddress).catch(() => undefined);
  if (!response?.ok) return;
  skin = new Uint8Array(await response.arrayBuffer());
  session?.take_skin(skin);
}

/** Loads the chart library of a report, once. */
async function loadCharts(): Promise<void> {
  if (charts !== undefined) return;
  const response = await fetch(chartsAddress).catch(() => undefined);
  if (!response?.ok) return;
  charts = await response.text();
  session?.take_charts(charts);
}

/** A lock of this worker's name, until it ends: so the page learns of an end of which nothing else tells. */
function lock(): Promise<void> {
  if (!navigator.locks) return Promise.resolve();
  return new Promise((locked) => {
    void navigator.locks.request(self.name, () => {
      locked();
      return new Promise(() => undefined);
    });
  });
}

// Requests are answered one after the other, also where one waits for a file.
let begun: () => void;
let queue = new Promise<void>((resolve) => (begun = resolve));
self.addEventListener("message", ({ data }: MessageEvent<ToWorker>) => {
  queue = queue.then(() => answer(data));
});

void lock().then(() => send({ kind: "here" }));
init({ module_or_path: address }).then(
  ({ memory }) => {
    // For measuring: the memory of the module, bytes.
    Object.assign(self, { memoryBytes: () => memory.buffer.byteLength });
    session = new Session();
    send({ kind: "ready", version: version() });
    begun();
  },
  (error: unknown) => send({ kind: "broken", id: -1, sentence: String(error) }),
);
