// Ties the page together: one frame, one joint, one measure; everything shown follows from these three.
const HARDEST_GROUPS = 8, MOST_PRESSED = 7, LONGEST_PLAY = 12, MOST_LOADS = 3; // rows; rows; s; named in the key
const NARROW = matchMedia("(max-width: 52rem)"), TOUCHED = matchMedia("(pointer: coarse)").matches;
const MOST_REASONS = NARROW.matches ? 1 : 2, MOST_ENTRIES = NARROW.matches ? 3 : 6; // shown before the rest is folded
const SMALLEST_BODY = 300, LARGEST_BODY = 680; // px
const RESTING = 0.005, TIRED = (report.levels || [0, 0.3])[1]; // load; fatigue
const LAST_FRAME = Math.max(0, report.frames - 1), TIMES = report.times || [], END = TIMES[LAST_FRAME] || 0;
const MOVES = TIMES.length > 1, SEVERAL = LAST_FRAME > 0;
const TIRES = report.joints.some((joint) => (joint.groups || []).some((group) => group.fatigue));

// --- Elements.

function find(id) {
  return document.getElementById(id);
}

function make(kind, text, name) {
  const made = document.createElement(kind);
  if (text !== undefined) made.textContent = text;
  if (name) made.className = name;
  return made;
}

function makeButton(...content) {
  const button = make("button");
  button.type = "button";
  button.append(...content);
  return button;
}

function press(buttons, isPressed) {
  document.querySelectorAll(buttons).forEach((button, i) => button.setAttribute("aria-pressed", String(isPressed(button, i))));
}

// --- Numbers in words.

// The bounds are those of all times in words (`how_long` of the library): seconds, minutes, hours.
function inUnit(s, digits) {
  if (s < 9.95) return `${s.toFixed(digits + 1)}\u00a0s`;
  if (s < 100) return `${s.toFixed(digits)}\u00a0s`;
  return s < 5970 ? `${(s / 60).toFixed(s < 597 ? digits + 1 : digits)}\u00a0min` : `${(s / 3600).toFixed(2 * digits + 1)}\u00a0h`;
}
// A moment has a digit more than a time.
function clock(t) {
  return inUnit(t, 1);
}
function frameName(frame) {
  return report.names ? report.names[frame] : clock(TIMES[frame] || 0);
}
function percent(share) {
  if (share > 10) return "more than 1000\u00a0%";
  return share > 0 && share < 0.005 ? "<\u00a01\u00a0%" : `${(100 * share).toFixed(0)}\u00a0%`;
}
function signed(value) {
  return `${value < 0 ? "−" : "+"}${Math.abs(value).toFixed(Math.abs(value) < 9.95 ? 2 : 1)}`;
}
function duration(s) {
  return s < 0 ? "no limit" : inUnit(s, 0);
}

function newtons(force) {
  return `${force.toFixed(0)}\u00a0N`;
}

function metres(far) {
  return far < 0.9995 ? `${(100 * far).toFixed(1)}\u00a0cm` : `${far.toPrecision(Math.max(3, Math.ceil(Math.log10(far))))}\u00a0m`;
}

// The frame nearest to a time.
function frameAt(time) {
  let low = 0, high = LAST_FRAME;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (TIMES[middle] < time) low = middle + 1; else high = middle;
  }
  return low > 0 && time - TIMES[low - 1] < TIMES[low] - time ? low - 1 : low;
}

// --- Parts of the page that never change.

function fillHeader() {
  document.title = report.title || "contrapposto";
  find("title").textContent = [report.title, report.body].filter(Boolean).join(" · ");
  // The first sentence stands out; the others follow it in smaller letters.
  const end = report.headline.search(/\. (?=\p{Lu})/u) + 1 || report.headline.length;
  find("headline").textContent = report.headline.slice(0, end);
  find("headline").append(make("span", report.headline.slice(end)));
  find("headline").lastChild.classList.toggle("in-hazard", /^\s*Hazard/.test(report.headline.slice(end)));
  for (const [name, text] of report.facts) {
    const fact = make("div");
    fact.append(make("dt", name), make("dd", text));
    find("facts").append(fact);
  }
  fillTable(find("changes"), report.changes);
  find("facts").hidden = !report.facts.length;
  find("changes").hidden = !report.changes.rows.length;
  report.reasons.forEach((reason, i) => {
    find(i < MOST_REASONS ? "reasons" : "more-reasons").append(make("p", reason));
  });
  showMore("more-reasons", report.reasons.length - MOST_REASONS);
  for (const [label, value, note] of report.figures) {
    const item = make("li");
    item.append(make("span", label), make("b", value));
    if (note) item.append(make("span", note));
    find("figures").append(item);
  }
}

