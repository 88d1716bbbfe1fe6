// A row of buttons on top of the panel: each brings a part of the page into view, and the keyboard with it.
import { button, make } from "./dom";
import { texts } from "./texts";

export function jumps(panel: HTMLElement, rests: HTMLElement): HTMLElement {
  const go = (part: HTMLElement) => {
    part.scrollIntoView({ block: "start" });
    part.querySelector<HTMLElement>("button:not(:disabled), select, input")?.focus({ preventScroll: true });
  };
  const named: [string, HTMLElement][] = [...panel.querySelectorAll<HTMLElement>("section:not([hidden])")].map((part) => [part.querySelector("h2")?.textContent ?? "", part]);
  // The ways to rest stand below the picture; their button follows that of the things.
  named.splice(3, 0, [texts.rest.title, rests]);
  return make("nav", { id: "jumps", ariaLabel: texts.jumps }, ...named.map(([name, part], i) => button(name, `jump-${i}`, () => go(part))));
}
