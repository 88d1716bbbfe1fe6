// The skin of the body: vertices that follow the segments by their weights, each coloured as the segments that move it. Bones that turn
// by a part of what a joint turns keep limbs from looking wrung.
const turned = ([a, b, c, d], [w, x, y, z]) => [
  a * w - b * x - c * y - d * z, a * x + b * w + c * z - d * y, a * y - b * z + c * w + d * x, a * z + b * y - c * x + d * w];
const turnedBack = ([w, x, y, z]) => [w, -x, -y, -z];

// A part of a turn, by the shorter way.
function partOfTurn([w, x, y, z], share) {
  const sign = w < 0 ? -1 : 1, sine = Math.hypot(x, y, z);
  if (sine < 1e-9) return [1, 0, 0, 0];
  const half = share * Math.atan2(sine, w * sign), size = sign * Math.sin(half) / sine;
  return [Math.cos(half), x * size, y * size, z * size];
}

// Swing and twist of a turn about an axis, each by its share.
function partOfSwingAndTwist(turn, axis, [swing, twist]) {
  const along = axis[0] * turn[1] + axis[1] * turn[2] + axis[2] * turn[3];
  const size = Math.hypot(turn[0], along);
  const about = size > 1e-9 ? [turn[0], ...axis.map((v) => v * along)].map((v) => v / size) : [1, 0, 0, 0];
  return turned(partOfTurn(turned(turn, turnedBack(about)), swing), partOfTurn(about, twist));
}

function bytesOf(text) {
  return Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
}

// Brightness of vertices: that of most of them, the bare skin, is 1, so that skin has the colours of the key; nothing is brighter.
function brightness(light) {
  const counts = new Uint32Array(256);
  for (const v of light) counts[v]++;
  const skin = counts.indexOf(counts.reduce((a, b) => Math.max(a, b), 0)) || 255;
  return Float32Array.from(light, (v) => Math.min(1, v / skin));
}

class Skin {
  constructor({ low, step, vertices, triangles, bones, weights, light, segments, nodes }, painter) {
    [this.segments, this.nodes, this.painter] = [segments, nodes, painter];
    const places = new Uint16Array(bytesOf(vertices).buffer);
    this.vertices = Float32Array.from(places, (v, i) => low[i % 3] + step * v);
    this.triangles = new Uint16Array(bytesOf(triangles).buffer);
    this.bones = bytesOf(bones);
    this.weights = Float32Array.from(bytesOf(weights), (v) => v / 255);
    this.light = brightness(bytesOf(light));
    for (const segment of segments) if (segment.part !== null) Object.assign(segment, { places: report.segments[segment.part].places, start: report.segments[segment.part].start });
    this.mesh = painter.paintedMesh(this.triangles, this.light.length);
    this.ghost = painter.paintedMesh(this.triangles, this.light.length);
    this.points = new Float32Array(2 * this.vertices.length);
    this.paint = new Float32Array(this.vertices.length).fill(1);
    this.fill(this.ghost, (segment) => segment.start.map((column) => column[0]));
    painter.fillPaint(this.ghost, this.paint);
    [this.frame, this.measure] = [null, null];
  }

  // Columns 0 to 2 of a turn and a shift for every node.
  matrices(placeOf) {
    const places = this.segments.map(placeOf);
    const turns = this.segments.map(({ rest }, s) => turned(places[s].slice(3), turnedBack(rest.slice(3))));
    return this.nodes.map(([from, to, axis, shares]) => {
      const joint = turned(turnedBack(turns[from]), turns[to]);
      const turn = from === to ? turns[to] : turned(turns[from], partOfSwingAndTwist(joint, axis, shares));
      const m = placement([0, 0, 0, ...turn].map((v) => [v]), 0), rest = this.segments[to].rest;
      const shift = [0, 1, 2].map((k) => places[to][k] - m[k] * rest[0] - m[4 + k] * rest[1] - m[8 + k] * rest[2]);
      return [m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10], ...shift];
    });
  }

  // Moves all vertices, and finds their normals anew.
  fill(mesh, placeOf) {
    const { points, vertices, bones, weights, triangles } = this, matrices = this.matrices(placeOf);
    for (let v = 0; v < this.light.length; v++) {
      const x = vertices[3 * v], y = vertices[3 * v + 1], z = vertices[3 * v + 2];
      let a = 0, b = 0, c = 0;
      for (let i = 4 * v; i < 4 * v + 4; i++) {
        const w = weights[i];
        if (!w) continue;
        const m = matrices[bones[i]];
        a += w * (m[0] * x + m[3] * y + m[6] * z + m[9]);
        b += w * (m[1] * x + m[4] * y + m[7] * z + m[10]);
        c += w * (m[2] * x + m[5] * y + m[8] * z + m[11]);
      }
      points.set([a, b, c, 0, 0, 0], 6 * v);
    }
    for (let t = 0; t < triangles.length; t += 3) {
      const i = 6 * triangles[t], j = 6 * triangles[t + 1], k = 6 * triangles[t + 2];
      const [ux, uy, uz] = [points[j] - points[i], points[j + 1] - points[i + 1], points[j + 2] - points[i + 2]];
      const [vx, vy, vz] = [points[k] - points[i], points[k + 1] - points[i + 1], points[k + 2] - points[i + 2]];
      const [nx, ny, nz] = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
      for (const corner of [i, j, k]) {
        points[corner + 3] += nx;
        points[corner + 4] += ny;
        points[corner + 5] += nz;
      }
    }
    for (let v = 0; v < this.light.length; v++) {
      const n = 6 * v + 3, size = 1 / (Math.hypot(points[n], points[n + 1], points[n + 2]) || 1);
      for (let k = n; k < n + 3; k++) points[k] *= size;
    }
    this.painter.fillPoints(mesh, points);
  }

  // A colour for every segment, given over to vertices by their weights.
  fillPaint(colorOfSegment) {
    const colors = this.segments.map(colorOfSegment), { bones, weights, light, paint, nodes } = this;
    for (let v = 0; v < light.length; v++) {
      let r = 0, g = 0, b = 0;
      for (let i = 4 * v; i < 4 * v + 4; i++) {
        const w = weights[i];
        if (!w) continue;
        const color = colors[nodes[bones[i]][1]];
        r += w * color[0];
        g += w * color[1];
        b += w * color[2];
      }
      paint[3 * v] = r * light[v];
      paint[3 * v + 1] = g * light[v];
      paint[3 * v + 2] = b * light[v];
    }
    this.painter.fillPaint(this.mesh, paint);
  }

  draw(frame, measure, colorOfSegment) {
    if (this.frame !== frame) this.fill(this.mesh, (segment) => segment.places.map((column) => column[frame]));
    if (this.frame !== frame || this.measure !== measure) this.fillPaint(colorOfSegment);
    [this.frame, this.measure] = [frame, measure];
    this.painter.painted(this.mesh, [1, 1, 1], 1);
  }
}
