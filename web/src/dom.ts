// Makes elements of the page.

type Child = Node | string;

export function make<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  properties: Partial<HTMLElementTagNameMap[K]> = {},
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  const element = Object.assign(document.createElement(tag), properties);
  element.append(...children);
  return element;
}

/** A control with its label in words. */
export function labelled(label: string, control: HTMLElement): HTMLLabelElement {
  return make("label", {}, make("span", { textContent: label }), control);
}

export function button(text: string, id: string, press: () => void): HTMLButtonElement {
  const made = make("button", { type: "button", textContent: text, id });
  made.addEventListener("click", press);
  return made;
}

/** A slider that shows its value; `change` is called when it is let go. */
export class Slider {
  readonly element: HTMLLabelElement;
  private readonly input: HTMLInputElement;
  private readonly output = make("output");

  constructor(
    label: string,
    id: string,
    [min, max, step]: [number, number, number],
    private readonly unit: string,
    change: (value: number) => void,
  ) {
    this.input = make("input", { type: "range", id, min: String(min), max: String(max), step: String(step) });
    this.input.addEventListener("input", () => this.tell());
    this.input.addEventListener("change", () => change(this.value));
    this.element = make("label", { className: "slider" }, make("span", { textContent: label }), this.input, this.output);
  }

  get value(): number {
    return Number(this.input.value);
  }

  set value(value: number) {
    this.input.value = String(value);
    this.tell();
  }

  set disabled(disabled: boolean) {
    this.input.disabled = disabled;
  }

  private tell(): void {
    this.output.textContent = `${this.input.value} ${this.unit}`;
  }
}
