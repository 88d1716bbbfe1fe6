// The page's side of the worker: requests, each with its answer. A worker that has failed is replaced by another one.
import type { Answer, FromWorker, Request } from "./messages";

/** The session refused a request, or ended. */
export class Refused extends Error {
  constructor(
    sentence: string,
    readonly broken: boolean,
  ) {
    super(sentence);
  }
}

/** A worker that has said nothing for so long has not begun, ms. */
const SILENT_MS = 60_000;

type Waiting = { resolve: (answer: Answer) => void; reject: (error: Refused) => void; request: Request };

const opens = (request: Request) => request.do === "open" || request.do === "open_model";

export class Solver {
  /** Durations of the calls by kind of request, ms; the last thousand of each. */
  readonly times: Record<string, number[]> = {};
  private worker?: Worker;
  private waiting = new Map<number, Waiting>();
  private next = 0;
  private reason?: string;

  /** `failed`: the session has ended while nothing was asked of it; `sought`: a search has sought so many postures. */
  constructor(
    private readonly failed: () => void,
    private readonly sought: (count: number) => void = () => undefined,
  ) {
    this.worker = this.start();
  }

  /** Why the session is gone. Another one knows nothing: until a scenario is opened, all other requests are refused. */
  get lost(): string | undefined {
    return this.reason;
  }

  ask(request: Request): Promise<Answer> {
    if (this.reason !== undefined && !opens(request)) return Promise.reject(new Refused(this.reason, true));
    const worker = (this.worker ??= this.start());
    const id = this.next++;
    return new Promise((resolve, reject) => {
      this.waiting.set(id, { resolve, reject, request });
      worker.postMessage({ id, request });
    });
  }

  /** Ends the session in the midst of whatever it does. */
  end(sentence: string): void {
    if (this.worker) this.fail(this.worker, sentence);
  }

  private start(): Worker {
    // A lock that the worker has until it ends, in whatever way. There are locks in secure contexts alone.
    const name = `contrapposto-${Math.random()}`;
    const worker = new Worker(new URL("./worker.ts", import.meta.url), { type: "module", name });
    const silent = setTimeout(() => this.fail(worker, "the worker did not begin"), SILENT_MS);
    worker.addEventListener("message", ({ data }: MessageEvent<FromWorker>) => {
      if (worker !== this.worker) return;
      if (data.kind === "answer") this.receive(data);
      else if (data.kind === "broken") this.fail(worker, data.sentence);
      else if (data.kind === "sought") this.sought(data.count);
      else if (data.kind === "here") {
        clearTimeout(silent);
        void navigator.locks?.request(name, () => this.fail(worker, "the worker has ended"));
      }
    });
    worker.addEventListener("error", (event) => this.fail(worker, event.message || "the worker did not start"));
    return worker;
  }

  private receive({ id, answer, ms }: FromWorker & { kind: "answer" }): void {
    const waiting = this.waiting.get(id);
    if (!waiting) return;
    this.waiting.delete(id);
    const times = (this.times[waiting.request.do] ??= []);
    times.push(ms);
    if (times.length > 1000) times.shift();
    if (opens(waiting.request) && answer.is === "scene") this.reason = undefined;
    if (answer.is === "refused") waiting.reject(new Refused(answer.sentence, false));
    else waiting.resolve(answer);
  }

  /** The next request starts another worker. */
  private fail(worker: Worker, sentence: string): void {
    if (worker !== this.worker) return;
    worker.terminate();
    this.worker = undefined;
    this.reason = sentence;
    const waiting = [...this.waiting.values()];
    this.waiting.clear();
    for (const { reject } of waiting) reject(new Refused(sentence, true));
    if (waiting.length === 0) this.failed();
  }
}