// Names how many texts a fold contains; one without any is hidden.
function showMore(id, count) {
  find(id).hidden = count <= 0;
  find(id).querySelector("summary").textContent = `${count} more`;
}

// The page's own words about muscles, for a body that motors move.
function nameMotors() {
  const texts = document.createTreeWalker(document.querySelector("main"), NodeFilter.SHOW_TEXT);
  while (texts.nextNode()) {
    const text = texts.currentNode;
    text.data = text.data.replace(/muscle group/g, "motor").replace(/Muscle group/g, "Motor").replace(/muscle/g, "motor").replace(/Muscle/g, "Motor");
  }
}

// Hides every part about which the report says nothing.
function hideUnknown() {
  const known = {
    "key-force": report.supports.length, "key-center": report.center, "key-surface": report.surfaces.length,
    "key-hazard": report.joints.some((joint) => joint.hazard), "key-load": report.loads.length, "key-thing": report.things.length, "key-target": report.targets.length, "key-solid": report.solid, "key-ghost": MOVES || report.names, time: MOVES, "over-time": MOVES, "over-cycle": report.cycles,
    "by-muscle": report.muscles, "key-muscle": report.muscles, single: report.muscles, "single-muscles": report.muscles,
    figure: report.skin, postures: SEVERAL && report.names, joint: report.joints.length, list: report.list.entries.length || report.list.none,
    answer: report.facts.length || report.changes.rows.length || report.reasons.length, scene: report.segments.length, overview: report.table.rows.length, muscles: report.joints.some((joint) => joint.groups),
  };
  for (const [id, isKnown] of Object.entries(known)) find(id).hidden = !isKnown;
  if (report.solid) fillLimits(report.solid);
  if (report.cycles) find("cycle-text").textContent = report.cycles.text;
  find("things").textContent = [...new Set(report.things.map(({ label, putDown }) => label + (putDown === null ? "" : ` (until ${frameName(putDown)})`)))].join(", ");
  find("surfaces").textContent = [...new Set(report.surfaces.map((surface) => surface.label))].join(", ");
  const loads = report.loads.map((load) => load.label);
  find("loads").textContent = loads.length && loads.length <= MOST_LOADS ? `: ${loads.join(", ")}` : "";
  document.documentElement.toggleAttribute("data-still", !MOVES);
  document.documentElement.toggleAttribute("data-single", Boolean(report.muscles));
  document.documentElement.toggleAttribute("data-bodiless", !report.segments.length);
  if (!TIRES) document.querySelectorAll(".fatigue").forEach((part) => { part.hidden = true; });
  const postureKeys = SEVERAL ? "Arrow keys go from posture to posture. " : "";
  if (TOUCHED) find("handling").textContent = `One finger turns, two magnify, a tap on a ${report.muscles ? "muscle or limb names it" : "limb chooses its joint"}.`;
  else if (report.muscles) find("handling").textContent = "Drag turns, wheel or pinch magnifies, a click on a muscle or limb chooses its joint.";
  const keys = TOUCHED ? "" : MOVES ? "Space plays. Arrow keys step (with Shift by ten), Home and End jump. " : postureKeys;
  find("keys").textContent = keys;
}

function fillChooser() {
  report.joints.forEach((joint, i) => {
    const option = make("option", joint.label);
    option.value = i;
    find("chooser").append(option);
  });
}

function fillOverview() {
  find("overview-heading").textContent = report.table.heading;
  fillTable(find("table"), report.table);
}

function fillTable(table, { columns, rows }) {
  const addRow = (part, kind, cells) => {
    const row = make("tr");
    row.append(...cells.map((text) => make(kind, text)));
    part.append(row);
  };
  addRow(table.tHead, "th", columns);
  for (const cells of rows) addRow(table.tBodies[0], "td", cells);
}

// The limits of a force with their colours.
function fillLimits({ names, scale }) {
  find("limits").replaceChildren(...names.flatMap((name, i) => {
    const swatch = document.createElement("i");
    swatch.className = "swatch";
    swatch.style.background = `var(--limit-${i})`;
    return [swatch, name];
  }));
  find("solid-scale").textContent = scale && `; ${scale}`;
}

