// The charts of one joint, by plotly.js: torques over the angle, and everything over time. Marks of the present frame lie over the
// charts, so that a step of the slider draws no chart anew.
const LONGEST_LABEL = 48;
const PAPER_WIDTH = 680, PAPER_HEIGHT = 200, PAPER_HEIGHT_TALL = 285; // px; the style sheet has these heights, too
const CHART_CONFIG = {
  displaylogo: false, responsive: true, displayModeBar: false, modeBarButtonsToRemove: ["select2d", "lasso2d", "autoScale2d"],
};

// A name as text of a chart: plotly.js reads a little markup in texts, and long names do not fit.
function chartText(text) {
  const short = text.length > LONGEST_LABEL ? `${text.slice(0, LONGEST_LABEL - 1)}…` : text;
  return short.replace(/&/g, "&amp;").replace(/</g, "&lt;").replace(/>/g, "&gt;");
}

function styleValue(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

function chartLine(color, width, dash) {
  return { color: styleValue(color), width, dash: dash || "solid" };
}

function chartAxis(title, more) {
  const colors = { gridcolor: styleValue("--line"), zerolinecolor: styleValue("--quiet"), linecolor: styleValue("--quiet") };
  return { title: { text: title, standoff: 8 }, ...colors, automargin: true, ...more };
}

// Layout of a chart; `paperHeight` is its height in print, where nothing waits for it to follow the size of the page.
function chartLayout(paperHeight, more) {
  const ink = styleValue("--ink"), onPaper = document.documentElement.hasAttribute("data-paper");
  return {
    ...(onPaper && { width: PAPER_WIDTH, height: paperHeight }),
    font: { family: "system-ui, 'Segoe UI', 'DejaVu Sans', sans-serif", size: 12, color: ink },
    paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)", margin: { l: 58, r: 14, t: 10, b: 44 }, dragmode: false,
    legend: { orientation: "h", x: 0, y: 1.01, yanchor: "bottom", font: { size: 11.5 } },
    hoverlabel: { bgcolor: styleValue("--panel"), bordercolor: styleValue("--line"), font: { color: ink } },
    ...more,
  };
}

// A level line of the fatigue axis, and its label.
function levelLine(y, dash) {
  const line = { color: styleValue("--quiet"), width: 1, dash };
  return { type: "line", xref: "paper", x0: 0, x1: 1, yref: "y3", y0: y, y1: y, line };
}
function levelLabel(y, text) {
  const font = { size: 11, color: styleValue("--quiet") };
  return {
    xref: "paper", x: 1, xanchor: "right", yref: "y3", y, yanchor: "top", text, showarrow: false, font,
    bgcolor: styleValue("--paper"), opacity: 0.8, borderpad: 0,
  };
}

// The unit of a time axis, and its seconds: the one in which the last time is told in words.
function timeUnit(times) {
  const end = times ? times[times.length - 1] : 0;
  return end < 100 ? ["s", 1] : end < 5970 ? ["min", 60] : ["h", 3600];
}

class Charts {
  // `onTime` is called with the time of a click.
  constructor(onTime) {
    const ids = { balance: "balance", marks: "balance-now", course: "course", cursor: "cursor" };
    for (const [name, id] of Object.entries(ids)) this[name] = document.getElementById(id);
    [this.unit, this.unitSeconds] = timeUnit(report.times);
    this.times = report.times && Array.from(report.times, (time) => time / this.unitSeconds);
    [this.joint, this.frame] = [null, 0];
    this.course.addEventListener("click", (event) => {
      const axis = this.course._fullLayout && this.course._fullLayout.xaxis;
      if (!axis) return;
      const time = axis.p2d(event.clientX - this.course.getBoundingClientRect().left - axis._offset);
      if (time >= axis.range[0] && time <= axis.range[1]) onTime(time * this.unitSeconds);
    });
  }

