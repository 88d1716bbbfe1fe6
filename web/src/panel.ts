// The controls beside the picture: what they show follows the scene, what they do is told to the page.
import { draw } from "./chart";
import { Slider, button, labelled, make } from "./dom";
import type { Balance, Handle, Played, Pushed, Scene, Shown, Vector } from "./messages";
import { duration, texts } from "./texts";
import { Things, type Putting } from "./things";

/** Way of a press of a button, m. */
const NUDGE = 0.02;
/** Simulated seconds in a second. */
const SPEEDS = [1, 10, 60, 600];

export interface Doing extends Putting {
  figure(wooden: boolean): void;
  adult(sex: string, stature: number, mass: number): void;
  percentile(sex: string, percentile: number): void;
  nudge(handle: Handle, way: Vector): void;
  free(segment: string): void;
  load(segment: string, mass: number): void;
  takeOff(force: Handle): void;
  strategy(kind: string, region: string | undefined): void;
  play(): void;
  endPlay(take: boolean): void;
  joint(name: string): void;
  undo(): void;
  redo(): void;
  reset(): void;
  mirror(): void;
  look(time: number): void;
  now(): void;
  openFiles(files: File[]): void;
  save(): void;
  picture(): void;
  report(): void;
  drawn(kind: "gltf" | "bvh"): void;
  link(): void;
}

const WAYS: [keyof typeof texts.moves, Vector, string][] = [
  ["up", [0, NUDGE, 0], "PageUp"],
  ["down", [0, -NUDGE, 0], "PageDown"],
  ["forward", [NUDGE, 0, 0], "ArrowUp"],
  ["back", [-NUDGE, 0, 0], "ArrowDown"],
  ["left", [0, 0, -NUDGE], "ArrowLeft"],
  ["right", [0, 0, NUDGE], "ArrowRight"],
];

function section(title: string, ...children: (Node | string)[]): HTMLElement {
  return make("section", {}, make("h2", { textContent: title }), ...children);
}

/** What each support carries, as a share of what all of them carry: of body and loads. */
export function carried(scene: Scene, { contacts }: Shown): string[] {
  const all = contacts.reduce((sum, { share }) => sum + share, 0);
  const label = (segment?: string) => scene.segments.find(({ name }) => name === segment)?.label ?? segment ?? "";
  return contacts.map(({ share }, i) => texts.share(label(scene.supports[i]), `${Math.round((100 * share) / (all > 0 ? all : 1))} %`));
}

export class Panel {
  private scene?: Scene;
  private readonly part = make("select", { id: "part" });
  private readonly held = make("ul", { id: "held" });
  private readonly weight: Slider;
  private readonly push = make("input", { type: "checkbox", id: "pushing" });
  private readonly forces = make("ul", { id: "forces" });
  private readonly figure: HTMLSelectElement;
  private readonly sex: HTMLSelectElement;
  private readonly stature: Slider;
  private readonly mass: Slider;
  private readonly percentile: Slider;
  private readonly percentiles = make("p", { className: "quiet", id: "percentiles" });
  private readonly strategies: HTMLInputElement[];
  private readonly region = make("select", { id: "region" });
  private readonly playing: HTMLButtonElement;
  private readonly speeds = make("select", { id: "speed" }, ...SPEEDS.map((x) => make("option", { value: String(x), textContent: `${x}×` })));
  private readonly clock = make("output", { id: "clock" });
  private readonly asking = make("p", { id: "asking", role: "status" });
  private readonly log = make("ol", { id: "log" });
  private readonly count = make("p", { className: "quiet" });
  private readonly run: HTMLElement;
  private readonly things: Things;
  private readonly past: HTMLInputElement;
  private readonly pastTime = make("output");
  private readonly looking: HTMLElement;
  private readonly jointChoice = make("select", { id: "joint" });
  private readonly numbers = make("p", { id: "torques" });
  private readonly chart = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  private readonly contacts = make("p", { id: "contacts" });
  private readonly notes = make("ul", { id: "notes" });
  private readonly undo: HTMLButtonElement;
  private readonly redo: HTMLButtonElement;

