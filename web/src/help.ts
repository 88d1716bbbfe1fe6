// Help of one screen, and a tour of six steps that points at the controls.
import { button, make } from "./dom";
import licence from "./module/skin-license.txt?url";
import { byId } from "./page";
import { texts } from "./texts";

export class Help {
  private readonly dialog: HTMLDialogElement;
  private readonly tip: HTMLElement;
  private readonly words = make("p", {});
  private step = -1;

  constructor() {
    const open = button(texts.help.open, "help", () => this.dialog.showModal());
    this.dialog = make(
      "dialog",
      { id: "help-text", ariaLabel: texts.help.title },
      make("h2", { textContent: texts.help.title }),
      ...texts.help.lines.map((textContent) => make("p", { textContent })),
      make("p", { className: "quiet" }, `${texts.help.skin}: `, make("a", { href: licence, textContent: texts.help.licence })),
      make(
        "div",
        { className: "row" },
        button(texts.help.tour, "tour", () => this.begin()),
        button(texts.help.close, "help-close", () => this.dialog.close()),
      ),
    );
    this.tip = make(
      "div",
      { id: "tip", hidden: true },
      this.words,
      make(
        "div",
        { className: "row" },
        button(texts.tour.next, "tour-next", () => this.show(this.step + 1)),
        button(texts.help.close, "tour-close", () => this.show(-1)),
      ),
    );
    this.tip.setAttribute("role", "status");
    byId("jumps").append(open);
    document.body.append(this.dialog, this.tip);
    addEventListener("keydown", (event) => {
      if (event.key === "Escape" && this.step >= 0) this.show(-1);
    });
  }

  private begin(): void {
    this.dialog.close();
    this.show(0);
  }

  /** One step: its control is marked and in sight, its words are read. */
  private show(step: number): void {
    document.querySelector(".pointed")?.classList.remove("pointed");
    const [id, words] = texts.tour.steps[step] ?? [];
    this.step = id === undefined ? -1 : step;
    this.tip.hidden = id === undefined;
    if (id === undefined || words === undefined) return byId("help").focus();
    this.words.textContent = words;
    byId(id).classList.add("pointed");
    byId(id).scrollIntoView({ block: "nearest" });
    byId("tour-next").focus({ preventScroll: true });
  }
}