  // Draws the charts of a joint: the second one a moment later when both are new, so that the page answers between them.
  async drawJoint(index, frame) {
    if (!window.Plotly || !report.joints[index]) return;
    const isNew = !this.balance._fullLayout;
    [this.joint, this.frame] = [report.joints[index], frame];
    this.drawBalance();
    this.drawMarks();
    if (isNew) {
      this.balance.on("plotly_afterplot", () => this.drawMarks());
      await new Promise((done) => setTimeout(done));
    }
    if (!this.times || this.times.length < 2) return;
    this.drawCourse();
    this.drawCursor();
    if (isNew) this.course.on("plotly_afterplot", () => this.drawCursor());
    drawCycle(index);
  }

  drawFrame(frame) {
    if (!this.joint) return;
    this.frame = frame;
    if (this.joint.balance.length > 1) this.drawBalance();
    this.drawMarks();
    this.drawCursor();
  }

  resize() {
    for (const chart of [this.balance, this.course, document.getElementById("cycle")]) if (chart._fullLayout) Plotly.Plots.resize(chart);
  }

  // Torques over the angle.
  drawBalance() {
    const joint = this.joint, positive = joint.positive ? ` (positive: ${joint.positive})` : "";
    const traces = [...this.activeTraces(), ...this.rangeTraces()];
    for (const trace of traces) Object.assign(trace, { type: "scatter", mode: trace.mode || "lines" });
    Plotly.react(this.balance, traces, chartLayout(PAPER_HEIGHT, {
      xaxis: chartAxis(chartText(`${joint.slides ? "place, m" : "angle, °"}${positive}`), { zeroline: false }),
      yaxis: chartAxis(`torque, ${joint.torque}`),
    }), CHART_CONFIG);
  }

  // Active torque where the body is: its path over time, or in every posture the span between the torque against the ligaments and that of weight and contact.
  activeTraces() {
    const joint = this.joint, angles = Array.from(joint.angle), line = chartLine("--path", 7);
    if (this.times) return [{ name: `${MUSCLES}, in this run`, x: angles, y: joint.active, line, hoverinfo: "skip" }];
    const x = angles.flatMap((angle) => [angle, angle, null]);
    const y = angles.flatMap((_, i) => [-joint.passive[i], joint.external[i], null]);
    const marker = { size: 9, color: styleValue("--active") }, hovertemplate = this.hover(MUSCLES);
    return [
      { name: `${MUSCLES} hold`, x, y, line, hoverinfo: "skip" },
      { name: MUSCLES, x: angles, y: joint.active, mode: "markers", marker, hovertemplate },
    ];
  }

  // Torques over the range of the joint: over time those at the end, with several postures those of the present one.
  rangeTraces() {
    const joint = this.joint, none = { angle: [], minus_passive: [], external: [] };
    const { angle, minus_passive, external } = joint.balance[Math.min(this.frame, joint.balance.length - 1)] || none;
    const swept = external.length > 0, traces = [{
      name: "weight and contact", x: swept ? angle : Array.from(joint.angle), y: swept ? external : Array.from(joint.external),
      mode: swept || this.times ? "lines" : "markers", marker: { size: 9, color: styleValue("--external") },
      line: chartLine("--external", 2.2), hovertemplate: this.hover("weight and contact"),
    }];
    if (angle.length) {
      const line = chartLine("--passive", 2.2), hovertemplate = this.hover("what ligaments carry");
      traces.push({ name: "what ligaments carry", x: angle, y: minus_passive, line, hovertemplate });
    }
    if (swept) {
      const y = external.map((torque, i) => minus_passive[i] - torque), line = chartLine("--active", 1.8, "dash");
      traces.push({ name: MUSCLES, x: angle, y, line, hovertemplate: this.hover(MUSCLES) });
    }
    return traces;
  }

  hover(name) {
    return `${name} %{y:.2f} ${this.joint.torque} at %{x:.1f} ${this.joint.unit}<extra></extra>`;
  }

