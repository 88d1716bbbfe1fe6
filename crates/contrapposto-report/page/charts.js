// The charts of one joint, by plotly.js: torques over the angle, and everything over time.
function Charts(balance, course, onTime) {
  // plotly.js reads a little markup in texts; names are no markup, and long ones do not fit.
  const plain = (text) => (text.length > 48 ? `${text.slice(0, 47)}…` : text).replace(/&/g, "&amp;").replace(/</g, "&lt;").replace(/>/g, "&gt;");
  const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const config = { displaylogo: false, responsive: true, modeBarButtonsToRemove: ["select2d", "lasso2d", "autoScale2d"], displayModeBar: false };
  const line = (color, width, dash) => ({ color: css(color), width, dash: dash || "solid" });
  const times = Array.from(report.times);
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
  let joint = null, points = 0, levels = 0;

  // The present point: where each torque is, and what muscles hold between two of them.
  const point = (frame) => {
    const a = joint.angle[frame];
    return { x: [a, a, null, a], y: [joint.external[frame], -joint.passive[frame], null, joint.active[frame]] };
  };

  function drawBalance(frame) {
    const { angle, minus_passive, external } = joint.balance;
    const swept = external.length > 0;
    const active = external.map((e, i) => minus_passive[i] - e);
    const torque = ` %{y:.2f} ${joint.torque} at %{x:.1f} ${joint.unit}<extra></extra>`;
    const traces = [
      { name: "active, this run", x: list(joint.angle), y: joint.active, line: line("--path", 7), hoverinfo: "skip" },
      { name: "external", x: swept ? angle : list(joint.angle), y: swept ? external : list(joint.external), line: line("--external", 2.2),
        hovertemplate: "external" + torque },
      { name: "minus passive", x: angle, y: minus_passive, line: line("--passive", 2.2), hovertemplate: "minus passive" + torque },
    ];
    if (swept) traces.push({ name: "active", x: angle, y: active, line: line("--active", 1.8, "dash"), hovertemplate: "active" + torque });
    traces.push({ name: "now", ...point(frame), mode: "lines+markers", line: line("--active", 3), hoverinfo: "skip",
      marker: { size: [10, 10, 0, 12], color: ["--external", "--passive", "--active", "--active"].map(css), line: { color: css("--paper"), width: 1.5 } } });
    for (const trace of traces) Object.assign(trace, { type: "scatter", mode: trace.mode || "lines" });
    points = traces.length - 1;
    const positive = joint.positive ? ` (positive: ${joint.positive})` : "";
    Plotly.react(balance, traces, layout({
      xaxis: axis(plain(`${joint.slides ? "place, m" : "angle, °"}${positive}`), { zeroline: false }),
      yaxis: axis(`torque, ${joint.torque}`),
    }), config);
  }

  function drawCourse(frame) {
    const traces = [
      { name: "external", y: list(joint.external), yaxis: "y2", line: line("--external", 2) },
      { name: "passive", y: list(joint.passive), yaxis: "y2", line: line("--passive", 2) },
      { name: "active", y: joint.active, yaxis: "y2", line: line("--active", 2, "dash") },
      { name: "angle", y: list(joint.angle), line: line("--active", 2), showlegend: false },
    ];
    (joint.groups || []).forEach((group, side) => traces.push({
      name: plain(group.label), y: group.fatigue.map ? list(group.fatigue.map((f) => 100 * f)) : [], yaxis: "y3",
      line: line(side ? "--negative" : "--positive", 2, side ? "dashdot" : "solid"),
    }));
    for (const trace of traces) {
      Object.assign(trace, { type: "scatter", mode: "lines", x: times, hovertemplate: "%{y:.2f}" });
    }
    const level = (y, dash) => ({ type: "line", xref: "paper", x0: 0, x1: 1, yref: "y3", y0: y, y1: y, line: { color: css("--quiet"), width: 1, dash } });
    const word = (y, text, yanchor) => ({ xref: "paper", x: 1, xanchor: "right", yref: "y3", y, yanchor, text, showarrow: false, font: { size: 11, color: css("--quiet") }, bgcolor: css("--paper"), opacity: 0.8, borderpad: 0 });
    const [critical, recovery] = report.levels.map((share) => 100 * share);
    const tires = joint.groups !== null;
    const shapes = tires ? [level(critical, "dash"), level(recovery, "dot")] : [];
    levels = shapes.length;
    shapes.push({ type: "line", xref: "x", yref: "paper", y0: 0, y1: 1, x0: times[frame], x1: times[frame], line: { color: css("--mark"), width: 2 } });
    Plotly.react(course, traces, layout({
      hovermode: "x unified", shapes,
      annotations: tires ? [word(critical, "relief begins", "top"), word(recovery, "relief ends", "top")] : [],
      xaxis: axis("time, s", { anchor: "y3", zeroline: false }),
      yaxis: axis(joint.slides ? "place, m" : "angle, °", { domain: [0.71, 1], zeroline: false }),
      yaxis2: axis(`torque, ${joint.torque}`, { domain: [0.355, 0.645] }),
      yaxis3: axis("fatigue, %", { domain: [0, 0.29], range: [0, 105], zeroline: false }),
    }), config);
  }

  function drawJoint(place, frame) {
    joint = window.Plotly && report.joints[place];
    if (!joint) return;
    drawBalance(frame);
    drawCourse(frame);
  }

  // The present point and the cursor.
  function drawFrame(frame) {
    if (!joint) return;
    const { x, y } = point(frame), t = times[frame];
    Plotly.restyle(balance, { x: [x], y: [y] }, [points]);
    Plotly.relayout(course, { [`shapes[${levels}].x0`]: t, [`shapes[${levels}].x1`]: t });
  }

  // A click anywhere on the course goes to its moment.
  course.addEventListener("click", (event) => {
    const x = course._fullLayout && course._fullLayout.xaxis;
    if (!x) return;
    const time = x.p2d(event.clientX - course.getBoundingClientRect().left - x._offset);
    if (time >= x.range[0] && time <= x.range[1]) onTime(time);
  });

  return { drawJoint, drawFrame, resize: () => [balance, course].forEach((chart) => Plotly.Plots.resize(chart)) };
}
