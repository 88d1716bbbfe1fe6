// The page's side of the worker: one request at a time, each with its answer.
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

type Waiting = { resolve: (answer: Answer) => void; reject: (error: Refused) => void };

export class Solver {
  /** Durations of the calls by kind of request, ms; the last thousand of each. */
  readonly times: Record<string, number[]> = {};
  private worker!: Worker;
  private waiting = new Map<number, Waiting & { request: Request }>();
  private next = 0;
  private ready = false;

  constructor(private readonly onReady: (version: string) => void) {
    this.start();
  }

  /** A fresh session in place of one that has ended. */
  start(): void {
    this.worker?.terminate();
    this.worker = new Worker(new URL("./worker.ts", import.meta.url), { type: "module" });
    this.worker.addEventListener("message", (event: MessageEvent<FromWorker>) => this.receive(event.data));
    this.worker.addEventListener("error", (event) => this.fail(event.message || "the worker did not start"));
  }

  ask(request: Request): Promise<Answer> {
    const id = this.next++;
    return new Promise((resolve, reject) => {
      this.waiting.set(id, { resolve, reject, request });
      this.worker.postMessage({ id, request });
    });
  }

  private receive(message: FromWorker): void {
    if (message.kind === "ready") {
      this.ready = true;
      return this.onReady(message.version);
    }
    if (message.kind === "broken") return this.fail(message.sentence);
    const waiting = this.waiting.get(message.id);
    if (!waiting) return;
    this.waiting.delete(message.id);
    const times = (this.times[waiting.request.do] ??= []);
    times.push(message.ms);
    if (times.length > 1000) times.shift();
    if (message.answer.is === "refused") waiting.reject(new Refused(message.answer.sentence, false));
    else waiting.resolve(message.answer);
  }

  private fail(sentence: string): void {
    const waiting = [...this.waiting.values()];
    this.waiting.clear();
    // A module that cannot be loaded is not loaded again and again.
    if (this.ready) this.start();
    this.ready = false;
    for (const { reject } of waiting) reject(new Refused(sentence, true));
  }
}
