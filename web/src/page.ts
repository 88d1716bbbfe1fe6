// What is shown and told: the body, requests to the session and their answers, and the session that follows one that has failed.
import { make } from "./dom";
import { bands } from "./colours";
import type { Answer, Played, Request, Scene, Shown, Vector } from "./messages";
import { forget, keep, type Kept } from "./kept";
import { carried, type Panel } from "./panel";
import type { Recorded } from "./recorded";
import type { Rest } from "./rest";
import { Refused, Solver } from "./solver";
import { texts } from "./texts";
import { Turns, type GoesOn } from "./turns";
import type { View } from "./view";

/** Longest settling after a change, steps. */
const SETTLE_STEPS = 200;
/** Least time of the steps between two pictures, ms. */
const STEPS_MS = 12;
/** A session that fails sooner after the one before it does not get the same state again, ms. */
const SOON_MS = 10_000;
/** A place is reached at less, and a step that comes nearer by less brings nothing, m. */
const REACHED = 1e-4;
/** The scenario of a new page. */
const FIRST: Request = { do: "open", scenario: "" };

export const byId = <T extends HTMLElement>(id: string) => document.getElementById(id) as T;
export const frame = () => new Promise<void>((resolve) => requestAnimationFrame(() => resolve()));

/** What follows from an answer, or from the end of a turn. */
export interface Watching {
  scene(): void;
  played(played: Played): void;
  turn(): void;
}

export class Page {
  /** A session that ends by itself is followed by another one with the next request: this one. */
  readonly solver = new Solver(() => void this.turn(() => this.solver.ask({ do: "state" })));
  readonly turns = new Turns(
    () => this.watching?.turn(),
    (busy) => {
      byId("stage").setAttribute("aria-busy", String(busy));
      if (!busy) this.describe();
    },
  );
  panel!: Panel;
  view?: View;
  rest?: Rest;
  recorded?: Recorded;
  watching?: Watching;
  scene?: Scene;
  shown?: Shown;
  /** The session has a run under way, whether its clock goes or not. */
  inRun = false;
  /** A point of the body is being dragged. */
  dragging = false;
  /** The last scenario that was opened, and the state of the document that was made of it since. */
  private opened = FIRST;
  private state?: string;
  private changed = false;
  private reopening?: Promise<string>;
  /** When a session followed another, and how many attempts it took, ms. */
  private reopenedAt = -Infinity;
  private attempts = 0;
  private chartDue = false;
  private unseen?: Answer;

  constructor() {
    byId("hint").textContent = texts.hint;
    byId("canvas").ariaLabel = texts.picture;
    byId("verdict").textContent = texts.loading;
    byId("scale").append(make("span", { textContent: texts.loadScale }));
    for (const { from, low, high } of bands) {
      const swatch = make("i");
      swatch.style.background = `linear-gradient(to right, ${low}, ${high})`;
      byId("scale").append(`${Math.round(100 * from)} %`, swatch);
    }
  }

  tell(sentence: string): void {
    byId("notice").textContent = sentence;
    byId("notice").hidden = sentence === "";
  }

  /** Carries out something; a refusal is told, and a session that has failed is followed by another one. */
  async guard(job: () => Promise<unknown>): Promise<void> {
    try {
      await job();
    } catch (error) {
      if (!(error instanceof Refused)) throw error;
      if (error.broken) this.tell(await this.reopen(error.message));
      else this.tell(error.message);
      this.panel.restore();
    }
  }

  /** The scenario that was opened, and what has become of it; a run ends. */
  async document(): Promise<{ opened: Request; state: string }> {
    let state = "";
    await this.turns.begin(async () => {
      await this.leaveRun();
      const answer = await this.solver.ask({ do: "state" });
      if (answer.is === "text") state = answer.text;
    });
    return { opened: this.opened, state };
  }

  /** Something that moves the body, after everything before it. */
  turn(job: (goesOn: GoesOn) => Promise<unknown>): Promise<void> {
    return this.turns.begin((goesOn) =>
      this.guard(async () => {
        await job(goesOn);
        await this.remember();
      }),
    );
  }

