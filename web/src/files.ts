// Opens scenarios and models, from links and from files, and gives the scenario out.
import { make } from "./dom";
import { decoded, encoded } from "./link";
import type { Page } from "./page";
import { Refused } from "./solver";
import { texts } from "./texts";
import type { GoesOn } from "./turns";

/** Largest file that is read, bytes. */
const MOST_BYTES = 16 << 20;
/** Name of a file that is saved. */
const NAME = "studio.toml";

export class Files {
  constructor(private readonly page: Page) {}

  /** Opens the scenario of a link; without one a standing adult. */
  openLink(part: string | undefined): void {
    const text = part === undefined ? "" : decoded(part);
    void this.page.turn(async (goesOn) => {
      if (text === undefined) this.page.tell(texts.badLink);
      try {
        await this.openScenario(text ?? "", {}, goesOn);
      } catch (error) {
        if (!this.page.scene && error instanceof Refused && !error.broken) await this.openScenario("", {}, goesOn);
        throw error;
      }
    });
  }

  /** Opens a scenario with the files that it names, or a model. */
  async openFiles(files: File[]): Promise<void> {
    const { page } = this;
    page.tell("");
    const large = files.find((file) => file.size > MOST_BYTES);
    if (large) return page.tell(texts.tooLarge(large.name, `${MOST_BYTES >> 20} MB`));
    const read = new Map<string, string>();
    for (const file of files) {
      const text = await file.text().catch(() => undefined);
      if (text === undefined) return page.tell(texts.unreadable(file.name));
      read.set(file.name, text);
    }
    const scenario = files.find(({ name }) => name.toLowerCase().endsWith(".toml"));
    const model = files.find(({ name }) => /\.(osim|urdf|xml|mjcf)$/i.test(name));
    const motion = files.find(({ name }) => /\.(mot|sto)$/i.test(name));
    if (scenario) {
      await page.turn((goesOn) => this.openScenario(read.get(scenario.name)!, Object.fromEntries(read), goesOn));
    } else if (model) {
      await page.turn(() => page.open({ do: "open_model", name: model.name, text: read.get(model.name)! }));
    }
    if (motion) await page.recorded?.open(motion.name, read.get(motion.name)!);
    if (!scenario && !model && !motion) page.tell(texts.noFile);
  }

  async save(): Promise<void> {
    this.give(NAME, await this.exported(), "application/toml");
    this.page.tell(texts.saved(NAME));
  }

  /** The posture that is shown, or the run so far, for programs that draw. */
  async drawn(kind: "gltf" | "bvh"): Promise<void> {
    const wooden = this.page.view?.wooden ?? true;
    const answer = await this.page.ask(kind === "bvh" ? { do: "bvh" } : { do: "gltf", wooden });
    const name = kind === "bvh" ? "studio.bvh" : "studio.glb";
    if (answer.is === "text") this.give(name, answer.text, "text/plain");
    if (answer.is === "bytes") this.give(name, Uint8Array.from(answer.bytes), "model/gltf-binary");
    this.page.tell(texts.given(name));
  }

  /** The posture that is shown, or the run so far, as a page of its own. */
  async report(): Promise<void> {
    this.page.tell(texts.reporting);
    const answer = await this.page.ask({ do: "report" });
    if (answer.is === "text") this.give("report.html", answer.text, "text/html");
    this.page.tell(texts.given("report.html"));
  }

  /** The picture as it is. */
  async picture(): Promise<void> {
    const picture = await this.page.view?.whole();
    if (!picture) return this.page.tell(texts.noWebgl);
    this.give("studio.png", picture, "image/png");
    this.page.tell(texts.given("studio.png"));
  }

  private give(name: string, content: string | Blob | Uint8Array<ArrayBuffer>, type: string): void {
    const url = URL.createObjectURL(new Blob([content], { type }));
    make("a", { href: url, download: name }).click();
    setTimeout(() => URL.revokeObjectURL(url), 10_000);
  }

  async link(): Promise<void> {
    const link = `${location.origin}${location.pathname}#scenario=${encoded(await this.exported())}`;
    history.replaceState(null, "", link);
    try {
      await navigator.clipboard.writeText(link);
      this.page.tell(texts.copied);
    } catch {
      this.page.tell(texts.linkIs(link));
    }
  }

  private async openScenario(scenario: string, files: Record<string, string>, goesOn: GoesOn): Promise<void> {
    await this.page.open({ do: "open", scenario, files });
    await this.page.settle(goesOn);
  }

  private async exported(): Promise<string> {
    const answer = await this.page.ask({ do: "export" });
    return answer.is === "text" ? answer.text : "";
  }
}
