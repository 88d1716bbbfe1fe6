// Draws a place that is near to the surface of a thing, or to the floor, onto it.
import { Quaternion, Vector3 } from "three";
import type { Scene, Shown, Vector } from "./messages";
import { texts } from "./texts";

/** A place this near to a surface is on it, m. */
const NEAR = 0.03;

/** The place on the nearest surface, and what it is on; the place itself where none is near. */
export function snapped(scene: Scene, shown: Shown, place: Vector): { place: Vector; on?: string } {
  let [nearest, best]: [number, { place: Vector; on?: string }] = [NEAR, { place }];
  for (const { name, size, place: at, segment } of scene.things) {
    if (segment !== null) continue;
    const turn = new Quaternion(at[3], at[4], at[5], at[6]);
    const middle = new Vector3(at[0], at[1], at[2]);
    const inside = new Vector3(...place).sub(middle).applyQuaternion(turn.clone().invert()).toArray();
    const onSurface = surface(inside, size);
    const distance = Math.hypot(...onSurface.map((x, k) => x - inside[k]));
    if (distance >= nearest) continue;
    const { x, y, z } = new Vector3(...onSurface).applyQuaternion(turn).add(middle);
    [nearest, best] = [distance, { place: [x, y, z], on: name }];
  }
  // The floor is where the lowest patch stands, as it is drawn.
  const floor = Math.min(...shown.patches.map((corner) => corner[1]));
  if (Math.abs(place[1] - floor) < nearest) best = { place: [place[0], floor, place[2]], on: texts.floor };
  return best;
}

/** The nearest place on the surface of a box about the origin. */
function surface(at: Vector, size: Vector): Vector {
  const clamped = at.map((x, k) => Math.min(Math.max(x, -size[k] / 2), size[k] / 2)) as Vector;
  if (clamped.some((x, k) => x !== at[k])) return clamped;
  const depths = at.map((x, k) => size[k] / 2 - Math.abs(x));
  const axis = depths.indexOf(Math.min(...depths));
  clamped[axis] = (Math.sign(at[axis]) || 1) * (size[axis] / 2);
  return clamped;
}