  async ask(request: Request): Promise<Answer> {
    const answer = await this.solver.ask(request);
    this.take(answer);
    return answer;
  }

  /** A change of the scenario; then the body settles, but for undo and redo, which show a posture again. */
  change(request: Request, settles = true): void {
    void this.turn(async (goesOn) => {
      this.tell("");
      // A run ends with a reset: nothing of it is left.
      if (request.do !== "reset") await this.leaveRun();
      else this.rest?.clear();
      await this.ask(request);
      if (settles) await this.settle(goesOn);
    });
  }

  /** The body moves toward least effort, some steps a picture: as long as a picture takes, where that is longer. Something else that begins waits for
   * the rest of the steps, which then are not shown: so where the body comes to does not depend on the time at which that begins. */
  async settle(goesOn: GoesOn): Promise<void> {
    let [begin, time] = [performance.now(), STEPS_MS];
    for (let step = 1; step <= SETTLE_STEPS; step++) {
      const answer = await this.solver.ask({ do: "settle" });
      const last = answer.is !== "shown" || answer.settled || step === SETTLE_STEPS;
      if (!last && (!goesOn() || performance.now() - begin < time)) continue;
      this.take(answer);
      if (last) break;
      const taken = performance.now();
      await frame();
      begin = performance.now();
      time = Math.max(STEPS_MS, begin - taken);
    }
  }

  /** Steps of the point that is grabbed toward a place: `most`, fewer where it is there, or where the last `patience` brought it no nearer. */
  async toward(target: Vector, most: number, patience: number): Promise<void> {
    let [nearest, idle] = [Infinity, 0];
    for (let step = 0; step < most && idle < patience; step++) {
      const answer = await this.solver.ask({ do: "drag", target });
      if (answer.is !== "shown") return;
      this.unseen = answer;
      const miss = answer.miss ?? 0;
      if (miss < REACHED) return;
      idle = nearest - miss < REACHED ? idle + 1 : 0;
      nearest = Math.min(nearest, miss);
    }
  }

  /** Shows where the last steps have brought the body. */
  showLast(): void {
    if (this.unseen) this.take(this.unseen);
    this.unseen = undefined;
  }

  /** Opens a scenario or a model in place of the present one. */
  async open(request: Request): Promise<void> {
    await this.ask(request);
    this.rest?.clear();
    this.recorded?.forget();
    this.opened = request;
    this.state = undefined;
  }

  /** Ends a run; the body stays as it has come to. */
  async leaveRun(): Promise<void> {
    if (this.inRun) await this.stop(true);
  }

  async stop(take: boolean): Promise<void> {
    try {
      await this.ask({ do: "stop", take });
    } catch (error) {
      if (take && error instanceof Refused && !error.broken) throw new Refused(texts.cannotKeep(error.message), false);
      throw error;
    }
  }

