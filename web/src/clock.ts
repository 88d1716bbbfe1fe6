// Lets time run, at the speed that is chosen, until something else begins.
import type { Played } from "./messages";
import { frame, type Page } from "./page";
import { duration, texts } from "./texts";
import type { GoesOn } from "./turns";

/** A call that lets time run should take no longer, ms. */
const CALL_MS = 60;
/** Most samples of a call. */
const MOST_SAMPLES = 20_000;
/** Longest time between two pictures that counts, s: a page in the background gets none. */
const LONGEST_FRAME = 0.25;

export class Clock {
  private running = false;
  /** Simulated time before the present run, and in it, s. */
  private before = 0;
  private time = 0;
  /** The moment of the run that is to be looked at, s, as long as it is not shown. */
  private wanted?: number;
  private looking = false;

  constructor(private readonly page: Page) {
    page.watching = {
      scene: () => this.ended(),
      played: (played) => this.played(played),
      turn: () => this.show(false),
    };
  }

  /** Starts the clock, or stops it; the run can go on. */
  toggle(): void {
    if (this.running) return this.page.turns.end();
    void this.page.turn((goesOn) => this.run(goesOn));
    this.show(true);
  }

  /** Ends the run; `take`: the body stays as it has come to. */
  end(take: boolean): void {
    void this.page.turn(async () => {
      if (!this.page.inRun) return;
      const passed = take ? this.before + this.time : 0;
      await this.page.stop(take);
      this.before = passed;
      this.page.tell("");
    });
  }

  /** Shows the run as it was at a moment, s; without one as it is now. Time stops. */
  look(moment: number | undefined): void {
    const waits = this.wanted !== undefined;
    this.wanted = moment ?? this.time;
    if (waits) return;
    void this.page.turn(async () => {
      const { page, wanted: time } = this;
      this.wanted = undefined;
      if (!page.inRun || time === undefined) return;
      this.looking = time < this.time;
      page.tell(this.looking ? texts.looked(duration(this.before + time)) : "");
      await page.ask({ do: "look", time });
    });
  }

  /** Another strategy of a region, or of the whole body; of a run, from now on, with muscles as tired as they are. */
  setStrategy(kind: string, region: string | undefined): void {
    const went = this.running;
    void this.page.turn(async (goesOn) => {
      const passed = this.page.inRun ? this.before + this.time : 0;
      await this.page.leaveRun();
      await this.page.ask({ do: "strategy", kind, region });
      this.before = passed;
      if (!went || !goesOn()) return;
      this.show(true);
      await this.run(goesOn);
    });
  }

  /** Lets time run as long as the turn goes on. */
  private async run(goesOn: GoesOn): Promise<void> {
    if (!goesOn()) return;
    try {
      const ended = await this.runOn(goesOn);
      if (ended !== null) this.page.tell(texts.ended[ended] ?? ended);
    } finally {
      if (goesOn()) this.show(false);
    }
  }

  private async runOn(goesOn: GoesOn): Promise<string | null> {
    const { page } = this;
    this.looking = false;
    page.tell(page.inRun ? "" : texts.preparing);
    const first = await page.ask({ do: "play", samples: 2 });
    if (first.is !== "played") return null;
    page.tell("");
    let step = first.time / Math.max(1, first.samples - 1) || 1 / 30;
    let [due, most, last, ended] = [0, 200, performance.now(), first.ended];
    while (goesOn() && ended === null) {
      await frame();
      if (!goesOn()) break;
      const now = performance.now();
      due += (page.panel.speed * Math.min(LONGEST_FRAME, (now - last) / 1000)) / step;
      last = now;
      if (due < 1) continue;
      const samples = Math.min(Math.floor(due), Math.floor(most));
      due = Math.min(due - samples, most);
      const answer = await page.ask({ do: "play", samples });
      if (answer.is !== "played") break;
      most = Math.max(1, Math.min(MOST_SAMPLES, (samples * CALL_MS) / Math.max(1, performance.now() - now)));
      ended = answer.ended;
      step = answer.time / Math.max(1, answer.samples - 1) || step;
    }
    return ended;
  }

  private played(played: Played): void {
    if (!this.looking) this.time = played.time;
    this.page.panel.played(played, this.before, this.time);
  }

  private ended(): void {
    this.before = this.time = 0;
    this.looking = false;
    this.page.panel.ended();
    this.page.panel.running(this.running);
  }

  private show(running: boolean): void {
    this.running = running;
    this.page.panel.running(running);
  }
}
