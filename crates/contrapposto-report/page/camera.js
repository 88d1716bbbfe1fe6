// Placements and the camera, as matrices of four columns. Ground axes: y up.
const FIELD_OF_VIEW = 0.45, FARTHEST_THING = 0.5; // rad; m
// Yaw and pitch of the camera, rad: yaw 0 is from the front, a quarter turn from the body's right.
const VIEWS = { front: [0, 0.06], side: [Math.PI / 2, 0.06], between: [0.45, 0.14] };
// Yaw that shows the side of a joint in hazard, and the back of one in the middle of the body, rad.
const BESIDE = 1.1, BEHIND = 2.1, OFF_MIDDLE = 0.05; // the last one m
const IDENTITY = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

// Place of a segment in a frame; `places` holds x, y, z and the quaternion w, x, y, z, each over all frames.
function placement(places, frame) {
  const [x, y, z, w, a, b, c] = places.map((column) => column[frame]);
  const s = 2 / (w * w + a * a + b * b + c * c || 1);
  return [
    1 - s * (b * b + c * c), s * (a * b + c * w), s * (a * c - b * w), 0,
    s * (a * b - c * w), 1 - s * (a * a + c * c), s * (b * c + a * w), 0,
    s * (a * c + b * w), s * (b * c - a * w), 1 - s * (a * a + b * b), 0, x, y, z, 1];
}

// Takes the y axis to the direction `along` at `from`: scaled by `stretch` along it and by `thickness` across it.
function pointing(from, along, thickness, stretch) {
  const y = unit(along), x = unit(cross(Math.abs(y[0]) < 0.9 ? [1, 0, 0] : [0, 0, 1], y)), z = cross(x, y);
  return [...x.map((v) => v * thickness), 0, ...y.map((v) => v * stretch), 0, ...z.map((v) => v * thickness), 0, ...from, 1];
}

// A ball of radius 1 at a point, scaled to `size`, and to `height` along the vertical.
function scaledAt(point, size, height) {
  return [size, 0, 0, 0, 0, height, 0, 0, 0, 0, size, 0, ...point, 1];
}

// A matrix that first scales along its own axes.
function stretched(matrix, size) {
  return matrix.map((v, i) => i < 12 ? v * (size[i >> 2]) : v);
}

// Yaw and pitch from which the joint that the answer is about faces the camera: a joint in hazard in the frame from its own side, one of the
// back from behind; else the joint that is shown first from its own side.
function startView(frame) {
  const joint = report.joints.findIndex((joint) => joint.hazard && joint.hazard[frame] > 0);
  const segment = report.segments.find((segment) => segment.joints.includes(joint < 0 ? report.main : joint));
  if (!segment) return VIEWS.between;
  const label = report.joints[joint < 0 ? report.main : joint].label, middles = report.segments.map(({ places }) => places[2][frame]);
  const across = segment.places[2][frame] - (Math.min(...middles) + Math.max(...middles)) / 2;
  const named = /^left(?![a-z])/.test(label) ? -1 : /^right(?![a-z])/.test(label) ? 1 : 0;
  const side = named || (Math.abs(across) > OFF_MIDDLE ? Math.sign(across) : 0), [yaw, pitch] = VIEWS.between;
  if (joint < 0) return [(side || 1) * yaw, pitch];
  return [side ? side * BESIDE : BEHIND, pitch];
}

// Bounds of the segments in some frames and at the start, of the surfaces, the targets and the things: of the last two at most
// FARTHEST_THING beyond the rest, so that neither a wall nor a target out of reach makes the body small.
function sceneBounds() {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  const include = (k, from, to) => {
    low[k] = Math.min(low[k], from);
    high[k] = Math.max(high[k], to);
  };
  const includeBall = (m, [x, y, z, r]) => {
    for (let k = 0; k < 3; k++) {
      const c = m[k] * x + m[4 + k] * y + m[8 + k] * z + m[12 + k];
      include(k, c - r, c + r);
    }
  };
  const frames = Array.from({ length: 12 }, (_, i) => Math.round(i / 11 * (report.frames - 1)));
  for (const segment of report.segments) {
    const places = [placement(segment.start, 0), ...frames.map((frame) => placement(segment.places, frame))];
    for (const place of places) for (const ball of segment.balls) includeBall(place, ball);
  }
  for (const corner of report.surfaces.flatMap(({ corners }) => corners)) corner.forEach((c, k) => include(k, c, c));
  for (const corner of report.solid ? report.solid.corners : []) corner.forEach((c, k) => include(k, c, c));
  const [lowest, highest] = [low.map((v) => v - FARTHEST_THING), high.map((v) => v + FARTHEST_THING)];
  const within = (k, v) => Math.min(highest[k], Math.max(lowest[k], v));
  for (const { at } of report.targets) {
    for (const frame of frames) at.forEach((column, k) => include(k, within(k, column[frame]), within(k, column[frame])));
  }
  for (const thing of report.things) {
    for (const frame of [0, frames.at(-1)]) {
      const m = stretched(placement(thing.places, frame), thing.size);
      for (let k = 0; k < 3; k++) {
        const half = (Math.abs(m[k]) + Math.abs(m[4 + k]) + Math.abs(m[8 + k])) / 2;
        include(k, within(k, m[12 + k] - half), within(k, m[12 + k] + half));
      }
    }
  }
  return { low, high };
}

