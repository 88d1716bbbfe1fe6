// Moves a part of the body: by the pointer as long as it is pressed, or by one press of a button.
import type { Handle, Vector } from "./messages";
import { frame, type Page } from "./page";
import type { GoesOn } from "./turns";

/** Steps of a drag by a button. */
const NUDGE_STEPS = 12;

export class Hand {
  private drags?: { target?: Vector };

  constructor(private readonly page: Page) {}

  /** The pointer is pressed on a point of a segment. */
  grab(segment: string, point: Vector): void {
    const drags: { target?: Vector } = {};
    this.drags = drags;
    void this.page
      .turn((goesOn) => this.dragAlong(segment, point, drags, goesOn))
      .finally(() => {
        if (this.drags === drags) this.drags = undefined;
      });
  }

  drag(target: Vector): void {
    if (this.drags) this.drags.target = target;
  }

  /** The pointer is let go. A press without a motion, or of a part that cannot be dragged, ends here, too. */
  release(): void {
    void this.page.turn(async (goesOn) => {
      if (!this.page.inRun) await this.page.settle(goesOn);
    });
  }

  nudge(handle: Handle, way: Vector): void {
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

  /** Drags the point that was grabbed toward the pointer; lets it go in any case. */
  private async dragAlong(segment: string, point: Vector, drags: { target?: Vector }, goesOn: GoesOn): Promise<void> {
    const { page } = this;
    if (!goesOn()) return;
    page.tell("");
    await page.leaveRun();
    let hold = page.scene?.held.some((held) => held.segment === segment) ?? false;
    await page.ask({ do: "grab", segment, point });
    try {
      while (goesOn()) {
        if (drags.target) {
          page.dragging = hold = true;
          await page.ask({ do: "drag", target: drags.target });
        }
        await frame();
      }
    } finally {
      page.dragging = false;
      await page.ask({ do: "release", hold });
    }
  }

  /** Moves a part by one press of a button; lets it go in any case. */
  private async step(handle: Handle, way: Vector): Promise<void> {
    const { page } = this;
    await page.ask({ do: "grab", segment: handle.segment, point: handle.point });
    try {
      const target = this.placeOf(handle).map((x, k) => x + way[k]) as Vector;
      for (let step = 0; step < NUDGE_STEPS; step++) {
        const answer = await page.ask({ do: "drag", target });
        if (answer.is === "shown" && (answer.miss ?? 0) < 1e-4) break;
      }
    } finally {
      await page.ask({ do: "release", hold: true });
    }
  }
}
