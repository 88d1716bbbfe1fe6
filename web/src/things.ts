// Things by a menu, in the words of the scenario file: what is held, what carries the body, what stands in its way.
import { button, labelled, make } from "./dom";
import type { Keys, Scene, ThingTable } from "./messages";
import { texts } from "./texts";

/** A field of a thing: a number with its bounds and unit, or one of some words. */
type Field =
  | { key: string; number: number; least: number; most: number; step: number; unit: string }
  | { key: string; words: string[] };

const number = (key: string, value: number, least: number, most: number, step: number, unit: string): Field => ({ key, number: value, least, most, step, unit });
const words = (key: string, ...given: string[]): Field => ({ key, words: given });

/** Fields of each thing, and the keys of its table. */
const THINGS: Record<string, { fields: Field[]; keys: (value: (key: string) => number, word: (key: string) => string) => Keys }> = {
  box: {
    fields: [number("mass", 5, 0.5, 50, 0.5, "kg"), number("ahead", 0.4, 0.2, 0.8, 0.01, "m"), number("height", 1, 0.1, 1.8, 0.01, "m")],
    keys: (value) => ({ mass_kg: value("mass"), size_m: [0.3, 0.25, 0.4], at_m: [value("ahead"), value("height"), 0] }),
  },
  bag: { fields: [number("mass", 6, 0.5, 40, 0.5, "kg"), words("on", "right_shoulder", "left_shoulder", "right_hand", "left_hand", "back")], keys: (value, word) => ({ mass_kg: value("mass"), on: word("on") }) },
  tool: {
    fields: [words("hand", "right", "left"), number("mass", 2, 0, 20, 0.5, "kg"), number("ahead", 0.35, 0.1, 0.8, 0.01, "m"), number("height", 1.3, 0.5, 2.1, 0.01, "m"), number("up", 0, 0, 200, 5, "N")],
    keys: (value, word) => ({
      hand: word("hand"),
      mass_kg: value("mass"),
      at_m: [value("ahead"), value("height"), word("hand") === "right" ? 0.2 : -0.2],
      ...(value("up") > 0 ? { force_n: [0, -value("up"), 0] } : {}),
    }),
  },
  handle: {
    fields: [words("way", "push", "pull"), number("force", 50, 0, 400, 5, "N"), number("ahead", 0.5, 0.2, 0.8, 0.01, "m"), number("height", 1.1, 0.5, 1.7, 0.01, "m"), words("hands", "both", "right", "left")],
    keys: (value, word) => ({ at_m: [value("ahead"), value("height"), 0], hands: word("hands"), [`${word("way")}_n`]: value("force") }),
  },
  step: { fields: [number("height", 0.2, 0.02, 0.6, 0.01, "m"), words("under", "right_foot", "left_foot")], keys: (value, word) => ({ height_m: value("height"), under: word("under") }) },
  floor: {
    fields: [number("stride", 0.3, 0, 0.8, 0.01, "m"), words("foot", "right_foot", "left_foot"), words("stepping", "no", "yes")],
    keys: (value, word) => ({ stride_m: value("stride"), ahead: word("foot"), may_step: word("stepping") === "yes" }),
  },
  seat: { fields: [number("height", 0.43, 0.3, 0.8, 0.01, "m"), words("backrest", "no", "yes")], keys: (value, word) => ({ height_m: value("height"), backrest: word("backrest") === "yes" }) },
  table: { fields: [number("height", 0.74, 0.4, 1.3, 0.01, "m"), number("edge", 0.3, 0.1, 0.8, 0.01, "m")], keys: (value) => ({ height_m: value("height"), edge_m: value("edge") }) },
  counter: { fields: [number("height", 0.95, 0.4, 1.3, 0.01, "m"), number("edge", 0.25, 0.1, 0.8, 0.01, "m")], keys: (value) => ({ height_m: value("height"), edge_m: value("edge") }) },
  wall: { fields: [words("side", "ahead", "behind", "right", "left"), number("distance", 0.5, 0.15, 2, 0.01, "m")], keys: (value, word) => ({ [`${word("side")}_m`]: value("distance") }) },
};

export interface Putting {
  put(word: string, keys: Keys): void;
  takeAway(word: string, number: number): void;
}

export class Things {
  readonly elements: HTMLElement[];
  private readonly choice = make("select", { id: "thing" }, ...Object.keys(THINGS).map((word) => make("option", { value: word, textContent: texts.things.names[word] ?? word })));
  private readonly fields = make("div", { className: "fields" });
  private readonly list = make("ul", { id: "things" });

  constructor(private readonly doing: Putting) {
    this.choice.addEventListener("change", () => this.showFields());
    this.elements = [
      labelled(texts.things.thing, this.choice),
      this.fields,
      make("div", { className: "row" }, button(texts.things.put, "put", () => this.put())),
      make("p", { className: "quiet", textContent: texts.things.anew }),
      this.list,
    ];
    this.showFields();
  }

  /** The things of a scenario, each with a button that takes it away. */
  open({ tables }: Scene): void {
    const item = (table: ThingTable) => {
      const name = texts.things.names[table.word] ?? table.word;
      const away = button(texts.things.away(name), `away-${table.word}-${table.number}`, () => this.doing.takeAway(table.word, table.number));
      return make("li", {}, away, make("span", { className: "quiet", textContent: ` ${told(table.keys)}` }));
    };
    this.list.replaceChildren(...tables.filter(({ word, keys }) => word !== "floor" || Object.keys(keys).length > 0).map(item));
  }

  private showFields(): void {
    const field = (field: Field) => {
      const id = `thing-${field.key}`;
      const name = texts.things.fields[field.key] ?? field.key;
      if ("words" in field) {
        return labelled(name, make("select", { id }, ...field.words.map((word) => make("option", { value: word, textContent: word.replaceAll("_", " ") }))));
      }
      const { number, least, most, step, unit } = field;
      const input = make("input", { type: "number", id, min: String(least), max: String(most), step: String(step), value: String(number) });
      return make("label", {}, make("span", { textContent: name }), input, unit);
    };
    this.fields.replaceChildren(...THINGS[this.choice.value].fields.map(field));
  }

  private put(): void {
    const input = (key: string) => this.fields.querySelector<HTMLInputElement | HTMLSelectElement>(`#thing-${key}`)!;
    const wrong = [...this.fields.querySelectorAll("input")].find((field) => !field.reportValidity());
    if (!wrong) this.doing.put(this.choice.value, THINGS[this.choice.value].keys((key) => Number(input(key).value), (key) => input(key).value));
  }
}

/** The keys of a table in one line, as the file has them. */
function told(keys: Keys): string {
  return Object.entries(keys).map(([key, value]) => `${key} = ${JSON.stringify(value)}`).join(", ");
}
