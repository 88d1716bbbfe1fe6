// Runs the session beside the page: requests in, answers out, in their order.
import init, { Session, last_panic, version } from "./module/contrapposto_web.js";
import address from "./module/contrapposto_web_bg.wasm?url";
import skinAddress from "./module/adult.skin?url";
import type { Answer, FromWorker, ToWorker } from "./messages";

// The module calls this function while it searches.
Object.assign(self, { tellSought: (count: number) => send({ kind: "sought", count }) });

let session: Session | undefined;

function send(message: FromWorker): void {
  self.postMessage(message);
}

function answer({ id, request }: ToWorker): void {
  const begin = performance.now();
  try {
    if (!session) throw new Error("the session has ended");
    const answer = JSON.parse(session.call(JSON.stringify(request))) as Answer;
    send({ kind: "answer", id, answer, ms: performance.now() - begin });
  } catch (error) {
    // After a panic nothing in the module can be trusted: the page starts another worker.
    session = undefined;
    send({ kind: "broken", id, sentence: last_panic() || String(error) });
  }
}

/** Loads the file of the skin, once; a file that cannot be had is told by the answer to the request. */
async function loadSkin(): Promise<void> {
  const response = await fetch(skinAddress).catch(() => undefined);
  if (response?.ok) session?.take_skin(new Uint8Array(await response.arrayBuffer()));
}

let skin: Promise<void> | undefined;

function receive(asked: ToWorker): void {
  const { request } = asked;
  if (request.do === "skin" || (request.do === "gltf" && !request.wooden)) void (skin ??= loadSkin()).catch(() => undefined).then(() => answer(asked));
  else answer(asked);
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

const waiting: ToWorker[] = [];
self.addEventListener("message", (event: MessageEvent<ToWorker>) => {
  if (session) receive(event.data);
  else waiting.push(event.data);
});

void lock().then(() => send({ kind: "here" }));
init({ module_or_path: address }).then(
  ({ memory }) => {
    // For measuring: the memory of the module, bytes.
    Object.assign(self, { memoryBytes: () => memory.buffer.byteLength });
    session = new Session();
    send({ kind: "ready", version: version() });
    for (const request of waiting.splice(0)) receive(request);
  },
  (error: unknown) => send({ kind: "broken", id: -1, sentence: String(error) }),
);
