// The wooden figure: every segment is the convex hull of a few balls, as in the report.
import { BufferAttribute, BufferGeometry } from "three";

const RINGS = 14;
const SLICES = 20;

function directions(): [number, number, number][] {
  const found: [number, number, number][] = [];
  for (let ring = 0; ring <= RINGS; ring++) {
    for (let slice = 0; slice <= SLICES; slice++) {
      const down = (Math.PI * ring) / RINGS;
      const around = (2 * Math.PI * slice) / SLICES;
      found.push([Math.sin(down) * Math.cos(around), Math.cos(down), Math.sin(down) * Math.sin(around)]);
    }
  }
  return found;
}

const DIRECTIONS = directions();

/** The hull of balls (x, y, z, radius): its farthest point in each direction. */
export function hull(balls: [number, number, number, number][]): BufferGeometry {
  const places: number[] = [];
  for (const [dx, dy, dz] of DIRECTIONS) {
    let best = balls[0];
    let farthest = -Infinity;
    for (const ball of balls) {
      const far = ball[0] * dx + ball[1] * dy + ball[2] * dz + ball[3];
      if (far > farthest) [farthest, best] = [far, ball];
    }
    places.push(best[0] + best[3] * dx, best[1] + best[3] * dy, best[2] + best[3] * dz);
  }
  const triangles: number[] = [];
  for (let ring = 0; ring < RINGS; ring++) {
    for (let slice = 0; slice < SLICES; slice++) {
      const a = ring * (SLICES + 1) + slice;
      const b = a + SLICES + 1;
      triangles.push(a, a + 1, b, a + 1, b + 1, b);
    }
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(new Float32Array(places), 3));
  geometry.setAttribute("normal", new BufferAttribute(new Float32Array(DIRECTIONS.flat()), 3));
  geometry.setIndex(triangles);
  return geometry;
}
