// The studio: a session in a worker, the picture and the controls, and what is done between them.
import { Refused, Solver } from "./solver";
import { duration, texts } from "./texts";
import { Panel } from "./panel";
import { View } from "./view";
import { bands } from "./colours";
import { make } from "./dom";
import { decoded, encoded, scenarioPart } from "./link";
import type { Answer, Handle, Played, Request, Scene, Shown, Vector } from "./messages";

/** Largest file that is read, bytes. */
const MOST_BYTES = 16 << 20;
/** Longest settling after a change, steps. */
const SETTLE_STEPS = 200;
/** Time of the steps between two pictures, ms. */
const STEPS_MS = 12;
/** Steps of a drag by a button, each of one frame at most. */
const NUDGE_STEPS = 12;
/** A call that lets time run should take no longer, ms. */
const CALL_MS = 60;

const byId = <T extends HTMLElement>(id: string) => document.getElementById(id) as T;
const verdictLine = byId("verdict");
const notice = byId("notice");
const result = byId("result");
const frame = () => new Promise<void>((resolve) => requestAnimationFrame(() => resolve()));

class Studio {
  private readonly solver = new Solver(() => document.documentElement.setAttribute("data-ready", ""));
  private readonly panel: Panel;
  private readonly view?: View;
  private scene?: Scene;
  private shown?: Shown;
  private grabbing?: Promise<unknown>;
  private target?: Vector;
  private dragged = false;
  /** Rises with everything that ends a settling body. */
  private settling = 0;
  private running = false;
  private inRun = false;
  /** Simulated time before the present run, s. */
  private before = 0;
  private lastTime = 0;
  /** The last scenario that was opened, for a session that begins anew. */
  private opened: Request = { do: "open", scenario: "" };
  private chartDue = false;

  constructor() {
    this.panel = new Panel(byId("panel"), {
      adult: (sex, stature, mass) => this.change({ do: "adult", sex, stature, mass }),
      nudge: (handle, way) => void this.guard(() => this.nudge(handle, way)),
      free: (segment) => this.change({ do: "free", segment }),
      load: (segment, mass) => this.change({ do: "load", segment, mass }),
      strategy: (kind) => void this.guard(() => this.setStrategy(kind)),
      play: () => void this.guard(() => this.play()),
      endPlay: (take) => void this.guard(() => this.endPlay(take)),
      joint: () => this.chart(true),
      undo: () => this.change({ do: "undo" }, false),
      redo: () => this.change({ do: "redo" }, false),
      reset: () => this.change({ do: "reset" }),
      openFiles: (files) => void this.guard(() => this.openFiles(files)),
      save: () => void this.guard(() => this.save()),
      link: () => void this.guard(() => this.link()),
    });
    byId("hint").textContent = texts.hint;
    verdictLine.textContent = texts.loading;
    byId("scale").append(make("span", { textContent: texts.loadScale }));
    for (const { from, low, high } of bands) {
      const swatch = make("i");
      swatch.style.background = `linear-gradient(to right, ${low}, ${high})`;
      byId("scale").append(`${Math.round(100 * from)} %`, swatch);
    }
    this.view = this.makeView();
    this.listen();
    const part = scenarioPart(location.hash);
    void this.guard(() => this.openLink(part));
  }

  private makeView(): View | undefined {
    const canvas = byId<HTMLCanvasElement>("canvas");
    try {
      return new View(canvas, {
        grab: (segment, point) => {
          this.target = undefined;
          const before = this.grabbing;
          this.grabbing = this.guard(() => this.dragAlong(segment, point, before)).finally(() => (this.dragged = false));
          this.dragged = true;
        },
        drag: (target) => this.dragged && (this.target = target),
        release: () => void this.release(),
      });
    } catch {
      this.tell(texts.noWebgl);
      return undefined;
    }
  }

