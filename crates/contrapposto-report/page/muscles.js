// Muscles as tubes along their lines, coloured by activation; and the muscle under a place of the picture.
const TUBE_SIDES = 7, REACH = 7, AT_REST = 0.01; // corners round a tube; px; activation

// One mesh of all tubes: a ring of corners round every point of every line, filled anew for every frame.
class MuscleTubes {
  constructor({ carriers, lines }, painter) {
    // A gap is two rings without size, at the end before it and at the beginning behind it.
    const withGaps = (orders) => orders.map((order) => order.flatMap((k) => k < 0 ? [-1, -1] : [k]));
    lines = lines.map((line) => ({ ...line, orders: withGaps(line.orders) }));
    [this.carriers, this.lines, this.painter] = [carriers, lines, painter];
    const drawn = carriers.filter(({ part }) => part !== null).map(({ part }) => report.segments[part].name);
    this.segments = new Set(drawn);
    this.longest = lines.map(({ orders }) => Math.max(0, ...orders.map((order) => order.length)));
    const rings = this.longest.reduce((sum, length) => sum + length, 0), count = rings * TUBE_SIDES;
    [this.points, this.paint] = [new Float32Array(6 * count), new Float32Array(3 * count)];
    // Corners are counted by 16 bits: so many rings at most share a mesh.
    this.parts = this.meshes(Math.floor(65535 / TUBE_SIDES));
    this.middles = lines.map(() => []);
  }

  // Meshes of as many whole muscles each as `most` rings have room for.
  meshes(most) {
    const parts = [];
    let part = { from: 0, rings: 0, triangles: [] }, before = 0;
    const close = () => {
      if (part.rings) parts.push({ ...part, mesh: this.painter.paintedMesh(new Uint16Array(part.triangles), part.rings * TUBE_SIDES) });
      before += part.rings;
      part = { from: before, rings: 0, triangles: [] };
    };
    for (const length of this.longest) {
      if (part.rings + length > most) close();
      for (let ring = part.rings; ring < part.rings + length - 1; ring++) part.triangles.push(...tubeTriangles(ring * TUBE_SIDES));
      part.rings += length;
    }
    close();
    return parts;
  }

  // Brings the tubes to a frame; `colored`: by activation, else all in the colour of rest.
  fill(frame, colored, chosen) {
    const places = this.carriers.map(({ places }) => placement(places, frame));
    const rest = styleColor("--muscle"), mark = styleColor("--mark");
    let ring = 0;
    this.lines.forEach((line, m) => {
      const order = line.orders[line.order[frame]] || [], length = this.longest[m];
      const at = order.map((k) => k < 0 ? null : carried(places[line.points[k].carrier], line.points[k].at, frame));
      this.middles[m] = at;
      const share = line.activation[frame], color = m === chosen ? mark : colored && share >= AT_REST ? colorOf(measures.load, share) : rest;
      for (let k = 0; k < length; k++, ring++) this.fillRing(ring, at, k, line.radius, color);
    });
    for (const { mesh, from, rings } of this.parts) {
      const [begin, end] = [from * TUBE_SIDES, (from + rings) * TUBE_SIDES];
      this.painter.fillPoints(mesh, this.points.subarray(6 * begin, 6 * end));
      this.painter.fillPaint(mesh, this.paint.subarray(3 * begin, 3 * end));
    }
  }

  // A ring round point `k`, across the mean of the directions on both sides; a point beyond the end, and a gap, have a ring without size.
  fillRing(ring, at, k, radius, color) {
    const known = (i) => i >= 0 && i < at.length && at[i];
    const here = known(k) || known(k - 1) || known(k + 1) || known(at.length - 1) || [0, 0, 0];
    const way = [0, 0, 0];
    for (const [from, to] of [[known(k - 1), known(k)], [known(k), known(k + 1)]]) {
      if (from && to) unit(to.map((v, i) => v - from[i])).forEach((v, i) => { way[i] += v || 0; });
    }
    const drawn = known(k) && way.some((v) => v);
    const y = drawn ? unit(way) : [0, 1, 0], x = unit(cross(Math.abs(y[0]) < 0.9 ? [1, 0, 0] : [0, 0, 1], y)), z = cross(x, y);
    for (let side = 0; side < TUBE_SIDES; side++) {
      const angle = 2 * Math.PI * side / TUBE_SIDES, [c, s] = [Math.cos(angle), Math.sin(angle)];
      const corner = ring * TUBE_SIDES + side;
      for (let i = 0; i < 3; i++) {
        const out = c * x[i] + s * z[i];
        this.points[6 * corner + i] = here[i] + (drawn ? radius * out : 0);
        this.points[6 * corner + 3 + i] = out;
        this.paint[3 * corner + i] = color[i];
      }
    }
  }

  draw() {
    for (const { mesh } of this.parts) this.painter.painted(mesh, [1, 1, 1], 1);
  }

  // Index of the muscle whose line in the last frame passes nearest to a place of the picture, px; -1 for none within reach.
  nearest(x, y, matrix, width, height) {
    let [best, least] = [-1, REACH];
    const seen = (p) => {
      const [a, b, , w] = [0, 1, 2, 3].map((i) => matrix[i] * p[0] + matrix[4 + i] * p[1] + matrix[8 + i] * p[2] + matrix[12 + i]);
      return w > 0 && [(1 + a / w) * width / 2, (1 - b / w) * height / 2];
    };
    this.middles.forEach((at, m) => {
      for (let k = 1; k < at.length; k++) {
        const [from, to] = [at[k - 1] && seen(at[k - 1]), at[k] && seen(at[k])];
        const far = from && to ? fromLine(x, y, from, to) : Infinity;
        if (far < least) [best, least] = [m, far];
      }
    });
    return best;
  }
}

// Triangles between a ring and the next one.
function tubeTriangles(first) {
  return Array.from({ length: TUBE_SIDES }, (_, side) => {
    const next = (side + 1) % TUBE_SIDES, [a, b, c, d] = [first + side, first + next, first + TUBE_SIDES + side, first + TUBE_SIDES + next];
    return [a, c, b, b, c, d];
  }).flat();
}

// A point fixed in a frame, in ground.
function carried(m, at, frame) {
  const [x, y, z] = at.map((column) => column[frame]);
  return [0, 1, 2].map((i) => m[i] * x + m[4 + i] * y + m[8 + i] * z + m[12 + i]);
}

// Distance of a place from the line between two places of the picture.
function fromLine(x, y, [ax, ay], [bx, by]) {
  const [dx, dy] = [bx - ax, by - ay], square = dx * dx + dy * dy;
  const share = square ? Math.min(1, Math.max(0, ((x - ax) * dx + (y - ay) * dy) / square)) : 0;
  return Math.hypot(x - ax - share * dx, y - ay - share * dy);
}