// The bands of a measure side by side, with the bounds between them.
function fillScale({ bands }, unit) {
  const parts = [];
  for (const [from, low, high] of bands) {
    const band = make("i");
    band.style.background = `linear-gradient(to right, ${low}, ${high})`;
    parts.push(make("span", (100 * from).toFixed(0)), band);
  }
  if (bands.at(-1)[0] < 1) parts.push(make("span", "100"));
  find("scale").replaceChildren(...parts, make("span", unit));
}

// The text below the heading of the torque balance.
function balanceHint(joint) {
  const end = MOVES || SEVERAL ? " Large dots: now." : "";
  if (joint && joint.balance.some((balance) => balance.external.length)) {
    return `Where the orange line (torque of weight and contact) meets the blue one (what ligaments and relaxed tissue give against it), ligaments carry the joint; ${MUSCLES} hold the difference.` + end;
  }
  const place = MOVES ? "where the body went" : SEVERAL ? "in each posture" : "in this posture";
  const passive = joint && joint.balance.length
    ? `Where it meets the blue line (what ligaments and relaxed tissue give against it), ligaments carry the joint; ${MUSCLES} hold the difference.`
    : "The torque of its ligaments is not known.";
  return `Orange: torque of weight and contact ${place}. ${passive}${end}`;
}

// --- The page.

class Page {
  constructor() {
    this.muscle = -1;
    [this.frame, this.joint, this.measure, this.playing, this.wanted, this.body] = [0, report.main, measures.load, null, null, null];
    fillHeader();
    fillChooser();
    if (report.motors) nameMotors();
    hideUnknown();
    this.fillList();
    fillOverview();
    this.fillPostures();
    for (const fold of document.querySelectorAll(".fold")) fold.open = !NARROW.matches;
    this.charts = new Charts((time) => this.showFrame(frameAt(time)));
    this.listen();
    this.listenToMedia();
  }

  fillList() {
    const more = find("more-decisions").querySelector("ol");
    find("list-heading").textContent = report.list.heading;
    for (const entry of report.list.entries) {
      const named = entry.time === null ? frameName(entry.frame) : clock(entry.time);
      const time = MOVES || report.names ? [make("time", named)] : [];
      const button = makeButton(...time, make("span", entry.text)), item = make("li");
      button.addEventListener("click", () => {
        if (entry.joint !== null) this.chooseJoint(entry.joint);
        this.showFrame(entry.frame);
      });
      item.append(button);
      (find("decisions").children.length < MOST_ENTRIES ? find("decisions") : more).append(item);
    }
    showMore("more-decisions", report.list.entries.length - MOST_ENTRIES);
    if (!report.list.entries.length) find("decisions").append(make("li", report.list.none, "hint"));
  }

  fillPostures() {
    if (!SEVERAL || !report.names) return;
    report.names.forEach((name, frame) => {
      const button = makeButton(name);
      button.addEventListener("click", () => this.showFrame(frame));
      find("postures").append(button);
    });
  }

  // Makes and paints the body, which takes long where no graphics card helps.
  showBody() {
    this.body = Body.on(find("body"), {
      onTurn: (view) => {
        press("[data-view]", (button) => button.dataset.view === view);
        this.paintBody();
      },
      onPick: (segment) => this.chooseLimb(segment),
      onMuscle: (muscle, clicked) => this.nameMuscle(muscle, clicked),
    });
    find("handling").hidden = !this.body;
    find("no-body").hidden = Boolean(this.body);
    this.paintBody();
  }

  paintBody() {
    if (this.body) this.body.draw(this.frame, this.measure);
  }

  showFrame(frame) {
    this.frame = Math.min(LAST_FRAME, Math.max(0, frame));
    const time = TIMES[this.frame] || 0, name = frameName(this.frame);
    find("slider").value = time;
    find("slider").setAttribute("aria-valuetext", name);
    find("clock").textContent = `${name} of ${duration(END)}`;
    press("#postures button", (_, i) => i === this.frame);
    this.paintBody();
    this.charts.drawFrame(this.frame);
    this.describeJoint();
    this.describeTargets();
    this.listGroups(name);
    if (report.muscles) this.listMuscles();
    const latest = Math.max(...report.list.entries.map((entry) => entry.frame).filter((of) => of <= this.frame));
    const current = report.list.entries.findIndex((entry) => entry.frame === latest);
    document.querySelectorAll("#list button").forEach((b, i) => b.classList.toggle("current", i === current));
  }