// The camera looks at the middle of the bounds, from a distance at which all of them are in the picture.
class Camera {
  constructor({ low, high }) {
    this.middle = low.map((v, k) => (v + high[k]) / 2 || 0);
    this.height = Math.max(0.3, high[1] - low[1]) || 1;
    this.width = Math.max(0.2, Math.hypot(high[0] - low[0], high[2] - low[2])) || 1;
    [this.yaw, this.pitch] = VIEWS.between;
    [this.zoom, this.pan] = [1, [0, 0]]; // the pan to the right and up, m
  }

  turn(yaw, pitch) {
    this.yaw += yaw;
    this.pitch = Math.min(1.5, Math.max(-0.4, this.pitch + pitch));
  }

  // Magnifies about a place of the picture, in half heights from its middle, so that this place stays where it is: a head under the
  // pointer does not leave the picture. What is not magnified is in the middle.
  magnify(factor, [x, y] = [0, 0], aspect = 1) {
    const before = this.halfHeight(aspect);
    this.zoom = Math.min(6, Math.max(0.4, this.zoom * factor));
    const change = before - this.halfHeight(aspect);
    this.pan = this.zoom > 1 ? [this.pan[0] + x * change, this.pan[1] + y * change] : [0, 0];
  }

  distance(aspect) {
    const fit = Math.max(this.height / 1.75, this.width / (1.85 * aspect));
    return fit / Math.tan(FIELD_OF_VIEW / 2) / this.zoom + this.width / 3;
  }

  // Half the height of the picture at the middle of the scene, m.
  halfHeight(aspect) {
    return this.distance(aspect) * Math.tan(FIELD_OF_VIEW / 2);
  }

  lookFrom(view) {
    [this.yaw, this.pitch] = VIEWS[view];
    [this.zoom, this.pan] = [1, [0, 0]];
  }

  // Unit vectors of the picture in ground axes: right, up, and back towards the camera.
  axes() {
    const [sy, cy, sp, cp] = [Math.sin(this.yaw), Math.cos(this.yaw), Math.sin(this.pitch), Math.cos(this.pitch)];
    return { right: [sy, 0, -cy], up: [-sp * cy, cp, -sp * sy], back: [cp * cy, sp, cp * sy] };
  }

  // The matrix from ground to clip coordinates.
  projection(aspect) {
    const { right, up, back } = this.axes();
    const spread = Math.tan(FIELD_OF_VIEW / 2), f = 1 / spread;
    const distance = this.distance(aspect);
    const nearest = 0.05, farthest = distance + 20, depth = nearest - farthest;
    const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    const [across, above] = this.pan;
    const shift = [-dot(right, this.middle) - across, -dot(up, this.middle) - above, -dot(back, this.middle) - distance];
    const matrix = [];
    for (let k = 0; k < 4; k++) {
      const [x, y, z] = k < 3 ? [right, up, back].map((axis) => axis[k]) : shift;
      const clip = (nearest + farthest) / depth * z + (k < 3 ? 0 : 2 * nearest * farthest / depth);
      matrix.push(f / aspect * x, f * y, clip, -z);
    }
    return matrix;
  }

  // Direction towards the light, above the left shoulder of the viewer.
  light() {
    const { right, up, back } = this.axes();
    return unit([0, 1, 2].map((k) => 0.55 * back[k] + 0.7 * up[k] - 0.45 * right[k]));
  }
}
