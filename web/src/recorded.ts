// A recorded motion: its moments by a slider, each held still on the supports of the job.
import { button, make } from "./dom";
import type { Course } from "./messages";
import { byId, frame, type Page } from "./page";
import { duration, texts } from "./texts";

export class Recorded {
  private course?: Course;
  private readonly slider = make("input", { type: "range", id: "moment", min: "0", step: "any", ariaLabel: texts.recorded.moment });
  private readonly time = make("output");
  private readonly playing = button(texts.play, "moment-play", () => this.play());
  private readonly box: HTMLElement;
  private wanted?: number;

  constructor(private readonly page: Page) {
    this.slider.addEventListener("input", () => this.look(Number(this.slider.value)));
    this.box = make(
      "div",
      { id: "recorded", hidden: true },
      make("label", { className: "slider" }, make("span", { textContent: texts.recorded.moment }), this.slider, this.time),
      make(
        "div",
        { className: "row" },
        this.playing,
        button(texts.keep, "moment-keep", () => this.keep()),
        button(texts.recorded.close, "moment-close", () => this.close()),
      ),
      make("p", { className: "quiet", textContent: texts.recorded.about }),
    );
    byId("rests").before(this.box);
  }

  /** Opens the motion of a file, on the body that is there. */
  async open(name: string, text: string): Promise<void> {
    await this.page.turn(async () => {
      await this.page.leaveRun();
      const answer = await this.page.ask({ do: "motion", name, text });
      if (answer.is !== "motion") return;
      this.course = answer.course;
      this.slider.max = String(answer.course.times.length - 1);
      this.box.hidden = false;
      this.page.tell(answer.notes.length ? `${answer.notes.join(". ")}.` : texts.recorded.opened(name, answer.course.times.length));
      await this.show(0);
    });
  }

  /** Another body or job has no part in the motion. */
  forget(): void {
    this.course = undefined;
    this.box.hidden = true;
  }

  private close(): void {
    this.forget();
    void this.page.turn(async () => {
      this.page.tell("");
      // The posture of the job again.
      await this.page.ask({ do: "at", q: [] });
    });
  }

  private keep(): void {
    const q = this.course?.postures[this.row];
    if (!q) return;
    this.forget();
    this.page.change({ do: "go", q }, false);
  }

  private get row(): number {
    return Math.round(Number(this.slider.value));
  }

  /** The moment that is wanted last is shown. */
  private look(row: number): void {
    const waits = this.wanted !== undefined;
    this.wanted = row;
    if (waits) return;
    void this.page.turn(async () => {
      const wanted = this.wanted;
      this.wanted = undefined;
      if (wanted !== undefined) await this.show(Math.round(wanted));
    });
  }

  private play(): void {
    if (this.playing.getAttribute("aria-pressed") === "true") return this.page.turns.end();
    void this.page.turn(async (goesOn) => {
      this.running(true);
      try {
        const times = this.course?.times ?? [];
        const from = this.row < times.length - 1 ? this.row : 0;
        const begin = performance.now();
        for (let row = from; row < times.length && goesOn(); ) {
          await this.show(row);
          await frame();
          if (row === times.length - 1) break;
          const now = times[from] + (performance.now() - begin) / 1000;
          row = Math.max(row + 1, times.findLastIndex((time) => time <= now));
        }
      } finally {
        this.running(false);
      }
    });
  }

  private running(running: boolean): void {
    this.playing.textContent = running ? texts.pause : texts.play;
    this.playing.setAttribute("aria-pressed", String(running));
  }

  private async show(row: number): Promise<void> {
    const { course, page } = this;
    const q = course?.postures[row];
    if (!course || !q) return;
    this.slider.value = String(row);
    this.time.textContent = this.slider.ariaValueText = duration(course.times[row]);
    await page.ask({ do: "at", q });
  }
}
