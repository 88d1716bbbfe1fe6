// Moves a part of the body: by the pointer as long as it is pressed, or by one press of a button.
//
// Where a drag ends depends on the places of the pointer and their order alone, not on the times at which they come or pictures are shown: the body
// takes as many steps to each place as that place needs, and a drag that is let go first takes all that are left.
import type { Handle, Vector } from "./messages";
import { frame, type Page } from "./page";
import { snapped } from "./snap";
import { texts } from "./texts";
import type { GoesOn } from "./turns";

/** Most steps toward a place, and how many that bring nothing: of the pointer on its way, where it is let go, and by a button. */
const WAY = [12, 1] as const;
const END = [60, 6] as const;
const NUDGE = [12, 12] as const;
/** Time of the steps between two pictures, ms. */
const STEPS_MS = 12;

/** Most that a hand pushes, the steps in which it is counted, and how much more one press of a button pushes, N. */
const MOST_FORCE = 500;
const FORCE_STEP = 5;
const PRESS = 10;

/** A force that the pointer draws: from a point of a segment, in its frame and in ground. */
interface Pull {
  segment: string;
  point: Vector;
  from: Vector;
  force: Vector;
}

/** A part that the pointer drags: places that are still to come. */
interface Drag {
  targets: Vector[];
  /** Another place has come, or the part is let go. */
  wake: () => void;
  released: boolean;
}

export class Hand {
  private drags?: Drag;
  private pull?: Pull;

  constructor(private readonly page: Page) {}

  /** The pointer is pressed on a point of a segment. */
  grab(segment: string, point: Vector): void {
    if (this.page.panel.pushing) {
      this.pull = { segment, point, from: this.placeOf({ label: "", segment, point }), force: [0, 0, 0] };
      return;
    }
    const drag: Drag = { targets: [], wake: () => undefined, released: false };
    this.drags = drag;
    void this.page
      .turn((goesOn) => this.dragAlong(segment, point, drag, goesOn))
      .finally(() => {
        if (this.drags === drag) this.drags = undefined;
      });
  }

  drag(target: Vector): void {
    if (this.pull) return this.draw(this.pull, target);
    if (!this.drags || this.drags.released) return;
    const { scene, shown } = this.page;
    const { place, on } = scene && shown ? snapped(scene, shown, target) : { place: target, on: undefined };
    this.page.tell(on === undefined ? "" : texts.snapped(on));
    this.drags.targets.push(place);
    this.drags.wake();
  }

  /** The force of a pointer at a place: an arrow from the point to it, as long as arrows of such a force are. */
  private draw(pull: Pull, target: Vector): void {
    const { page } = this;
    const way = target.map((x, k) => x - pull.from[k]) as Vector;
    const length = Math.hypot(...way);
    const newtons = Math.min(MOST_FORCE, FORCE_STEP * Math.round((length * (page.view?.newtonsPerMetre ?? 0)) / FORCE_STEP));
    pull.force = length > 0 ? (way.map((x) => (x * newtons) / length) as Vector) : [0, 0, 0];
    page.view?.pull(pull.from, pull.force);
    page.tell(texts.newtons(newtons));
  }

  private push({ segment, point, force }: Pull): void {
    const rounded = force.map((x) => Math.round(10 * x) / 10 || 0) as Vector;
    this.page.change({ do: "push", segment, point, force: rounded });
  }

  /** The pointer is let go. A press without a motion, or of a part that cannot be dragged, ends here, too. */
  release(): void {
    const { pull } = this;
    if (pull) {
      this.pull = undefined;
      this.page.view?.pull();
      if (Math.hypot(...pull.force) > 0) this.push(pull);
      return;
    }
    if (!this.drags) return;
    this.drags.released = true;
    this.drags.wake();
    this.drags = undefined;
  }

  nudge(handle: Handle, way: Vector): void {
    if (this.page.panel.pushing) {
      const before = this.page.scene?.forces.find(({ segment }) => segment === handle.segment);
      const length = Math.hypot(...way);
      const force = way.map((x, k) => (before?.force[k] ?? 0) + (PRESS * x) / length) as Vector;
      return this.push({ ...handle, point: before?.point ?? handle.point, from: [0, 0, 0], force });
    }
    void this.page.turn(async (goesOn) => {
      if (!this.page.scene) return;
      this.page.tell("");
      await this.page.leaveRun();
      await this.step(handle, way);
      await this.page.settle(goesOn);
    });
  }

  /** Where a point of a segment is in ground. */
  placeOf({ segment, point }: Handle): Vector {
    const index = this.page.scene!.segments.findIndex(({ name }) => name === segment);
    const [x, y, z, i, j, k, w] = this.page.shown!.places[index];
    const [a, b, c] = point;
    const u: Vector = [j * c - k * b + w * a, k * a - i * c + w * b, i * b - j * a + w * c];
    return [x + a + 2 * (j * u[2] - k * u[1]), y + b + 2 * (k * u[0] - i * u[2]), z + c + 2 * (i * u[1] - j * u[0])];
  }

  /** Drags the point that was grabbed to one place of the pointer after the other; lets it go in any case, and the body settles. */
  private async dragAlong(segment: string, point: Vector, drag: Drag, goesOn: GoesOn): Promise<void> {
    const { page } = this;
    page.tell("");
    await page.leaveRun();
    let hold = page.scene?.held.some((held) => held.segment === segment) ?? false;
    await page.ask({ do: "grab", segment, point });
    try {
      let shown = performance.now();
      let last: Vector | undefined;
      // Something else that begins lets the part go.
      while (!(drag.released || !goesOn()) || drag.targets.length > 0) {
        const target = drag.targets.shift();
        if (!target) {
          await new Promise<void>((resolve) => {
            drag.wake = resolve;
            page.turns.whenEnded(resolve);
          });
          continue;
        }
        page.dragging = hold = true;
        last = target;
        await page.toward(target, ...WAY);
        if (performance.now() - shown < STEPS_MS && drag.targets.length > 0) continue;
        page.showLast();
        await frame();
        shown = performance.now();
      }
      if (last) await page.toward(last, ...END);
    } finally {
      page.dragging = false;
      await page.ask({ do: "release", hold });
    }
    await page.settle(goesOn);
  }

  /** Moves a part by one press of a button; lets it go in any case. */
  private async step(handle: Handle, way: Vector): Promise<void> {
    const { page } = this;
    await page.ask({ do: "grab", segment: handle.segment, point: handle.point });
    try {
      const target = this.placeOf(handle).map((x, k) => x + way[k]) as Vector;
      await page.toward(target, ...NUDGE);
      page.showLast();
    } finally {
      await page.ask({ do: "release", hold: true });
    }
  }
}