  // Angle, torques and fatigue over time.
  drawCourse() {
    const joint = this.joint, tires = (joint.groups || []).some((group) => group.fatigue);
    const levels = tires && report.levels ? report.levels.map((share) => 100 * share) : [];
    Plotly.react(this.course, this.courseTraces(tires), chartLayout(PAPER_HEIGHT_TALL, {
      hovermode: "x unified",
      shapes: levels.map((y, i) => levelLine(y, i ? "dot" : "dash")),
      annotations: levels.map((y, i) => levelLabel(y, i ? "relief ends" : "relief begins")),
      xaxis: chartAxis(`time, ${this.unit}`, { anchor: tires ? "y3" : "y2", zeroline: false }),
      yaxis: chartAxis(joint.slides ? "place, m" : "angle, °", { domain: tires ? [0.71, 1] : [0.55, 1], zeroline: false }),
      yaxis2: chartAxis(`torque, ${joint.torque}`, { domain: tires ? [0.355, 0.645] : [0, 0.45] }),
      ...(tires && { yaxis3: chartAxis("fatigue, %", { domain: [0, 0.29], range: [0, 105], zeroline: false }) }),
    }), CHART_CONFIG);
  }

  courseTraces(tires) {
    const joint = this.joint, traces = [
      { name: "weight and contact", y: Array.from(joint.external), yaxis: "y2", line: chartLine("--external", 2) },
      { name: "ligaments", y: Array.from(joint.passive), yaxis: "y2", line: chartLine("--passive", 2) },
      { name: MUSCLES, y: joint.active, yaxis: "y2", line: chartLine("--active", 2, "dash") },
      { name: "angle", y: Array.from(joint.angle), line: chartLine("--active", 2), showlegend: false },
    ];
    for (const [side, group] of (tires ? joint.groups : []).entries()) {
      const line = chartLine(side ? "--negative" : "--positive", 2, side ? "dashdot" : "solid");
      traces.push({ name: chartText(group.label), ...this.fatigueCourse(group), yaxis: "y3", line });
    }
    for (const trace of traces) Object.assign(trace, { x: trace.x || this.times, type: "scatter", mode: "lines", hovertemplate: "%{y:.2f}" });
    return traces;
  }

  // Fatigue over time, %, with the moment at which it becomes whole.
  fatigueCourse({ fatigue, fails: seconds }) {
    const fails = seconds === null ? null : seconds / this.unitSeconds;
    const [x, y] = [[...this.times], Array.from(fatigue, (share) => 100 * share)];
    const after = fails === null ? -1 : x.findIndex((time) => time > fails);
    if (after > 0 && x[after - 1] < fails) {
      x.splice(after, 0, fails);
      y.splice(after, 0, 100);
    }
    return { x, y };
  }

  // The torques of the present frame, and the span that muscles hold.
  drawMarks() {
    const { xaxis, yaxis } = this.balance._fullLayout || {};
    if (!xaxis || !yaxis || !this.joint) return;
    const { angle, external, passive, active } = this.joint, frame = this.frame;
    const cx = xaxis._offset + xaxis.l2p(angle[frame]);
    const [y1, y2, y3] = [external[frame], -passive[frame], active[frame]].map((torque) => yaxis._offset + yaxis.l2p(torque));
    const shape = (kind, attributes) => {
      const made = document.createElementNS(this.marks.namespaceURI, kind);
      for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
      return made;
    };
    const point = (cy, r, color) => shape("circle", { cx, cy, r, style: `fill: var(${color})` });
    this.marks.replaceChildren(shape("line", { x1: cx, x2: cx, y1, y2 }),
      point(y1, 5, "--external"), point(y2, 5, "--passive"), point(y3, 6, "--active"));
  }

  // The present time in the course.
  drawCursor() {
    const { xaxis, _size: size } = this.course._fullLayout || {};
    if (!xaxis || !this.times) return;
    const left = xaxis._offset + xaxis.l2p(this.times[this.frame]);
    this.cursor.style.cssText = `left: ${left}px; top: ${size.t}px; height: ${size.h}px`;
  }
}