  constructor(
    root: HTMLElement,
    changes: HTMLElement,
    private readonly doing: Doing,
  ) {
    const size = () => doing.adult(this.sex.value, this.stature.value, this.mass.value);
    this.sex = make(
      "select",
      { id: "sex" },
      make("option", { value: "female", textContent: texts.female }),
      make("option", { value: "male", textContent: texts.male }),
    );
    this.sex.addEventListener("change", size);
    this.figure = make(
      "select",
      { id: "figure" },
      make("option", { value: "person", textContent: texts.person }),
      make("option", { value: "wooden", textContent: texts.wooden }),
    );
    this.figure.addEventListener("change", () => doing.figure(this.figure.value === "wooden"));
    this.stature = new Slider(texts.stature, "stature", [1.2, 2.3, 0.01], "m", size);
    this.mass = new Slider(texts.mass, "mass", [30, 250, 1], "kg", size);
    this.percentile = new Slider(texts.percentile, "percentile", [1, 99, 1], "", (percentile) => doing.percentile(this.sex.value, percentile));
    this.weight = new Slider(texts.weight, "weight", [0, 30, 0.5], "kg", (mass) => {
      const handle = this.handle();
      if (handle) doing.load(handle.segment, mass);
    });
    this.part.addEventListener("change", () => this.showWeight());
    this.strategies = ["passive", "active"].map((kind) => {
      const choice = make("input", { type: "radio", name: "strategy", value: kind, id: kind });
      choice.addEventListener("change", () => doing.strategy(kind, this.region.value || undefined));
      return choice;
    });
    this.region.addEventListener("change", () => this.showStrategy());
    this.playing = button(texts.play, "play", () => doing.play());
    this.undo = button(texts.undo, "undo", () => doing.undo());
    this.redo = button(texts.redo, "redo", () => doing.redo());
    this.jointChoice.addEventListener("change", () => doing.joint(this.jointChoice.value));
    this.chart.id = "chart";
    this.chart.setAttribute("role", "img");
    this.run = make(
      "div",
      { className: "row" },
      button(texts.keep, "keep", () => doing.endPlay(true)),
      button(texts.back, "back", () => doing.endPlay(false)),
    );
    this.things = new Things(doing);
    this.past = make("input", { type: "range", id: "past", min: "0", step: "any", ariaLabel: texts.look });
    this.past.addEventListener("input", () => doing.look(Number(this.past.value)));
    this.looking = make(
      "div",
      { className: "row" },
      make("label", { className: "slider" }, make("span", { textContent: texts.look }), this.past, this.pastTime),
      button(texts.now, "now", () => doing.now()),
    );
    this.speeds.value = "60";
    changes.ariaLabel = texts.changes;
    changes.append(this.undo, this.redo, button(texts.reset, "reset", () => doing.reset()), button(texts.mirror, "mirror", () => doing.mirror()), make("label", { className: "choice" }, this.push, texts.pushing));
    root.append(...this.sections());
    this.ended();
  }