  // One sentence about the torques of the joint.
  describeJoint() {
    const joint = report.joints[this.joint], i = this.frame;
    if (!joint) return;
    const share = joint.groups ? ` (${percent(joint.load[i])} of strength)` : "";
    const name = joint.label.charAt(0).toUpperCase() + joint.label.slice(1);
    const shown = (value) => value.toFixed(joint.slides ? 3 : 1).replace("-", "−") + (joint.slides ? " m" : "°");
    const value = shown(joint.angle[i]), differs = joint.coordinate && Math.abs(joint.coordinate[i] - joint.angle[i]) >= 0.05;
    find("in-files").textContent = differs ? `Name in the model: ${joint.name} = ${shown(joint.coordinate[i])}; the angle shown is that about the joint’s own axis, which differs where its other axes are turned, too.` : joint.label === joint.name ? "" : `Name in the model: ${joint.name}.`;
    const same = joint.external[i] * joint.passive[i] > 0;
    find("now").textContent = `${name}, ${value}: weight and contact pull with ${signed(joint.external[i])} ${joint.torque}, ` +
      `${same ? "ligaments pull the same way with" : "ligaments answer with"} ${signed(joint.passive[i])}, ${MUSCLES} ${same ? "answer " : ""}with ${signed(joint.active[i])}${share}.`;
  }

  // How far points of the body are from the targets that they miss.
  describeTargets() {
    const i = this.frame, missed = report.targets.filter(({ from }) => from).map(({ label, at, from }) => {
      return [label, Math.hypot(...at.map((column, k) => column[i] - from[k][i]))];
    });
    const words = missed.filter(([, far]) => far >= NEAR_TARGET).map(([label, far]) => `${metres(far)} from ${label}`);
    find("targets").textContent = words.length ? `: ${words.join(", ")}` : "";
  }

  // The hardest worked muscle groups of the frame.
  listGroups(name) {
    const rows = find("groups").tBodies[0], groups = this.workingGroups().slice(0, HARDEST_GROUPS);
    find("when").textContent = MOVES ? `at ${name}` : SEVERAL ? name : "";
    while (rows.rows.length > groups.length) rows.deleteRow(-1);
    groups.forEach(({ place, group, load, fatigue }, k) => {
      const row = rows.rows[k] || this.addGroupRow(rows);
      row.dataset.joint = place;
      const endurance = (load < RESTING ? "rests" : duration(group.left[this.frame])) + this.whyTired(group, load, fatigue);
      [group.label, percent(load), percent(fatigue), endurance].forEach((text, c) => { row.cells[c].textContent = text; });
      row.cells[2].classList.toggle("tired", fatigue >= (report.levels || [1])[0]);
    });
  }

  // A group that is tired and could hold its load without limit recovers at rest; under the load it does not become more tired.
  whyTired(group, load, fatigue) {
    const easy = load < RESTING || group.left[this.frame] < 0;
    return !easy || fatigue < TIRED ? "" : load < RESTING ? "; recovers" : "; tires no further";
  }

  // Groups with load or fatigue, the greatest load first.
  workingGroups() {
    const i = this.frame, found = [];
    report.joints.forEach((joint, place) => (joint.groups || []).forEach((group, side) => {
      const works = side === (joint.active[i] < 0 ? 1 : 0);
      const entry = { place, group, load: works ? joint.load[i] : 0, fatigue: group.fatigue ? group.fatigue[i] : 0 };
      if (entry.load >= 0.001 || entry.fatigue >= 0.005) found.push(entry);
    }));
    return found.sort((a, b) => b.load - a.load || b.fatigue - a.fatigue);
  }

  // The hardest worked single muscles of the frame, and what all of them together cannot give.
  listMuscles() {
    const rows = find("single").tBodies[0], i = this.frame, { lines, lacks } = report.muscles;
    const order = lines.map((_, m) => m).filter((m) => lines[m].activation[i] >= RESTING);
    order.sort((a, b) => lines[b].activation[i] - lines[a].activation[i] || lines[b].tension[i] - lines[a].tension[i]);
    rows.replaceChildren(...order.slice(0, HARDEST_GROUPS).map((m) => {
      const row = make("tr"), choose = () => this.nameMuscle(m, true);
      row.append(...[lines[m].name, percent(lines[m].activation[i]), newtons(lines[m].tension[i]), lines[m].works_for].map((text) => make("td", text)));
      row.tabIndex = 0;
      row.addEventListener("click", choose);
      row.addEventListener("keydown", (event) => { if (event.key === "Enter") choose(); });
      return row;
    }));
    find("single-when").textContent = find("when").textContent;
    const missing = lacks ? lacks.torque[i] : 0, joint = lacks && report.joints[lacks.joint[i] - 1];
    find("lacks").textContent = missing > 0.05 ? `At this moment the muscles together cannot give all torques: ${missing.toFixed(1)} N m are missing${joint ? ` at ${joint.label}` : ""}. The activations are those that come nearest.` : "";
    const pressed = report.muscles.pressed.filter((joint) => joint.force[i] > 0).sort((a, b) => b.force[i] - a.force[i]);
    find("pressed").hidden = !pressed.length;
    find("pressed").tBodies[0].replaceChildren(...pressed.slice(0, MOST_PRESSED).map((joint) => {
      const row = make("tr");
      row.append(...[joint.name, newtons(joint.force[i]), joint.weights[i].toFixed(2), joint.along].map((text) => make("td", text)));
      return row;
    }));
    this.describeMuscle(this.muscle);
  }

