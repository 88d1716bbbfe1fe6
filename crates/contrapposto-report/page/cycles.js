// The chart of a joint over the cycles of a motion: mean, and mean less and plus a standard deviation, over the percents of a cycle.

// The numbers of a column.
function cycleNumbers(column, count) {
  let sum = 0;
  return Array.from({ length: count }, (_, i) => (sum += column.by[i] || 0) * column.step);
}

// A colour through which others are seen.
function veil(name) {
  return `rgba(${channels(styleValue(name)).map((part) => Math.round(255 * part)).join(", ")}, 0.22)`;
}

// Traces of a quantity on an axis: the spread first, so that the mean lies over it.
function bandTraces(name, { count, mean, deviation }, axis, color, scale, dash) {
  const middle = cycleNumbers(mean, count), x = middle.map((_, i) => 100 * i / Math.max(1, count - 1));
  const shown = { x, type: "scatter", mode: "lines", yaxis: axis, legendgroup: name };
  const line = { ...shown, name, y: middle.map((value) => scale * value), line: chartLine(color, 2, dash), hovertemplate: "%{y:.2f}", showlegend: axis === "y2" };
  if (!deviation) return [line];
  const spread = cycleNumbers(deviation, count), edge = { ...shown, line: { width: 0 }, hoverinfo: "skip", showlegend: false };
  const side = (sign) => middle.map((value, i) => scale * (value + sign * spread[i]));
  return [{ ...edge, y: side(-1) }, { ...edge, y: side(1), fill: "tonexty", fillcolor: veil(color) }, line];
}

function drawCycle(index) {
  const curves = report.cycles && report.cycles.joints[index], joint = report.joints[index];
  if (!curves) return;
  const tires = Boolean(joint.groups);
  const traces = [
    ...bandTraces("external", curves.external, "y2", "--external", 1),
    ...bandTraces("active", curves.active, "y2", "--active", 1, "dash"),
    ...bandTraces("angle", curves.angle, "y", "--passive", 1),
    ...(tires ? bandTraces("load", curves.load, "y3", "--positive", 100) : []),
  ];
  Plotly.react(find("cycle"), traces, chartLayout(PAPER_HEIGHT_TALL, {
    hovermode: "x unified",
    xaxis: chartAxis("cycle, %", { anchor: tires ? "y3" : "y2", zeroline: false, range: [0, 100] }),
    yaxis: chartAxis(joint.slides ? "place, m" : "angle, °", { domain: tires ? [0.71, 1] : [0.55, 1], zeroline: false }),
    yaxis2: chartAxis(`torque, ${joint.torque}`, { domain: tires ? [0.355, 0.645] : [0, 0.45] }),
    ...(tires && { yaxis3: chartAxis("load, %", { domain: [0, 0.29], rangemode: "tozero", zeroline: false }) }),
  }), CHART_CONFIG);
}