  private sections(): HTMLElement[] {
    const picker = make("input", { type: "file", multiple: true, hidden: true, accept: ".toml,.osim,.urdf,.xml,.mjcf,.mot,.sto" });
    picker.addEventListener("change", () => {
      this.doing.openFiles([...(picker.files ?? [])]);
      picker.value = "";
    });
    const way = ([name, step]: (typeof WAYS)[number]) => button(texts.moves[name], `move-${name}`, () => this.nudge(step));
    const strategy = (choice: HTMLInputElement, text: string) => make("label", { className: "choice" }, choice, text);
    const files = make(
      "div",
      { className: "row" },
      button(texts.open, "open", () => picker.click()),
      button(texts.export, "export", () => this.doing.save()),
      button(texts.png, "png", () => this.doing.picture()),
      button(texts.gltf, "gltf", () => this.doing.drawn("gltf")),
      button(texts.bvh, "bvh", () => this.doing.drawn("bvh")),
      button(texts.report, "report", () => this.doing.report()),
      button(texts.link, "link", () => this.doing.link()),
      picker,
    );
    return [
      section(texts.partTitle, labelled(texts.part, this.part), make("div", { className: "row" }, ...WAYS.map(way)), make("p", { className: "quiet", textContent: texts.moveHelp }), this.forces, this.weight.element, make("h3", { textContent: texts.held }), this.held),
      section(
        texts.time,
        make("div", { className: "row" }, this.playing, labelled(texts.speed, this.speeds), this.clock),
        this.run,
        this.looking,
        this.asking,
        make("fieldset", {}, make("legend", { textContent: texts.strategyTitle }), labelled(texts.region, this.region), strategy(this.strategies[0], texts.relaxed), strategy(this.strategies[1], texts.ready)),
        make("h3", { textContent: texts.log }),
        this.log,
        this.count,
      ),
      section(texts.things.title, ...this.things.elements),
      section(texts.jointTitle, labelled(texts.joint, this.jointChoice), this.chart as unknown as HTMLElement, this.numbers, make("h3", { textContent: texts.contacts }), this.contacts),
      section(texts.body, labelled(texts.figure, this.figure), labelled(texts.sex, this.sex), this.stature.element, this.mass.element, this.percentile.element, this.percentiles),
      section(texts.files, files, make("p", { className: "quiet", textContent: texts.about }), make("h3", { textContent: texts.notes }), this.notes),
    ];
  }

  /** The part that the controls move. */
  private handle(): Handle | undefined {
    return this.scene?.handles[this.part.selectedIndex];
  }

  private nudge(way: Vector): void {
    const handle = this.handle();
    if (handle) this.doing.nudge(handle, way);
  }

  /** A key that was pressed on the picture; whether it moves a part. */
  key(name: string): boolean {
    const way = WAYS.find(([, , key]) => key === name);
    if (way) this.nudge(way[1]);
    return way !== undefined;
  }

  /** A drag, and a press of a button, pushes on a part instead of moving it. */
  get pushing(): boolean {
    return this.push.checked;
  }

  get speed(): number {
    return Number(this.speeds.value);
  }

  get jointName(): string {
    return this.jointChoice.value;
  }

  /** Another body or another job. */
  open(scene: Scene): void {
    const [part, joint] = [this.part.selectedIndex, this.jointChoice.value];
    this.scene = scene;
    this.part.replaceChildren(...scene.handles.map(({ label }) => make("option", { textContent: label })));
    this.part.selectedIndex = Math.max(0, Math.min(part, scene.handles.length - 1));
    const joints = scene.coordinates.filter(({ groups, turns }) => groups && turns);
    this.jointChoice.replaceChildren(...joints.map(({ name, label }) => make("option", { value: name, textContent: label })));
    this.jointChoice.value = joints.some(({ name }) => name === joint) ? joint : hardest(scene);
    const free = ({ label, segment }: Handle) => make("li", {}, button(texts.free(label), `free-${segment}`, () => this.doing.free(segment)));
    this.held.replaceChildren(...(scene.held.length ? scene.held.map(free) : [make("li", { className: "quiet", textContent: texts.nothingHeld })]));
    for (const control of [this.sex, this.stature, this.mass, this.percentile]) control.disabled = scene.person === null;
    this.figure.disabled = scene.shown.bones.length === 0;
    const off = (force: Pushed) => make("li", {}, button(texts.takeOff(force.label, Math.hypot(...force.force)), `off-${force.segment}`, () => this.doing.takeOff(force)));
    this.forces.replaceChildren(...scene.forces.map(off));
    const region = this.region.value;
    const regions = scene.regions.map(({ name }) => make("option", { value: name, textContent: texts.regions[name] ?? name }));
    this.region.replaceChildren(make("option", { value: "", textContent: texts.wholeBody }), ...regions);
    this.region.value = scene.regions.some(({ name }) => name === region) ? region : "";
    [this.undo.disabled, this.redo.disabled] = [!scene.can_undo, !scene.can_redo];
    this.things.open(scene);
    this.notes.replaceChildren(...scene.notes.map((textContent) => make("li", { textContent })));
    this.restore();
    this.show(scene.shown);
  }