  // Names the muscle under the pointer; a click keeps it, and chooses its joint.
  nameMuscle(muscle, clicked) {
    if (!report.muscles) return;
    if (clicked) {
      this.muscle = muscle;
      const { joint } = report.muscles.lines[muscle] || {};
      if (joint !== null && joint !== undefined) this.chooseJoint(joint);
    }
    const shown = muscle < 0 ? this.muscle : muscle;
    this.describeMuscle(shown);
    if (!this.body || this.body.chosen === shown && !clicked) return;
    this.body.chosen = shown;
    this.paintBody();
  }

  describeMuscle(muscle) {
    const of = report.muscles.lines[muscle], i = this.frame;
    const works = of && of.works_for ? `, works for ${of.works_for}` : "";
    find("muscle-now").textContent = of ? `${of.name}: activation ${percent(of.activation[i])}, ${newtons(of.tension[i])}${works}` : "";
  }

  addGroupRow(rows) {
    const row = rows.insertRow(), choose = () => this.chooseJoint(Number(row.dataset.joint));
    for (let c = 0; c < 4; c++) row.insertCell().hidden = c === 2 && !TIRES;
    row.tabIndex = 0;
    row.addEventListener("click", choose);
    row.addEventListener("keydown", (event) => { if (event.key === "Enter") choose(); });
    return row;
  }

  chooseJoint(index) {
    this.joint = index;
    find("chooser").value = index;
    find("balance-hint").textContent = balanceHint(report.joints[index]);
    this.describeJoint();
    return this.charts.drawJoint(index, this.frame);
  }

  // Of the joints that move a limb, the one with the greatest load.
  chooseLimb(segment) {
    const load = (j) => report.joints[j].load[this.frame];
    const joints = segment ? [...segment.joints].sort((a, b) => load(b) - load(a)) : [];
    if (joints.length) this.chooseJoint(joints[0]);
    this.paintBody();
  }

  // Makes the body as tall as the window has room for below the words, with slider and key.
  fitBody() {
    const canvas = find("body"), below = find("keys").getBoundingClientRect().bottom - canvas.getBoundingClientRect().bottom;
    const top = canvas.getBoundingClientRect().top + scrollY;
    const room = NARROW.matches ? 0.5 * innerHeight : innerHeight - top - below - 10;
    canvas.style.height = `${Math.round(Math.min(LARGEST_BODY, Math.max(SMALLEST_BODY, room)))}px`;
  }

  chooseMeasure(name) {
    this.measure = measures[name];
    for (const key of ["load", "passive"]) find(`by-${key}`).setAttribute("aria-pressed", String(key === name));
    fillScale(this.measure, name === "load" ? "% of strength" : "% of the torque");
    find("bounds").hidden = name !== "load";
    this.paintBody();
  }

  // Plays the run from the present frame: in twelve seconds at most, and never slower than real time.
  play() {
    const speed = Math.max(1, END / LONGEST_PLAY), from = this.frame >= LAST_FRAME ? 0 : TIMES[this.frame];
    const begin = performance.now();
    const step = (now) => {
      const time = from + (now - begin) / 1000 * speed;
      this.showFrame(frameAt(time));
      if (time >= END) return this.pause();
      this.playing = requestAnimationFrame(step);
    };
    this.playing = requestAnimationFrame(step);
    find("play").textContent = "❚❚";
    find("play").setAttribute("aria-label", "Pause");
  }

  pause() {
    cancelAnimationFrame(this.playing);
    this.playing = null;
    find("play").textContent = "▶";
    find("play").setAttribute("aria-label", "Play");
  }

