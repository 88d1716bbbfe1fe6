// The studio: connects the page with its controls, its picture and its files.
import { Clock } from "./clock";
import { Files } from "./files";
import { Hand } from "./hand";
import { scenarioPart } from "./link";
import type { Request, Vector } from "./messages";
import { button, make } from "./dom";
import { Help } from "./help";
import { recall } from "./kept";
import { jumps } from "./jumps";
import { keepForOffline } from "./offline";
import { Page, byId } from "./page";
import { Panel } from "./panel";
import { Recorded } from "./recorded";
import { Rest } from "./rest";
import { duration, texts } from "./texts";
import { View, sides } from "./view";

const page = new Page();
const hand = new Hand(page);
const files = new Files(page);

page.panel = new Panel(byId("panel"), byId("changes"), {
  figure: (wooden) => {
    if (page.view) page.view.wooden = wooden;
    page.dress();
  },
  adult: (sex, stature, mass) => page.change({ do: "adult", sex, stature, mass }),
  percentile: (sex, percentile) => page.change({ do: "percentile", sex, percentile }),
  nudge: (handle, way) => hand.nudge(handle, way),
  free: (segment) => page.change({ do: "free", segment }),
  load: (segment, mass) => page.change({ do: "load", segment, mass }),
  takeOff: ({ segment, point }) => page.change({ do: "push", segment, point, force: [0, 0, 0] }),
  put: (word, keys) => page.change({ do: "put", word, keys }),
  takeAway: (word, number) => page.change({ do: "take_away", word, number }),
  strategy: (kind, region) => clock.setStrategy(kind, region),
  play: () => clock.toggle(),
  endPlay: (take) => clock.end(take),
  joint: () => page.chart(true),
  undo: () => page.change({ do: "undo" }, false),
  redo: () => page.change({ do: "redo" }, false),
  mirror: () => page.change({ do: "mirror" }, false),
  look: (time) => clock.look(time),
  now: () => clock.look(undefined),
  reset: () => page.change({ do: "reset" }),
  openFiles: (given) => void page.guard(() => files.openFiles(given)),
  save: () => void page.guard(() => files.save()),
  report: () => void page.guard(() => files.report()),
  picture: () => void page.guard(() => files.picture()),
  drawn: (kind) => void page.guard(() => files.drawn(kind)),
  link: () => void page.guard(() => files.link()),
});
const clock = new Clock(page);

function makeView(): View | undefined {
  try {
    return new View(byId<HTMLCanvasElement>("canvas"), {
      grab: (segment, point) => hand.grab(segment, point),
      drag: (target) => hand.drag(target),
      release: () => hand.release(),
    });
  } catch {
    page.tell(texts.noWebgl);
    return undefined;
  }
}

function listen(): void {
  addEventListener("dragover", (event) => event.preventDefault());
  addEventListener("drop", (event) => {
    event.preventDefault();
    void page.guard(() => files.openFiles([...(event.dataTransfer?.files ?? [])]));
  });
  addEventListener("hashchange", () => {
    const part = scenarioPart(location.hash);
    if (part) files.openLink(part);
  });
  byId("canvas").addEventListener("keydown", (event) => {
    if (!event.ctrlKey && !event.altKey && !event.metaKey && page.panel.key(event.key)) event.preventDefault();
  });
  addEventListener("keydown", (event) => {
    if (!(event.ctrlKey || event.metaKey) || event.key.toLowerCase() !== "z") return;
    event.preventDefault();
    page.change({ do: event.shiftKey ? "redo" : "undo" }, false);
  });
}

page.view = makeView();
page.rest = new Rest(page);
byId("panel").prepend(jumps(byId("panel"), byId("rests")));
page.recorded = new Recorded(page);
byId("views").ariaLabel = texts.views;
byId("views").append(make("span", { textContent: texts.views }), ...sides.map((side) => button(texts.sides[side], `view-${side}`, () => page.view?.lookFrom(side))));
new Help();
listen();
const linked = scenarioPart(location.hash);
const kept = linked === undefined ? recall() : undefined;
if (kept) page.restore(kept, () => files.openLink(undefined));
else files.openLink(linked);

/** For tests and for measuring: where a part is on the canvas, how long calls took, ms, and how many objects the graphics card holds. */
const probe = {
  onCanvas: (label: string) => {
    const handle = page.scene?.handles.find((handle) => handle.label === label);
    return handle && page.view?.onCanvas(hand.placeOf(handle));
  },
  times: () => page.solver.times,
  ask: (request: Request) => page.ask(request),
  /** A drag of the right hand, by its middle or by a point of it, along places beside where it is, each after a pause, ms. */
  drag: async (ways: Vector[], pause: () => number, point?: Vector) => {
    const handle = { ...page.scene!.handles[0], ...(point && { point }) };
    const from = hand.placeOf(handle);
    hand.grab(handle.segment, handle.point);
    for (const way of ways) {
      hand.drag(from.map((x, k) => x + way[k]) as Vector);
      if (pause() > 0) await new Promise((resolve) => setTimeout(resolve, pause()));
    }
    hand.release();
  },
  skin: () => page.view?.skinPlaces,
  figure: () => (page.view?.wooden === false && page.view.dressed ? "person" : "wooden"),
  scene: () => page.scene,
  shown: () => page.shown,
  /** Where a point of the right hand is. */
  place: (point: Vector) => hand.placeOf({ ...page.scene!.handles[0], point }),
  thingsShown: () => page.view?.thingsShown,
  geometries: () => page.view?.geometries ?? 0,
};
Object.assign(window, { studio: probe, duration });

keepForOffline();