  /** Controls show what is so, also after a change that was refused. */
  restore(): void {
    const { scene } = this;
    if (!scene) return;
    if (scene.person) {
      this.sex.value = scene.person.sex;
      this.stature.value = scene.person.stature;
      this.mass.value = scene.person.mass;
      const [stature, mass] = scene.person.percentiles.map(Math.round);
      this.percentile.value = Math.min(99, Math.max(1, stature));
      this.percentiles.textContent = texts.percentiles(stature, mass);
    }
    this.showStrategy();
    this.showWeight();
  }

  /** The strategy of the chosen region; of the whole body only where all regions have it. */
  private showStrategy(): void {
    const { scene } = this;
    if (!scene) return;
    const chosen = scene.regions.filter(({ name }) => !this.region.value || name === this.region.value);
    const kinds = chosen.length ? chosen.map(({ strategy }) => strategy) : [scene.strategy];
    for (const choice of this.strategies) choice.checked = kinds.every((kind) => kind === choice.value);
  }

  private showWeight(): void {
    const segment = this.handle()?.segment;
    this.weight.value = this.scene?.loads.find((load) => load.segment === segment)?.mass ?? 0;
  }

  /** Another posture: the numbers of the chosen joint, and the contact forces. */
  show(shown: Shown): void {
    const { scene } = this;
    if (!scene) return;
    const index = scene.coordinates.findIndex(({ name }) => name === this.jointChoice.value);
    const torque = (value: number) => value.toFixed(1).replace("-", "−");
    if (index >= 0) {
      const angle = ((shown.angles[index] * 180) / Math.PI).toFixed(1).replace("-", "−");
      const values = `${texts.external} ${torque(shown.external[index])}, ${texts.passive} ${torque(shown.passive[index])}, ${texts.active} ${torque(shown.active[index])} ${texts.quantity}`;
      this.numbers.textContent = `${angle}°: ${values}; ${texts.load} ${Math.round(100 * shown.load[index])} %`;
    }
    this.contacts.textContent = carried(scene, shown).join(", ");
  }

  drawChart(balance: Balance, shown: Shown): void {
    const index = this.scene?.coordinates.findIndex(({ name }) => name === balance.coordinate) ?? -1;
    if (index >= 0) draw(this.chart, balance, shown, index, this.scene!.coordinates[index].label);
  }

  /** A run goes on, or is looked at as it was; `end`: the time that has passed in it, s. */
  played(played: Played, before: number, end: number): void {
    [this.past.max, this.past.value] = [String(end), String(played.time)];
    this.pastTime.textContent = this.past.ariaValueText = duration(before + played.time);
    this.looking.hidden = false;
    this.clock.textContent = duration(before + played.time);
    this.asking.textContent = played.asking.length ? texts.asking(played.asking.join(", ")) : texts.nobody;
    if (this.log.childElementCount !== played.log.length || this.log.dataset.last !== played.log.at(-1)?.sentence) {
      this.log.dataset.last = played.log.at(-1)?.sentence ?? "";
      this.log.replaceChildren(...played.log.map(({ time, sentence }) => make("li", { textContent: `${duration(before + time)}: ${sentence}` })));
    }
    this.count.textContent = played.decisions > played.log.length ? texts.more(played.decisions) : "";
    this.run.hidden = false;
  }

  running(running: boolean): void {
    this.playing.textContent = running ? texts.pause : texts.play;
    this.playing.setAttribute("aria-pressed", String(running));
  }

  /** No run is under way. */
  ended(): void {
    this.running(false);
    this.run.hidden = this.looking.hidden = true;
    this.clock.textContent = duration(0);
    this.asking.textContent = "";
    this.count.textContent = "";
    this.log.replaceChildren();
  }
}

/** The coordinate with the greatest load. */
function hardest({ coordinates, shown }: Scene): string {
  let best = coordinates.findIndex(({ groups, turns }) => groups && turns);
  coordinates.forEach(({ groups, turns }, i) => {
    if (groups && turns && shown.load[i] > shown.load[best]) best = i;
  });
  return coordinates[best]?.name ?? "";
}
