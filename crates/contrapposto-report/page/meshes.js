// Meshes as lists of numbers: six for every point, its position and its normal.
const RINGS = 16, SLICES = 24;
const SLAB_THICKNESS = 0.025, GRID_SPACING = 0.25, GRID_HALF = 6;

function cross(p, q) {
  return [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]];
}

// A vector of length 1 in the same direction; the zero vector stays.
function unit(vector) {
  const length = Math.hypot(...vector) || 1;
  return vector.map((x) => x / length);
}

// Unit vectors in rings from pole to pole.
function sphereDirections() {
  const directions = [];
  for (let ring = 0; ring <= RINGS; ring++) {
    for (let slice = 0; slice <= SLICES; slice++) {
      const a = Math.PI * ring / RINGS, b = 2 * Math.PI * slice / SLICES;
      directions.push([Math.sin(a) * Math.cos(b), Math.cos(a), Math.sin(a) * Math.sin(b)]);
    }
  }
  return directions;
}

// Triangles between neighbouring directions, as indices of these; the same for every hull.
function sphereTriangles() {
  const indices = [];
  for (let ring = 0; ring < RINGS; ring++) {
    for (let slice = 0; slice < SLICES; slice++) {
      const a = ring * (SLICES + 1) + slice, b = a + SLICES + 1;
      indices.push(a, a + 1, b, a + 1, b + 1, b);
    }
  }
  return indices;
}

// The hull of balls (x, y, z, radius): its farthest point in each direction.
function hullPoints(balls, directions) {
  const points = [];
  for (const d of directions) {
    let best = null, farthest = -Infinity;
    for (const ball of balls) {
      const far = ball[0] * d[0] + ball[1] * d[1] + ball[2] * d[2] + ball[3];
      if (far > farthest) [farthest, best] = [far, ball];
    }
    points.push(best[0] + best[3] * d[0], best[1] + best[3] * d[1], best[2] + best[3] * d[2], ...d);
  }
  return points;
}

// A thin slab below four corners: the triangles of its faces, and the lines of its edges.
function slabPoints(top) {
  const [u, v] = [1, 3].map((i) => top[i].map((x, k) => x - top[0][k]));
  const up = unit(cross(u, v)), down = up.map((x) => -x);
  const bottom = top.map((corner) => corner.map((x, k) => x + SLAB_THICKNESS * down[k]));
  const faces = [], edges = [];
  const addFace = (a, b, c, d, normal) => {
    for (const corner of [a, b, c, a, c, d]) faces.push(...corner, ...normal);
  };
  addFace(...top, up);
  addFace(...bottom, down);
  top.forEach((a, i) => {
    const j = (i + 1) % 4, outwards = unit(cross(top[j].map((x, k) => x - a[k]), down));
    addFace(a, top[j], bottom[j], bottom[i], outwards);
    for (const corner of [a, top[j], bottom[i], bottom[j], a, bottom[i]]) edges.push(...corner, 0, 1, 0);
  });
  return { faces, edges };
}

// A box whose edges have length 1, about the origin: the triangles of its faces, and the lines of its edges.
function boxPoints() {
  const faces = [], edges = [], signs = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]];
  for (let axis = 0; axis < 3; axis++) {
    const at = (along, [u, v]) => [0, 1, 2].map((k) => k === axis ? along : k === (axis + 1) % 3 ? u : v);
    for (const side of [-0.5, 0.5]) {
      const normal = at(2 * side, [0, 0]), corners = signs.map((sign) => at(side, sign));
      for (const i of [0, 1, 2, 0, 2, 3]) faces.push(...corners[i], ...normal);
    }
    for (const sign of signs) edges.push(...at(-0.5, sign), 0, 1, 0, ...at(0.5, sign), 0, 1, 0);
  }
  return { faces, edges };
}

// The triangles of a solid of forces, a list for every limit: a face has the limit of most of its corners.
function limitPoints({ corners, faces, limits, names }) {
  const lists = names.map(() => []);
  for (const face of faces) {
    const [a, b, c] = face.map((i) => corners[i]), [la, lb, lc] = face.map((i) => limits[i]);
    const normal = unit(cross(b.map((v, k) => v - a[k]), c.map((v, k) => v - a[k])));
    const list = lists[lb === lc ? lb : la];
    if (list) for (const corner of [a, b, c]) list.push(...corner, ...normal);
  }
  return lists;
}

// Lines of a square grid on the ground, about a point.
function gridPoints(middle, height) {
  const [x, z] = [middle[0], middle[2]].map((v) => Math.round(v / GRID_SPACING) * GRID_SPACING);
  const half = GRID_HALF * GRID_SPACING, points = [];
  for (let i = -GRID_HALF; i <= GRID_HALF; i++) {
    const across = z + i * GRID_SPACING, along = x + i * GRID_SPACING;
    points.push(x - half, height, across, 0, 1, 0, x + half, height, across, 0, 1, 0);
    points.push(along, height, z - half, 0, 1, 0, along, height, z + half, 0, 1, 0);
  }
  return points;
}
