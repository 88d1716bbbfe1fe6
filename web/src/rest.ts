// The different ways to rest: searched for by a session of its own, so that the page goes on, and shown as a row of small pictures.
import { button, make } from "./dom";
import type { Way } from "./messages";
import { byId, type Page } from "./page";
import { Refused, Solver } from "./solver";
import { texts } from "./texts";

export class Rest {
  private readonly find = button(texts.rest.find, "rest", () => void this.search());
  private readonly stop = button(texts.rest.stop, "rest-stop", () => this.end());
  private readonly told = make("p", { id: "rest-told", role: "status" });
  private readonly row = make("ul", { id: "ways" });
  private solver?: Solver;

  constructor(private readonly page: Page) {
    byId("rests").append(make("div", { className: "row" }, this.find, this.stop, this.told), this.row);
    this.searching(false);
  }

  /** The ways of another job are not those of this one. */
  clear(): void {
    this.end();
    this.told.textContent = "";
    this.row.replaceChildren();
  }

  private end(): void {
    this.solver?.end(texts.rest.stopped);
    this.solver = undefined;
    this.searching(false);
  }

  private searching(searching: boolean): void {
    [this.find.disabled, this.stop.hidden] = [searching, !searching];
    this.row.setAttribute("aria-busy", String(searching));
  }

  private async search(): Promise<void> {
    const { page } = this;
    this.clear();
    this.searching(true);
    this.told.textContent = texts.rest.sought(0);
    const solver = new Solver(
      () => undefined,
      (count) => (this.told.textContent = texts.rest.sought(count)),
    );
    this.solver = solver;
    try {
      const { opened, state } = await page.document();
      const asked = [opened, { do: "restore", state }, { do: "relax" }] as const;
      const answers = [];
      for (const request of asked) answers.push(await solver.ask(request));
      const answer = answers.at(-1);
      if (solver === this.solver && answer?.is === "ways") this.show(answer.ways);
    } catch (error) {
      if (!(error instanceof Refused)) throw error;
      if (solver === this.solver || this.solver === undefined) this.told.textContent = error.message;
    } finally {
      solver.end("");
      if (solver === this.solver) this.end();
    }
  }

  private show(ways: Way[]): void {
    this.told.textContent = texts.rest.found(ways.length);
    const item = (way: Way, i: number) => {
      const words = texts.rest.way(i + 1, way.effort, way.on_ligaments);
      const picture = this.page.view?.picture(way.shown);
      const shown = picture === undefined ? [] : [make("img", { src: picture, alt: "", width: 96, height: 144 })];
      const go = button("", `way-${i + 1}`, () => this.page.change({ do: "go", q: way.shown.q }, false));
      go.append(...shown, make("span", { textContent: words }));
      go.title = way.shown.verdict.sentence;
      return make("li", {}, go);
    };
    this.row.replaceChildren(...ways.map(item));
  }
}