  /** Draws the torques of the chosen joint; while a body moves, when the last drawing is there. */
  chart(anew: boolean): void {
    const coordinate = this.panel.jointName;
    if (this.chartDue || !this.scene || this.inRun || (this.dragging && !anew) || !coordinate) return;
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

  /** Fits the skin to a body that may have one, unless it stays wooden. */
  dress(): void {
    if (!this.scene || !this.view || this.view.dressed || this.view.wooden || this.scene.shown.bones.length === 0) return;
    const body = this.view.bodyShown;
    void this.guard(async () => {
      const answer = await this.solver.ask({ do: "skin" });
      if (answer.is === "skin" && answer.skin && body === this.view?.bodyShown) this.view.dress(answer.skin);
    });
  }

  private take(answer: Answer): void {
    if (answer.is === "scene") {
      this.scene = answer;
      this.unseen = undefined;
      this.inRun = false;
      this.watching?.scene();
      document.title = `${answer.title || "contrapposto studio"}`;
      this.view?.open(answer);
      this.panel.open(answer);
      this.show(answer.shown);
      this.dress();
      this.chart(true);
    } else if (answer.is === "shown") {
      this.show(answer);
    } else if (answer.is === "played") {
      this.inRun = true;
      this.show(answer.shown, answer);
      this.view?.putDown(answer.put_down);
      this.watching?.played(answer);
    }
  }

  private show(shown: Shown, played?: Played): void {
    if (!this.scene) return;
    this.shown = shown;
    this.changed ||= !played;
    this.view?.show(shown, this.scene.held);
    this.panel.show(shown);
    const verdictLine = byId("verdict");
    if (verdictLine.textContent !== shown.verdict.sentence) verdictLine.textContent = shown.verdict.sentence;
    const lines = shown.verdict.lines ?? [];
    if (byId("lines").dataset.shown !== lines.join("\n")) {
      byId("lines").dataset.shown = lines.join("\n");
      byId("lines").replaceChildren(...lines.map((textContent) => make("li", { textContent })));
    }
    const { q, external, active, verdict } = shown;
    const names = this.scene.coordinates.map(({ name }) => name);
    byId("result").textContent = JSON.stringify({ names, q, external, active, verdict, time: played?.time ?? null, asking: played?.asking ?? [] });
    this.chart(false);
  }

  /** Tells in words what is shown, once nothing moves: the verdict, who works hardest, and what carries the weight. */
  describe(): void {
    const { scene, shown } = this;
    if (!scene || !shown) return;
    const loads = scene.coordinates.map(({ groups }, i) => ({ group: groups?.[shown.active[i] >= 0 ? 0 : 1], share: Math.round(100 * shown.load[i]) }));
    const working = loads.filter(({ group, share }) => group && share > 0).sort((a, b) => b.share - a.share);
    const highest = working.slice(0, 3).map(({ group, share }) => texts.highest(group!, share));
    const words = `${shown.verdict.sentence} ${texts.described(highest, carried(scene, shown))}`;
    if (byId("described").textContent !== words) byId("described").textContent = words;
  }

  /** Keeps the document as it is, for a session that follows this one. */
  private async remember(): Promise<void> {
    if (!this.changed || this.inRun) return;
    this.changed = false;
    const answer = await this.solver.ask({ do: "state" });
    if (answer.is !== "text") return;
    this.state = answer.text;
    keep({ opened: this.opened, state: this.state });
  }

  /** Shows what was kept before a reload of the page; where that cannot be opened any more, it is forgotten. */
  restore(kept: Kept, otherwise: () => void): void {
    void this.turn(async () => {
      try {
        await this.open(kept.opened);
        await this.ask({ do: "restore", state: kept.state });
        this.tell(texts.restored);
      } catch (error) {
        if (!(error instanceof Refused) || error.broken) throw error;
        forget();
        otherwise();
      }
    });
  }

  /** Opens in another session what was there in the one that has failed; gives the sentence about it. */
  private reopen(why: string): Promise<string> {
    if (!this.reopening && this.solver.lost === undefined) return Promise.resolve(byId("notice").textContent);
    this.reopening ??= this.reopened(why).finally(() => (this.reopening = undefined));
    return this.reopening;
  }

  private async reopened(why: string): Promise<string> {
    const { opened, state } = this;
    const attempts: [Request[], string][] = [
      [[opened], texts.broken(why, texts.asOpened)],
      [[FIRST], texts.broken(why, texts.asFirst)],
    ];
    if (state !== undefined) attempts.unshift([[opened, { do: "restore", state }], texts.broken(why, texts.asBefore)]);
    const soon = performance.now() - this.reopenedAt < SOON_MS;
    for (this.attempts = soon ? this.attempts : 0; this.attempts < attempts.length; ) {
      const [requests, sentence] = attempts[this.attempts++];
      try {
        for (const request of requests) this.take(await this.solver.ask(request));
        this.reopenedAt = performance.now();
        return sentence;
      } catch (error) {
        if (!(error instanceof Refused)) throw error;
      }
    }
    return texts.noSession(why);
  }
}
