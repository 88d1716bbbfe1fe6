// What ties the page together: one moment, one joint, one measure; everything shown follows from these three.
(() => {
  const find = (id) => document.getElementById(id);
  const make = (kind, text, name) => {
    const made = document.createElement(kind);
    if (text !== undefined) made.textContent = text;
    if (name) made.className = name;
    return made;
  };
  const state = { frame: 0, joint: report.main, measure: measures.load, playing: null };
  const last = Math.max(0, report.frames - 1), times = report.times || [], end = times[last] || 0;
  const moves = times.length > 1, tires = report.joints.some((joint) => (joint.groups || []).some((group) => group.fatigue));
  const slider = find("slider"), rows = find("groups").tBodies[0];

  // --- In words.
  const clock = (t) => (end < 300 ? `${t.toFixed(end < 20 ? 2 : 1)} s` : `${Math.floor(t / 60)} min ${String(Math.floor(t % 60)).padStart(2, "0")} s`);
  const moment = (frame) => (report.names ? report.names[frame] : clock(times[frame] || 0));
  const percent = (share) => `${(100 * share).toFixed(share < 0.0995 ? 1 : 0)}\u00a0%`;
  const signed = (value) => `${value < 0 ? "−" : "+"}${Math.abs(value).toFixed(Math.abs(value) < 9.95 ? 2 : 1)}`;
  const span = (s) => (s < 0 ? "no limit" : s < 100 ? `${s.toFixed(0)} s` : s < 5400 ? `${(s / 60).toFixed(0)} min` : `${(s / 3600).toFixed(1)} h`);

  // --- What never changes.
  document.title = report.title || "contrapposto";
  find("title").textContent = [report.title, report.body].filter(Boolean).join(" · ");
  find("headline").textContent = report.headline;
  for (const reason of report.reasons) find("reasons").append(make("p", reason));
  for (const [label, value, note] of report.figures) {
    const item = make("li");
    item.append(make("span", label), make("b", value));
    if (note) item.append(make("span", note));
    find("figures").append(item);
  }
  report.joints.forEach((joint, i) => {
    const option = make("option", joint.label === joint.name ? joint.name : `${joint.label} (${joint.name})`);
    option.value = i;
    find("chooser").append(option);
  });
  // What is not known has no place on the page.
  const shown = {
    "key-force": report.supports.length, "key-center": report.center, "key-surface": report.surfaces.length, "key-target": report.targets.length,
    "key-ghost": moves || report.names, time: moves, "over-time": moves, postures: last > 0 && report.names, joint: report.joints.length,
    list: report.list.entries.length || report.list.none, overview: report.table.rows.length, muscles: report.joints.some((joint) => joint.groups),
  };
  for (const [id, known] of Object.entries(shown)) find(id).hidden = !known;
  document.documentElement.toggleAttribute("data-still", !moves);
  if (!tires) document.querySelectorAll(".fatigue").forEach((part) => { part.hidden = true; });
  find("keys").textContent = (moves ? "Space plays. Arrow keys step (with Shift by ten), Home and End jump. " : last > 0 ? "Arrow keys go from posture to posture. " : "") + "Drag the body to turn it.";
  find("list-heading").textContent = report.list.heading;
  report.list.entries.forEach((entry) => {
    const item = make("li"), button = make("button");
    button.type = "button";
    if (moves || report.names) button.append(make("time", moment(entry.frame)));
    button.append(make("span", entry.text));
    button.addEventListener("click", () => {
      choose(entry.joint);
      show(entry.frame);
    });
    item.append(button);
    find("decisions").append(item);
  });
  if (!report.list.entries.length) find("decisions").append(make("li", report.list.none, "hint"));
  find("overview-heading").textContent = report.table.heading;
  const lines = find("table").tBodies[0];
  for (const [kind, part, cells] of [["th", find("table").tHead, report.table.columns], ...report.table.rows.map((row) => ["td", lines, row])]) {
    const line = make("tr");
    line.append(...cells.map((text) => make(kind, text)));
    part.append(line);
  }
  if (shown.postures) report.names.forEach((name, frame) => {
    const button = make("button", name);
    button.type = "button";
    button.addEventListener("click", () => show(frame));
    find("postures").append(button);
  });

  // --- Body and charts.
  const body = Body(find("body"), (view) => {
    document.querySelectorAll("[data-view]").forEach((b) => b.setAttribute("aria-pressed", String(b.dataset.view === view)));
    paintBody();
  });
  if (!body) find("no-body").hidden = false;
  const charts = Charts((time) => show(frameAt(time)));
  const paintBody = () => { if (body) body.draw(state.frame, state.measure); };

  function frameAt(time) {
    let low = 0, high = last;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (times[middle] < time) low = middle + 1; else high = middle;
    }
    return low > 0 && time - times[low - 1] < times[low] - time ? low - 1 : low;
  }

  // --- A moment.
  function show(frame) {
    state.frame = Math.min(last, Math.max(0, frame));
    const time = times[state.frame] || 0, name = moment(state.frame);
    slider.value = time;
    slider.setAttribute("aria-valuetext", name);
    find("clock").textContent = `${name} of ${clock(end)}`;
    document.querySelectorAll("#postures button").forEach((b, i) => b.setAttribute("aria-pressed", String(i === state.frame)));
    paintBody();
    charts.drawFrame(state.frame);
    tellJoint();
    tellGroups(name);
    const current = report.list.entries.findLastIndex((entry) => entry.frame <= state.frame);
    document.querySelectorAll("#decisions button").forEach((b, i) => b.classList.toggle("current", i === current));
  }

  function tellJoint() {
    const joint = report.joints[state.joint], i = state.frame;
    if (!joint) return;
    const share = joint.groups ? ` (${percent(joint.load[i])} of strength)` : "";
    const name = joint.label.charAt(0).toUpperCase() + joint.label.slice(1), value = joint.angle[i].toFixed(joint.slides ? 3 : 1).replace("-", "−");
    find("now").textContent = `${name}, ${value}${joint.slides ? " m" : "°"}: weight and contact pull with ${signed(joint.external[i])} ` +
      `${joint.torque}, ligaments answer with ${signed(joint.passive[i])}, muscles with ${signed(joint.active[i])}${share}.`;
  }

  // The hardest worked groups of the moment.
  function tellGroups(name) {
    const i = state.frame, found = [];
    report.joints.forEach((joint, place) => (joint.groups || []).forEach((group, side) => {
      const works = side === (joint.active[i] < 0 ? 1 : 0);
      const row = { place, group, load: works ? joint.load[i] : 0, fatigue: group.fatigue ? group.fatigue[i] : 0 };
      if (row.load >= 0.001 || row.fatigue >= 0.005) found.push(row);
    }));
    found.sort((a, b) => b.load - a.load || b.fatigue - a.fatigue);
    find("when").textContent = moves ? `at ${name}` : last > 0 ? name : "";
    while (rows.rows.length > Math.min(8, found.length)) rows.deleteRow(-1);
    found.slice(0, 8).forEach((row, k) => {
      const line = rows.rows[k] || newRow();
      line.dataset.joint = row.place;
      const cells = [row.group.label, percent(row.load), percent(row.fatigue), row.load < 0.005 ? "rests" : span(row.group.left[i])];
      cells.forEach((text, c) => { line.cells[c].textContent = text; });
      line.cells[2].classList.toggle("tired", row.fatigue >= (report.levels || [1])[0]);
    });
  }
  function newRow() {
    const row = rows.insertRow();
    for (let c = 0; c < 4; c++) row.insertCell().hidden = c === 2 && !tires;
    row.tabIndex = 0;
    row.addEventListener("click", () => choose(Number(row.dataset.joint)));
    row.addEventListener("keydown", (event) => { if (event.key === "Enter") choose(Number(row.dataset.joint)); });
    return row;
  }

  // --- A joint.
  function choose(place) {
    state.joint = place;
    find("chooser").value = place;
    const joint = report.joints[place];
    const swept = joint && joint.balance.some((balance) => balance.external.length), known = joint && joint.balance.length;
    find("balance-hint").textContent = (swept ? "Where external torque meets minus passive torque the joint hangs on its ligaments: the gap between them is what muscles hold."
      : `External torque ${moves ? "where the body went" : last > 0 ? "in each posture" : "in this posture"}. ` +
        (known ? "Where it meets minus passive torque the joint hangs on its ligaments: the gap is what muscles hold." : "Nothing is known of its ligaments.")) +
      (moves || last > 0 ? " Large dots: now." : "");
    tellJoint();
    return charts.drawJoint(place, state.frame);
  }

  // --- A measure.
  function measure(name) {
    state.measure = measures[name];
    for (const key of ["load", "passive"]) find(`by-${key}`).setAttribute("aria-pressed", String(key === name));
    find("scale-low").textContent = "0 %";
    find("scale-high").textContent = name === "load" ? `${percent(state.measure.largest)} of strength` : "100 % of the torque";
    const stops = state.measure.colors.map((c) => `rgb(${c.map((v) => Math.round(255 * v)).join(",")})`);
    find("scale").style.background = `linear-gradient(to right, ${stops.join(",")})`;
    paintBody();
  }

  // --- Time goes by: the whole run in twelve seconds at most, and never slower than it was.
  function play() {
    const pace = Math.max(1, end / 12), from = state.frame >= last ? 0 : times[state.frame];
    const begin = performance.now();
    const step = (now) => {
      const time = from + (now - begin) / 1000 * pace;
      show(frameAt(time));
      if (time >= end) return stop();
      state.playing = requestAnimationFrame(step);
    };
    state.playing = requestAnimationFrame(step);
    find("play").textContent = "❚❚";
    find("play").setAttribute("aria-label", "Pause");
  }
  function stop() {
    cancelAnimationFrame(state.playing);
    state.playing = null;
    find("play").textContent = "▶";
    find("play").setAttribute("aria-label", "Play");
  }
  const toggle = () => (state.playing === null ? play() : stop());

  // --- Hands.
  slider.max = end;
  let wanted = null;
  slider.addEventListener("input", () => {
    stop();
    if (wanted === null) requestAnimationFrame(() => { show(frameAt(wanted)); wanted = null; });
    wanted = Number(slider.value);
  });
  find("play").addEventListener("click", toggle);
  find("chooser").addEventListener("change", (event) => choose(Number(event.target.value)));
  for (const key of ["load", "passive"]) find(`by-${key}`).addEventListener("click", () => measure(key));
  document.querySelectorAll("[data-view]").forEach((b) => b.addEventListener("click", () => body && body.from(b.dataset.view)));
  document.addEventListener("keydown", (event) => {
    if (event.altKey || event.ctrlKey || event.metaKey || event.target.tagName === "SELECT") return;
    const far = event.shiftKey ? 10 : 1;
    const to = { ArrowLeft: state.frame - far, ArrowRight: state.frame + far, Home: 0, End: last }[event.key];
    if (event.key === " " && moves && event.target.tagName !== "BUTTON") toggle();
    else if (to !== undefined) { stop(); show(to); }
    else return;
    event.preventDefault();
  });

  // --- Light, dark, paper, another width: all is drawn anew.
  const redraw = () => { choose(state.joint); paintBody(); };
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
  new ResizeObserver(paintBody).observe(find("stage"));
  // What WebGL has drawn does not reach paper; a picture of it does.
  const print = (begins) => {
    document.documentElement.toggleAttribute("data-paper", begins);
    redraw();
    if (begins && body) find("printed").src = find("body").toDataURL();
  };
  addEventListener("beforeprint", () => print(true));
  addEventListener("afterprint", () => print(false));
  matchMedia("print").addEventListener("change", (change) => { print(change.matches); charts.resize(); });

  const known = report.joints.some((joint) => joint.groups);
  find("by-load").hidden = !known;
  measure(known ? "load" : "passive");
  choose(state.joint);
  show(report.names ? 0 : last);
  // The body and the words are there; the charts' library takes a moment to read and comes after they are painted.
  const painted = new Promise((done) => requestAnimationFrame(() => setTimeout(done)));
  const parsed = new Promise((done) => addEventListener("DOMContentLoaded", done));
  const mark = (name) => { document.documentElement.dataset[name] = String(Math.round(performance.now())); };
  painted.then(() => mark("drawn"));
  Promise.all([painted, parsed]).then(async () => {
    document.head.append(make("script", find("plotly").textContent));
    find("plotly").remove();
    await choose(state.joint);
    mark("ready");
  });
})();
