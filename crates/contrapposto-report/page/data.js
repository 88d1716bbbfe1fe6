"use strict";
// The data of the report: columns of differences become lists of numbers.
const report = (() => {
  const read = JSON.parse(document.getElementById("data").textContent);
  const n = read.frames;
  const list = (column) => {
    if (!column) return null; // not known
    const values = new Float64Array(n);
    let sum = 0;
    for (let i = 0; i < n; i++) {
      sum += column.by[i] || 0;
      values[i] = sum * column.step;
    }
    return values;
  };
  read.times = list(read.times);
  read.center = read.center && read.center.map(list);
  for (const segment of read.segments) {
    segment.places = segment.places.map(list);
    segment.start = segment.start.map((value) => [value]);
  }
  for (const segment of read.skin ? read.skin.segments : []) {
    segment.places = segment.places && segment.places.map(list);
    segment.start = segment.start && segment.start.map((value) => [value]);
  }
  for (const thing of read.things) thing.places = thing.places.map(list);
  for (const push of [...read.supports, ...read.loads]) {
    push.force = push.force.map(list);
    push.at = push.at.map(list);
  }
  for (const target of read.targets) [target.at, target.from] = [target.at.map(list), target.from && target.from.map(list)];
  for (const support of read.supports) support.share = list(support.share);
  for (const joint of read.joints) {
    for (const key of ["angle", "external", "passive", "load"]) joint[key] = list(joint[key]);
    joint.coordinate = list(joint.coordinate);
    joint.active = joint.external.map((external, i) => -(external + joint.passive[i]) || 0);
    joint.unit = joint.slides ? "m" : "°";
    joint.torque = joint.slides ? "N" : "N m";
    joint.hazard = list(joint.hazard);
    for (const group of joint.groups || []) {
      group.fatigue = list(group.fatigue);
      group.left = list(group.left);
    }
  }
  for (const carrier of read.muscles ? read.muscles.carriers : []) {
    carrier.places = carrier.places ? carrier.places.map(list) : read.segments[carrier.part].places;
  }
  for (const muscle of read.muscles ? read.muscles.lines : []) {
    for (const key of ["activation", "tension", "order"]) muscle[key] = list(muscle[key]);
    for (const point of muscle.points) point.at = point.at.map(list);
  }
  const lacks = read.muscles && read.muscles.lacks;
  if (lacks) [lacks.torque, lacks.joint] = [list(lacks.torque), list(lacks.joint)];
  for (const joint of read.muscles ? read.muscles.pressed : []) [joint.force, joint.weights] = [list(joint.force), list(joint.weights)];
  return read;
})();

// What moves the body: muscles, or the motors of a robot.
const MUSCLES = report.motors ? "motors" : "muscles";

// Bands of load, the same in every report: the share of strength from which on each is in force, and its colours at that share and
// at its end. Bounds: 8 and 14 % limit an hour of sustained and of intermittent holding (Björkstén & Jonsson 1977: 7.9 and 14.0 %),
// 50 % the peaks of a load (Jonsson 1978, recalled), 100 % is the strength. Every colour is darker than those before it.
const LOAD_BANDS = [[0, "#e2f5d3", "#bfe39f"], [0.08, "#efcf3a", "#e3b516"], [0.14, "#e8942a", "#cf6a12"],
  [0.5, "#b5301f", "#8c1418"], [1, "#3d0a1e", "#3d0a1e"]];

// Measures that colours show: a share for a segment in a frame, or null where it is not known.
const measures = {
  load: {
    bands: LOAD_BANDS,
    of(segment, frame) {
      const joints = segment.joints.map((j) => report.joints[j]).filter((joint) => joint.groups);
      return joints.length ? Math.max(...joints.map((joint) => joint.load[frame])) : null;
    },
  },
  passive: {
    bands: [[0, "#f2f0e0", "#9ecce0"], [1 / 3, "#9ecce0", "#2e85c2"], [2 / 3, "#2e85c2", "#08306b"]],
    // The part of external torque that passive torque carries; external torques below 0.5 N m count as none.
    of(segment, frame) {
      let pulled = 0, carried = 0;
      for (const joint of segment.joints.map((j) => report.joints[j])) {
        const external = joint.external[frame];
        pulled += Math.abs(external);
        carried += Math.min(Math.abs(external), Math.max(0, -joint.passive[frame] * Math.sign(external)));
      }
      return segment.joints.length ? (pulled > 0.5 ? carried / pulled : 0) : null;
    },
  },
};

// Whether ligaments carry a joint of a segment where that is a hazard.
function inHazard(segment, frame) {
  return segment.joints.some((j) => report.joints[j].hazard && report.joints[j].hazard[frame] > 0.5);
}

// Red, green and blue of a colour like `#rrggbb`, each 0 to 1.
function channels(color) {
  return [1, 3, 5].map((i) => parseInt(color.slice(i, i + 2), 16) / 255);
}

// Colour of a share, red, green and blue, each 0 to 1.
function colorOf({ bands }, share) {
  const k = Math.max(0, bands.findLastIndex(([from]) => from <= share + 1e-9));
  const [from, low, high] = bands[k], to = k + 1 < bands.length ? bands[k + 1][0] : 1;
  const place = to > from ? Math.min(1, Math.max(0, (share - from) / (to - from))) : 0;
  return channels(low).map((c, i) => c + (channels(high)[i] - c) * place);
}