  private listen(): void {
    addEventListener("dragover", (event) => event.preventDefault());
    addEventListener("drop", (event) => {
      event.preventDefault();
      void this.guard(() => this.openFiles([...(event.dataTransfer?.files ?? [])]));
    });
    addEventListener("hashchange", () => {
      const part = scenarioPart(location.hash);
      if (part) void this.guard(() => this.openLink(part));
    });
    byId("canvas").addEventListener("keydown", (event) => {
      if (!event.ctrlKey && !event.altKey && !event.metaKey && this.panel.key(event.key)) event.preventDefault();
    });
    addEventListener("keydown", (event) => {
      if (!(event.ctrlKey || event.metaKey) || event.key.toLowerCase() !== "z") return;
      event.preventDefault();
      this.change({ do: event.shiftKey ? "redo" : "undo" }, false);
    });
  }

  private tell(sentence: string): void {
    notice.textContent = sentence;
    notice.hidden = sentence === "";
  }

  /** Carries out something; a refusal is told, and a session that has ended begins anew with the last scenario. */
  private async guard(job: () => Promise<unknown>): Promise<void> {
    try {
      await job();
    } catch (error) {
      this.running = false;
      this.panel.running(false);
      if (!(error instanceof Refused)) throw error;
      this.tell(error.broken ? `${texts.broken} (${error.message})` : error.message);
      if (error.broken && this.scene) {
        this.endedRun();
        this.take(await this.solver.ask(this.opened));
      }
    }
  }

  private async ask(request: Request): Promise<Answer> {
    const answer = await this.solver.ask(request);
    this.take(answer);
    return answer;
  }

  private take(answer: Answer): void {
    if (answer.is === "scene") {
      this.scene = answer;
      this.endedRun();
      document.title = `${answer.title || "contrapposto studio"}`;
      this.view?.open(answer);
      this.panel.open(answer);
      this.show(answer.shown);
      this.chart(true);
    } else if (answer.is === "shown") {
      this.show(answer);
    } else if (answer.is === "played") {
      this.show(answer.shown, answer);
      this.panel.played(answer, this.before);
    }
  }

  private show(shown: Shown, played?: Played): void {
    if (!this.scene) return;
    this.shown = shown;
    this.view?.show(shown, this.scene.held);
    this.panel.show(shown);
    if (verdictLine.textContent !== shown.verdict.sentence) verdictLine.textContent = shown.verdict.sentence;
    const { q, external, active, verdict } = shown;
    const names = this.scene.coordinates.map(({ name }) => name);
    result.textContent = JSON.stringify({ names, q, external, active, verdict, time: played?.time ?? null, asking: played?.asking ?? [] });
    this.chart(false);
  }

  /** Draws the torques of the chosen joint; while a body moves, when the last drawing is there. */
  private chart(anew: boolean): void {
    if (this.chartDue || !this.scene || this.inRun || (this.target && !anew)) return;
    const coordinate = this.panel.jointName;
    if (!coordinate) return;
    this.chartDue = true;
    void this.guard(async () => {
      try {
        const answer = await this.solver.ask({ do: "balance", coordinate });
        if (answer.is === "balance" && this.shown) this.panel.drawChart(answer, this.shown);
      } finally {
        this.chartDue = false;
      }
      if (this.shown) this.panel.show(this.shown);
    });
  }

  /** Ends what moves the body: a body that settles, a drag, the clock. What follows belongs to the number that is given. */
  private async halt(): Promise<number> {
    const own = ++this.settling;
    await this.pause();
    await this.grabbing;
    return own;
  }

  /** A change of the scenario; then the body settles, but for undo and redo, which show a posture again. */
  private change(request: Request, settles = true): void {
    void this.guard(async () => {
      this.tell("");
      const own = await this.halt();
      if (this.inRun) await this.ask({ do: "stop", take: true });
      await this.ask(request);
      if (settles) await this.settle(own);
    });
  }

  /** The body moves toward least effort, some steps a picture, until something else begins. */
  private async settle(own: number): Promise<void> {
    let last = performance.now();
    for (let step = 0; step < SETTLE_STEPS && own === this.settling; step++) {
      const answer = await this.ask({ do: "settle" });
      if (answer.is !== "shown" || answer.settled) break;
      if (performance.now() - last < STEPS_MS) continue;
      await frame();
      last = performance.now();
    }
  }

