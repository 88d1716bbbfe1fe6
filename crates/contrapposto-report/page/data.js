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
  for (const thing of read.things) thing.places = thing.places.map(list);
  for (const push of [...read.supports, ...read.loads]) {
    push.force = push.force.map(list);
    push.at = push.at.map(list);
  }
  for (const support of read.supports) support.share = list(support.share);
  for (const joint of read.joints) {
    for (const key of ["angle", "external", "passive", "load"]) joint[key] = list(joint[key]);
    joint.active = joint.external.map((external, i) => -(external + joint.passive[i]) || 0);
    joint.unit = joint.slides ? "m" : "°";
    joint.torque = joint.slides ? "N" : "N m";
    for (const group of joint.groups || []) {
      group.fatigue = list(group.fatigue);
      group.left = list(group.left);
    }
  }
  return read;
})();

// Measures that colours show: a share, 0 to 1, for a segment in a frame, or null where it is not known.
const measures = {
  load: {
    colors: [[0.98, 0.93, 0.76], [0.98, 0.72, 0.34], [0.86, 0.36, 0.13], [0.52, 0.08, 0.12]],
    of(segment, frame) {
      const joints = segment.joints.map((j) => report.joints[j]).filter((joint) => joint.groups);
      return joints.length ? Math.max(...joints.map((joint) => joint.load[frame])) : null;
    },
  },
  passive: {
    colors: [[0.95, 0.94, 0.88], [0.62, 0.80, 0.88], [0.18, 0.52, 0.76], [0.03, 0.19, 0.42]],
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
{
  // The scale of loads ends at the next round number above the largest.
  let largest = 0;
  for (const joint of report.joints) if (joint.groups) for (const load of joint.load) largest = Math.max(largest, load);
  measures.load.largest = [0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.4, 0.5, 0.75, 1].find((top) => largest <= top) || 1;
  measures.passive.largest = 1;
}

// Colour of a share, red, green and blue, each 0 to 1.
function colorOf(measure, share) {
  const place = Math.min(1, Math.max(0, share / measure.largest)) * (measure.colors.length - 1);
  const below = Math.min(Math.floor(place), measure.colors.length - 2);
  return measure.colors[below].map((c, k) => c + (measure.colors[below + 1][k] - c) * (place - below));
}
