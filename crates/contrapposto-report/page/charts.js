// The charts of one joint, by plotly.js: torques over the angle, and everything over time. What moves with the present moment is
// laid over them, so that a step of the slider draws no chart anew.
function Charts(onTime) {
  const [balance, now, course, cursor] = ["balance", "balance-now", "course", "cursor"].map((id) => document.getElementById(id));
  // plotly.js reads a little markup in texts; names are no markup, and long ones do not fit.
  const plain = (text) => (text.length > 48 ? `${text.slice(0, 47)}…` : text).replace(/&/g, "&amp;").replace(/</g, "&lt;").replace(/>/g, "&gt;");
  const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const config = { displaylogo: false, responsive: true, modeBarButtonsToRemove: ["select2d", "lasso2d", "autoScale2d"], displayModeBar: false };
  const line = (color, width, dash) => ({ color: css(color), width, dash: dash || "solid" });
  const times = report.times && Array.from(report.times);
  const list = (values) => Array.from(values);
  const axis = (title, more) => Object.assign({
    title: { text: title, standoff: 8 }, gridcolor: css("--line"), zerolinecolor: css("--quiet"), linecolor: css("--quiet"), automargin: true,
  }, more);
  const layout = (more) => Object.assign({
    font: { family: "system-ui, 'Segoe UI', 'DejaVu Sans', sans-serif", size: 12, color: css("--ink") },
    paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)", margin: { l: 58, r: 14, t: 10, b: 44 }, dragmode: false,
    legend: { orientation: "h", x: 0, y: 1.01, yanchor: "bottom", font: { size: 11.5 } },
    hoverlabel: { bgcolor: css("--panel"), bordercolor: css("--line"), font: { color: css("--ink") } },
  }, more);
  let joint = null, present = 0;

  // Its torques over the range: in a run those of its end, of several postures each has its own.
  const curves = () => joint.balance[Math.min(present, joint.balance.length - 1)] || { angle: [], minus_passive: [], external: [] };

  function drawBalance() {
    const { angle, minus_passive, external } = curves();
    const swept = external.length > 0;
    const torque = ` %{y:.2f} ${joint.torque} at %{x:.1f} ${joint.unit}<extra></extra>`;
    const traces = [];
    if (times) traces.push({ name: "active, this run", x: list(joint.angle), y: joint.active, line: line("--path", 7), hoverinfo: "skip" });
    else {
      // From minus passive to external torque: what muscles hold in every posture.
      const held = { x: [], y: [] };
      joint.angle.forEach((a, i) => {
        held.x.push(a, a, null);
        held.y.push(-joint.passive[i], joint.external[i], null);
      });
      traces.push({ name: "muscles hold", ...held, line: line("--path", 7), hoverinfo: "skip" });
      traces.push({ name: "active", x: list(joint.angle), y: joint.active, mode: "markers", marker: { size: 9, color: css("--active") }, hovertemplate: "active" + torque });
    }
    traces.push({ name: "external", x: swept ? angle : list(joint.angle), y: swept ? external : list(joint.external),
      mode: swept || times ? "lines" : "markers", marker: { size: 9, color: css("--external") }, line: line("--external", 2.2), hovertemplate: "external" + torque });
    if (angle.length) traces.push({ name: "minus passive", x: angle, y: minus_passive, line: line("--passive", 2.2), hovertemplate: "minus passive" + torque });
    if (swept) traces.push({ name: "active", x: angle, y: external.map((e, i) => minus_passive[i] - e), line: line("--active", 1.8, "dash"), hovertemplate: "active" + torque });
    for (const trace of traces) Object.assign(trace, { type: "scatter", mode: trace.mode || "lines" });
    const positive = joint.positive ? ` (positive: ${joint.positive})` : "";
    Plotly.react(balance, traces, layout({
      xaxis: axis(plain(`${joint.slides ? "place, m" : "angle, °"}${positive}`), { zeroline: false }),
      yaxis: axis(`torque, ${joint.torque}`),
    }), config);
  }

  function drawCourse() {
    const traces = [
      { name: "external", y: list(joint.external), yaxis: "y2", line: line("--external", 2) },
      { name: "passive", y: list(joint.passive), yaxis: "y2", line: line("--passive", 2) },
      { name: "active", y: joint.active, yaxis: "y2", line: line("--active", 2, "dash") },
      { name: "angle", y: list(joint.angle), line: line("--active", 2), showlegend: false },
    ];
    const tires = (joint.groups || []).some((group) => group.fatigue);
    if (tires) joint.groups.forEach((group, side) => traces.push({
      name: plain(group.label), y: list(group.fatigue.map((f) => 100 * f)), yaxis: "y3",
      line: line(side ? "--negative" : "--positive", 2, side ? "dashdot" : "solid"),
    }));
    for (const trace of traces) {
      Object.assign(trace, { type: "scatter", mode: "lines", x: times, hovertemplate: "%{y:.2f}" });
    }
    const level = (y, dash) => ({ type: "line", xref: "paper", x0: 0, x1: 1, yref: "y3", y0: y, y1: y, line: { color: css("--quiet"), width: 1, dash } });
    const word = (y, text, yanchor) => ({ xref: "paper", x: 1, xanchor: "right", yref: "y3", y, yanchor, text, showarrow: false, font: { size: 11, color: css("--quiet") }, bgcolor: css("--paper"), opacity: 0.8, borderpad: 0 });
    const told = tires && report.levels ? report.levels.map((share) => 100 * share) : [];
    Plotly.react(course, traces, layout({
      hovermode: "x unified",
      shapes: told.map((y, i) => level(y, i ? "dot" : "dash")),
      annotations: told.map((y, i) => word(y, i ? "relief ends" : "relief begins", "top")),
      xaxis: axis("time, s", { anchor: tires ? "y3" : "y2", zeroline: false }),
      yaxis: axis(joint.slides ? "place, m" : "angle, °", { domain: tires ? [0.71, 1] : [0.55, 1], zeroline: false }),
      yaxis2: axis(`torque, ${joint.torque}`, { domain: tires ? [0.355, 0.645] : [0, 0.45] }),
      ...(tires && { yaxis3: axis("fatigue, %", { domain: [0, 0.29], range: [0, 105], zeroline: false }) }),
    }), config);
  }

  // The present point, and what muscles hold between two of its torques.
  function drawNow() {
    const { xaxis: x, yaxis: y } = balance._fullLayout || {};
    if (!x || !joint) return;
    const across = x._offset + x.l2p(joint.angle[present]), at = (torque) => y._offset + y.l2p(torque);
    const [external, passive, active] = [joint.external[present], -joint.passive[present], joint.active[present]].map(at);
    const shape = (kind, numbers) => {
      const made = document.createElementNS(now.namespaceURI, kind);
      for (const [name, value] of Object.entries(numbers)) made.setAttribute(name, value);
      return made;
    };
    const point = (cy, r, color) => shape("circle", { cx: across, cy, r, style: `fill: var(${color})` });
    now.replaceChildren(shape("line", { x1: across, x2: across, y1: external, y2: passive }),
      point(external, 5, "--external"), point(passive, 5, "--passive"), point(active, 6, "--active"));
  }
  function drawCursor() {
    const { xaxis: x, _size: size } = course._fullLayout || {};
    if (!x || !times) return;
    cursor.style.cssText = `left: ${x._offset + x.l2p(times[present])}px; top: ${size.t}px; height: ${size.h}px`;
  }

  // A joint: one chart, and the other a moment later, so that the page answers between them.
  async function drawJoint(place, frame) {
    if (!window.Plotly || !report.joints[place]) return;
    const again = balance._fullLayout;
    [joint, present] = [report.joints[place], frame];
    drawBalance();
    drawNow();
    if (!again) {
      balance.on("plotly_afterplot", drawNow);
      await new Promise((done) => setTimeout(done));
    }
    if (!times || times.length < 2) return;
    drawCourse();
    drawCursor();
    if (!again) course.on("plotly_afterplot", drawCursor);
  }

  // A moment.
  function drawFrame(frame) {
    if (!joint) return;
    present = frame;
    if (joint.balance.length > 1) drawBalance();
    drawNow();
    drawCursor();
  }

  // A click anywhere on the course goes to its moment.
  course.addEventListener("click", (event) => {
    const x = course._fullLayout && course._fullLayout.xaxis;
    if (!x) return;
    const time = x.p2d(event.clientX - course.getBoundingClientRect().left - x._offset);
    if (time >= x.range[0] && time <= x.range[1]) onTime(time);
  });

  return { drawJoint, drawFrame, resize: () => [balance, course].forEach((chart) => chart._fullLayout && Plotly.Plots.resize(chart)) };
}