  /** Drags the point that was grabbed, as long as it is. */
  private async dragAlong(segment: string, point: Vector, before?: Promise<unknown>): Promise<void> {
    this.tell("");
    const own = ++this.settling;
    await this.pause();
    await before;
    if (this.inRun) await this.ask({ do: "stop", take: true });
    let hold = this.scene?.held.some((held) => held.segment === segment) ?? false;
    await this.ask({ do: "grab", segment, point });
    try {
      while (own === this.settling) {
        if (this.target) await this.ask({ do: "drag", target: this.target });
        hold ||= this.target !== undefined;
        await frame();
      }
    } finally {
      this.target = undefined;
      await this.ask({ do: "release", hold });
    }
  }

  private async release(): Promise<void> {
    // A press without a motion, or of a part that cannot be dragged, ends here, too.
    const own = ++this.settling;
    await this.grabbing;
    if (!this.inRun && own === this.settling) await this.guard(() => this.settle(own));
  }

  private async nudge(handle: Handle, way: Vector): Promise<void> {
    if (!this.scene || !this.shown) return;
    this.tell("");
    const own = await this.halt();
    const nudging = this.step(handle, way);
    this.grabbing = nudging.catch(() => undefined);
    await nudging;
    await this.settle(own);
  }

  /** Moves a part by one press of a button; the part is let go in any case. */
  private async step(handle: Handle, way: Vector): Promise<void> {
    if (this.inRun) await this.ask({ do: "stop", take: true });
    await this.ask({ do: "grab", segment: handle.segment, point: handle.point });
    try {
      const target = this.placeOf(handle).map((x, k) => x + way[k]) as Vector;
      for (let step = 0; step < NUDGE_STEPS; step++) {
        const answer = await this.ask({ do: "drag", target });
        if (answer.is === "shown" && (answer.miss ?? 0) < 1e-4) break;
      }
    } finally {
      await this.ask({ do: "release", hold: true });
    }
  }

  /** Where a point of a segment is in ground. */
  private placeOf({ segment, point }: Handle): Vector {
    const [x, y, z, i, j, k, w] = this.shown!.places[this.scene!.segments.findIndex(({ name }) => name === segment)];
    const [a, b, c] = point;
    const u: Vector = [j * c - k * b + w * a, k * a - i * c + w * b, i * b - j * a + w * c];
    return [x + a + 2 * (j * u[2] - k * u[1]), y + b + 2 * (k * u[0] - i * u[2]), z + c + 2 * (i * u[1] - j * u[0])];
  }

  private async play(): Promise<void> {
    if (this.running) return this.pause();
    const own = ++this.settling;
    // Nothing else has begun, and the clock runs.
    const goesOn = () => this.running && own === this.settling;
    await this.grabbing;
    if (own !== this.settling) return;
    this.tell(this.inRun ? "" : texts.preparing);
    this.running = true;
    this.panel.running(true);
    const first = await this.ask({ do: "play", samples: 2 });
    if (first.is !== "played") return;
    this.inRun = true;
    this.lastTime = first.time;
    if (own !== this.settling) return;
    this.tell("");
    let step = first.time / Math.max(1, first.samples - 1) || 1 / 30;
    let [due, most, last, ended] = [0, 200, performance.now(), first.ended];
    while (goesOn() && ended === null) {
      await frame();
      if (!goesOn()) return;
      const now = performance.now();
      due += (this.panel.speed * Math.min(0.25, (now - last) / 1000)) / step;
      last = now;
      if (due < 1) continue;
      const samples = Math.min(Math.floor(due), Math.floor(most));
      due = Math.min(due - samples, most);
      const answer = await this.ask({ do: "play", samples });
      if (answer.is !== "played") break;
      most = Math.max(1, Math.min(20000, (samples * CALL_MS) / Math.max(1, performance.now() - now)));
      [ended, this.lastTime] = [answer.ended, answer.time];
      step = answer.time / Math.max(1, answer.samples - 1) || step;
    }
    if (own !== this.settling) return;
    this.running = false;
    this.panel.running(false);
    if (ended !== null) this.tell(texts.ended[ended] ?? ended);
  }

  /** Stops the clock; the run can go on. */
  private async pause(): Promise<void> {
    this.running = false;
    this.panel.running(false);
  }