  togglePlay() {
    if (this.playing === null) this.play();
    else this.pause();
  }

  listen() {
    find("slider").max = END;
    find("slider").addEventListener("input", () => this.slide(Number(find("slider").value)));
    find("play").addEventListener("click", () => this.togglePlay());
    find("chooser").addEventListener("change", (event) => this.chooseJoint(Number(event.target.value)));
    for (const key of ["load", "passive"]) find(`by-${key}`).addEventListener("click", () => this.chooseMeasure(key));
    for (const button of document.querySelectorAll("[data-view]")) {
      button.addEventListener("click", () => this.body && this.body.lookFrom(button.dataset.view));
    }
    for (const button of document.querySelectorAll("[data-figure]")) {
      button.addEventListener("click", () => this.chooseFigure(button.dataset.figure));
    }
    find("show-muscles").addEventListener("click", () => this.toggleMuscles());
    document.addEventListener("keydown", (event) => this.pressKey(event));
  }

  // Shows the body with its skin, or as a wooden figure.
  chooseFigure(figure) {
    press("[data-figure]", (button) => button.dataset.figure === figure);
    if (this.body) this.body.wooden = figure === "wooden";
    this.paintBody();
  }

  // Shows the muscles in a body of glass, or the body alone.
  toggleMuscles() {
    if (!this.body) return;
    this.body.showsMuscles = !this.body.showsMuscles;
    find("show-muscles").setAttribute("aria-pressed", String(this.body.showsMuscles));
    find("key-muscle").hidden = !this.body.showsMuscles;
    this.nameMuscle(-1, true);
    this.paintBody();
  }

  // Shows the last of all times that the slider sends before the next picture.
  slide(time) {
    this.pause();
    if (this.wanted === null) {
      requestAnimationFrame(() => {
        this.showFrame(frameAt(this.wanted));
        this.wanted = null;
      });
    }
    this.wanted = time;
  }

  pressKey(event) {
    if (event.altKey || event.ctrlKey || event.metaKey || event.target.tagName === "SELECT") return;
    const far = event.shiftKey ? 10 : 1;
    const to = { ArrowLeft: this.frame - far, ArrowRight: this.frame + far, Home: 0, End: LAST_FRAME }[event.key];
    if (event.key === " " && MOVES && event.target.tagName !== "BUTTON") {
      this.togglePlay();
    } else if (to !== undefined) {
      this.pause();
      this.showFrame(to);
    } else {
      return;
    }
    event.preventDefault();
  }

  // Draws everything anew in light, dark, on paper and at another width.
  listenToMedia() {
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.redraw());
    new ResizeObserver(() => this.paintBody()).observe(find("stage"));
    addEventListener("resize", () => this.fitBody());
    addEventListener("beforeprint", () => this.print(true));
    addEventListener("afterprint", () => this.print(false));
    matchMedia("print").addEventListener("change", (change) => {
      this.print(change.matches);
      this.charts.resize();
    });
  }

  redraw() {
    this.chooseJoint(this.joint);
    this.paintBody();
  }

  // A WebGL canvas is not printed; an image of it is.
  print(begins) {
    document.documentElement.toggleAttribute("data-paper", begins);
    if (begins) document.querySelectorAll(".fold").forEach((fold) => { fold.open = true; });
    this.redraw();
    if (begins && this.body) find("printed").src = find("body").toDataURL();
  }

  open() {
    const hasLoads = report.joints.some((joint) => joint.groups);
    find("by-load").hidden = !hasLoads;
    this.chooseMeasure(hasLoads ? "load" : "passive");
    this.chooseJoint(this.joint);
    this.showFrame(report.open);
    this.fitBody();
  }
}

// Opens the page: first the words, when these are painted plotly.js and the charts, at last the body. The times at which charts and
// body are drawn stand as `data-charted` and `data-ready` on the root element.
async function openPage() {
  const painted = new Promise((done) => requestAnimationFrame(() => setTimeout(done)));
  const parsed = new Promise((done) => addEventListener("DOMContentLoaded", done));
  const mark = (name) => { document.documentElement.dataset[name] = String(Math.round(performance.now())); };
  const page = new Page();
  page.open();
  await painted;
  await parsed;
  document.head.append(make("script", find("plotly").textContent));
  find("plotly").remove();
  await page.chooseJoint(page.joint);
  mark("charted");
  await new Promise((done) => setTimeout(done));
  page.showBody();
  mark("ready");
}
openPage();