  private async endPlay(take: boolean): Promise<void> {
    this.settling++;
    await this.pause();
    if (!this.inRun) return;
    const passed = take ? this.before + this.lastTime : 0;
    await this.ask({ do: "stop", take });
    this.before = passed;
  }

  private endedRun(): void {
    this.inRun = this.running = false;
    this.before = this.lastTime = 0;
    this.panel.ended();
  }

  /** Another strategy; of a run, from now on, with muscles as tired as they are. */
  private async setStrategy(kind: string): Promise<void> {
    const [went, passed] = [this.running, this.inRun ? this.before + this.lastTime : 0];
    const inRun = this.inRun;
    await this.halt();
    if (inRun) await this.ask({ do: "stop", take: true });
    await this.ask({ do: "strategy", kind });
    this.before = passed;
    if (went) await this.play();
  }

  private async openLink(part: string | undefined): Promise<void> {
    const text = part === undefined ? "" : decoded(part);
    if (text === undefined) this.tell(texts.badLink);
    try {
      await this.openScenario(text ?? "", {});
    } catch (error) {
      if (!this.scene && error instanceof Refused && !error.broken) await this.openScenario("", {});
      throw error;
    }
  }

  private async openScenario(scenario: string, files: Record<string, string>): Promise<void> {
    const own = await this.halt();
    const request: Request = { do: "open", scenario, files };
    await this.ask(request);
    this.opened = request;
    await this.settle(own);
  }

  /** Opens a scenario with the files that it names, or a model. */
  private async openFiles(files: File[]): Promise<void> {
    this.tell("");
    const large = files.find((file) => file.size > MOST_BYTES);
    if (large) return this.tell(texts.tooLarge(large.name, `${MOST_BYTES >> 20} MB`));
    const read = new Map<string, string>();
    for (const file of files) read.set(file.name, await file.text());
    const scenario = files.find(({ name }) => name.toLowerCase().endsWith(".toml"));
    const model = files.find(({ name }) => /\.(osim|urdf|xml|mjcf)$/i.test(name));
    if (scenario) {
      await this.openScenario(read.get(scenario.name)!, Object.fromEntries(read));
    } else if (model) {
      await this.halt();
      const request: Request = { do: "open_model", name: model.name, text: read.get(model.name)! };
      await this.ask(request);
      this.opened = request;
    } else {
      this.tell(texts.noFile);
    }
  }

  private async exported(): Promise<string> {
    const answer = await this.ask({ do: "export" });
    return answer.is === "text" ? answer.text : "";
  }

  private async save(): Promise<void> {
    const name = "studio.toml";
    const url = URL.createObjectURL(new Blob([await this.exported()], { type: "application/toml" }));
    const link = Object.assign(document.createElement("a"), { href: url, download: name });
    link.click();
    setTimeout(() => URL.revokeObjectURL(url), 10_000);
    this.tell(texts.saved(name));
  }

  private async link(): Promise<void> {
    const link = `${location.origin}${location.pathname}#scenario=${encoded(await this.exported())}`;
    history.replaceState(null, "", link);
    try {
      await navigator.clipboard.writeText(link);
      this.tell(texts.copied);
    } catch {
      this.tell(texts.linkIs(link));
    }
  }

  /** For tests and for measuring: where a point is on the canvas, and how long calls took, ms. */
  readonly probe = {
    onCanvas: (label: string) => {
      const handle = this.scene?.handles.find((handle) => handle.label === label);
      return handle && this.view?.onCanvas(this.placeOf(handle));
    },
    times: () => this.solver.times,
    ask: (request: Request) => this.ask(request),
  };
}

const studio = new Studio();
Object.assign(window, { studio: studio.probe, duration });

if ("serviceWorker" in navigator && import.meta.env.PROD) {
  void navigator.serviceWorker.register("./service-worker.js").then(async () => {
    const ready = await navigator.serviceWorker.ready;
    const loaded = performance.getEntriesByType("resource").map(({ name }) => name);
    ready.active?.postMessage([location.href.split("#")[0], ...loaded.filter((url) => url.startsWith(location.origin))]);
  });
}
