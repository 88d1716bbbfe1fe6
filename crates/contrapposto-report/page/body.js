// The body in three dimensions: every segment is the hull of a few balls, coloured by a measure; with contact forces, loads, centre
// of mass, targets, surfaces, things, and the start as a ghost.
const BEFORE_BODY = 0.16, EDGES = 0.8, PALE = 0.5; // opacities; share of the colour of the scene
const NEAR_TARGET = 0.005, FAR_TARGET = 1.2, FAR_ARROW = 0.6; // m
const BONE = 0.2, THICKEST_BONE = 0.011, GLASS = 0.17; // share of a segment's thickness; m; opacity of the body about muscles
const PULLS_DOWN = 0.7; // share of a force
const ARROW_OF_WEIGHT = 0.6, SHORTEST_ARROW = 0.012, SHORTEST_LOAD = 0.25, ARROW_HEAD = 0.09, LEAST_DRAG = 4; // m; px

// Largest sum of contact forces in any frame, N; of a body without supports, of loads.
function largestWeight() {
  let weight = 0;
  const pushes = report.supports.length ? report.supports : report.loads;
  for (let frame = 0; frame < report.frames; frame++) {
    const sum = [0, 1, 2].map((k) => pushes.reduce((force, push) => force + push.force[k][frame], 0));
    weight = Math.max(weight, Math.hypot(...sum));
  }
  return weight;
}

class Body {
  // `onTurn` is called with the name of a view, or with null, when the camera has moved; `onPick` with a segment that was clicked; `onMuscle`
  // with the index of a muscle under the pointer, or -1, and whether it was clicked.
  constructor(canvas, gl, { onTurn, onPick, onMuscle }) {
    [this.canvas, this.gl, this.onTurn, this.onPick, this.onMuscle] = [canvas, gl, onTurn, onPick, onMuscle];
    this.painter = new Painter(gl);
    VIEWS.between = startView(report.open);
    this.camera = new Camera(sceneBounds());
    this.weight = largestWeight() || 1;
    this.makeMeshes();
    this.painter.start();
    this.listen();
  }

  // A body on a canvas, or null where the browser has no WebGL.
  static on(canvas, answers) {
    const gl = canvas.getContext("webgl", { alpha: false, antialias: true, preserveDrawingBuffer: true });
    return gl && new Body(canvas, gl, answers);
  }

  makeMeshes() {
    const { gl, painter } = this;
    this.parts = report.segments.map((segment) => painter.hullMesh(segment.balls));
    this.skin = report.skin && new Skin(report.skin, painter);
    if (report.muscles) {
      this.tubes = new MuscleTubes(report.muscles, painter);
      this.bones = report.segments.map(({ balls }) => painter.hullMesh(balls.map(([x, y, z, r]) => [x, y, z, Math.min(BONE * r, THICKEST_BONE)])));
    }
    [this.showsMuscles, this.chosen] = [Boolean(report.muscles), -1];
    this.ball = painter.hullMesh([[0, 0, 0, 1]]);
    this.shaft = painter.hullMesh([[0, 0, 0, 0.012], [0, 1, 0, 0.012]]);
    this.tip = painter.hullMesh([[0, -ARROW_HEAD, 0, 0.034], [0, -0.002, 0, 0.002]]);
    this.slabs = report.surfaces.flatMap(({ corners }) => {
      const { faces, edges } = slabPoints(corners);
      return [
        { mesh: painter.listMesh(gl.TRIANGLES, faces), before: BEFORE_BODY },
        { mesh: painter.listMesh(gl.LINES, edges), before: EDGES },
      ];
    });
    this.limits = report.solid ? limitPoints(report.solid).map((points) => painter.listMesh(gl.TRIANGLES, points)) : [];
    const box = boxPoints();
    [this.boxFaces, this.boxEdges] = [painter.listMesh(gl.TRIANGLES, box.faces), painter.listMesh(gl.LINES, box.edges)];
    this.grid = report.ground === null ? null : painter.listMesh(gl.LINES, gridPoints(this.camera.middle, report.ground));
  }

  draw(frame, measure) {
    const { canvas, gl, painter } = this;
    const scale = window.devicePixelRatio || 1;
    const [width, height] = [Math.round(canvas.clientWidth * scale), Math.round(canvas.clientHeight * scale)];
    this.frame = frame;
    if (!width || !height) return;
    if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
    painter.clear(width, height, styleColor("--scene"), this.camera);
    painter.flatness(1);
    if (this.grid) painter.list(this.grid, styleColor("--ground"), 1);
    this.drawBehind(frame);
    if (this.showsMuscles) this.drawMuscles(frame, measure);
    else this.drawSegments(frame, measure);
    painter.flatness(0.35);
    this.drawMarks(frame, 1);
    // What of surfaces and things is before the body lets it be seen.
    painter.flatness(0.6);
    gl.enable(gl.BLEND);
    gl.depthMask(false);
    for (const { mesh, before } of this.slabs) painter.list(mesh, styleColor("--surface"), before);
    this.drawThings(frame, styleColor("--thing"), BEFORE_BODY);
    this.limits.forEach((mesh, limit) => painter.list(mesh, styleColor(`--limit-${limit}`), 0.5));
    gl.depthMask(true);
    if (this.showsMuscles) this.drawGlass(frame, measure);
    this.drawGhost(frame);
    // Marks behind the body shine through it.
    gl.disable(gl.DEPTH_TEST);
    painter.flatness(1);
    this.drawMarks(frame, 0.4);
    gl.enable(gl.DEPTH_TEST);
  }

  // The segment at a place of the canvas, px, in the frame that was drawn last; undefined beside the body. It draws every segment in a
  // colour of its own and reads one point back: afterwards the body must be drawn anew.
  pick(x, y) {
    const { canvas, gl, painter } = this, scale = canvas.width / canvas.clientWidth;
    painter.clear(canvas.width, canvas.height, [0, 0, 0], this.camera);
    painter.flatness(1);
    report.segments.forEach((segment, i) => {
      const color = [((i + 1) >> 8) / 255, ((i + 1) & 255) / 255, 1];
      painter.hull(this.parts[i], placement(segment.places, this.frame), color);
    });
    const seen = new Uint8Array(4);
    gl.readPixels(Math.round(x * scale), Math.round(canvas.height - y * scale), 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, seen);
    return seen[2] === 255 ? report.segments[256 * seen[0] + seen[1] - 1] : undefined;
  }

  // Colour of every segment in a frame.
  colors(frame, measure) {
    const unknown = styleColor("--none"), hazard = styleColor("--hazard");
    return (segment) => {
      const share = measure.of(segment, frame);
      return inHazard(segment, frame) ? hazard : share === null ? unknown : colorOf(measure, share);
    };
  }

  // Muscles on bones: a bone is its segment, much thinner.
  drawMuscles(frame, measure) {
    const bone = styleColor("--bone");
    this.painter.flatness(0);
    report.segments.forEach((segment, i) => this.painter.hull(this.bones[i], placement(segment.places, frame), bone));
    this.tubes.fill(frame, measure === measures.load, this.chosen);
    this.tubes.draw();
  }

  // The body about its muscles, transparent: first its depth, then its nearest surface only. A segment with muscles has no colour of its own
  // where they are coloured: it would change theirs.
  drawGlass(frame, measure) {
    const { gl, painter } = this, colors = this.colors(frame, measure), clear = styleColor("--none");
    const color = (segment) => measure === measures.load && this.tubes.segments.has(segment.name) ? clear : colors(segment);
    painter.flatness(0.75);
    for (const visible of [false, true]) {
      gl.colorMask(visible, visible, visible, visible);
      report.segments.forEach((segment, i) => painter.hull(this.parts[i], placement(segment.places, frame), color(segment), GLASS));
    }
    gl.colorMask(true, true, true, true);
  }

  // Index of the muscle at a place of the canvas, px; -1 for none.
  muscleAt(x, y) {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    return this.showsMuscles ? this.tubes.nearest(x, y, this.camera.projection(width / height), width, height) : -1;
  }

  drawSegments(frame, measure) {
    this.painter.flatness(0);
    const color = this.colors(frame, measure);
    if (this.skin && !this.wooden) return this.skin.draw(frame, measure, color);
    report.segments.forEach((segment, i) => this.painter.hull(this.parts[i], placement(segment.places, frame), color(segment)));
  }

  drawThings(frame, color, alpha) {
    for (const { places, size, putDown } of report.things) {
      if (putDown !== null && frame >= putDown) continue;
      const place = stretched(placement(places, frame), size);
      this.painter.list(this.boxFaces, color, alpha, place);
      if (alpha < 1) this.painter.list(this.boxEdges, color, EDGES, place);
    }
  }

  // Surfaces and things as solid pale pieces, in order of their depth; the body is drawn over all of them.
  drawBehind(frame) {
    const { gl, painter } = this, scene = styleColor("--scene");
    const pale = (name) => styleColor(name).map((c, k) => c + (scene[k] - c) * PALE);
    painter.flatness(0.25);
    for (const { mesh } of this.slabs) painter.list(mesh, pale("--surface"), 1);
    this.drawThings(frame, pale("--thing"), 1);
    gl.clear(gl.DEPTH_BUFFER_BIT);
  }

  // The start as a ghost: first its depth, then its nearest surface only, so that overlapping parts are not darker.
  drawGhost(frame) {
    const moved = (segment) => segment.start.some((column, k) => Math.abs(column[0] - segment.places[k][frame]) > 1e-3);
    if (!report.segments.some(moved)) return;
    const { gl, painter } = this, color = styleColor("--ghost");
    painter.flatness(0);
    for (const visible of [false, true]) {
      gl.colorMask(visible, visible, visible, visible);
      if (this.skin && !this.wooden) {
        painter.painted(this.skin.ghost, color, 0.24);
        continue;
      }
      report.segments.forEach((segment, i) => {
        if (moved(segment)) painter.hull(this.parts[i], placement(segment.start, 0), color, 0.24);
      });
    }
    gl.colorMask(true, true, true, true);
  }

  // Contact forces, loads, centre of mass with its plumb line, targets.
  drawMarks(frame, alpha) {
    const at = (columns) => columns.map((column) => column[frame]);
    const dot = (point, size, height, color) => this.painter.hull(this.ball, scaledAt(point, size, height), color, alpha);
    for (const support of report.supports) this.drawForce(at(support.at), at(support.force), "--force", alpha);
    // Nothing hides a load.
    for (const load of report.loads) this.drawForce(at(load.at), at(load.force), "--load", 1, SHORTEST_LOAD, true);
    if (report.center) {
      const [x, y, z] = at(report.center), color = styleColor("--center"), ground = report.ground;
      dot([x, y, z], 0.03, 0.03, color);
      if (ground !== null) {
        this.painter.hull(this.shaft, pointing([x, ground, z], [0, 1, 0], 0.35, y - ground), color, alpha);
        dot([x, ground + 0.002, z], 0.025, 0.004, color);
      }
    }
    if (report.solid) dot(report.solid.at, 0.012, 0.012, styleColor("--center"));
    for (const { at: place, from } of report.targets) {
      dot(at(place), 0.022, 0.022, styleColor("--target"));
      if (from) this.drawMiss(at(from), at(place), alpha);
    }
  }

  // A line from a point of the body to the target that it misses; to one far away an arrow.
  drawMiss(from, to, alpha) {
    const way = to.map((v, k) => v - from[k]), length = Math.hypot(...way), color = styleColor("--target");
    if (length < NEAR_TARGET) return;
    const far = length > FAR_TARGET, drawn = far ? FAR_ARROW : length;
    const tip = from.map((v, k) => v + way[k] * drawn / length);
    this.painter.hull(this.shaft, pointing(from, way, 0.7, far ? drawn - ARROW_HEAD : drawn), color, alpha);
    if (far) this.painter.hull(this.tip, pointing(tip, way, 1, 1), color, alpha);
  }

  // An arrow in proportion to the force on the body, but not shorter than `shortest`; none of a force of next to nothing. A load that pulls
  // down hangs at its point; `presses`: any other one ends there, as a hand that presses on the body.
  drawForce(point, force, colorName, alpha, shortest = 0, presses = false) {
    const wanted = Math.hypot(...force) * ARROW_OF_WEIGHT / this.weight, length = Math.max(wanted, shortest);
    if (wanted < SHORTEST_ARROW) return;
    const arrow = unit(force).map((v) => v * length);
    const hangs = !presses || -force[1] > PULLS_DOWN * Math.hypot(...force);
    const color = styleColor(colorName), foot = hangs ? point : point.map((v, k) => v - arrow[k]), tip = foot.map((v, k) => v + arrow[k]);
    this.painter.hull(this.shaft, pointing(foot, arrow, 1, Math.max(0.001, length - ARROW_HEAD)), color, alpha);
    this.painter.hull(this.tip, pointing(tip, arrow, 1, 1), color, alpha);
  }

  // A muscle at the place is chosen, and the limb there only where no muscle is.
  click(x, y) {
    const muscle = this.muscleAt(x, y);
    this.onMuscle(muscle, true);
    if (muscle < 0) this.onPick(this.pick(x, y));
  }

  lookFrom(view) {
    this.camera.lookFrom(view);
    this.onTurn(view);
  }

  // One finger or the mouse turns the body, two fingers or the wheel magnify it; a click, which moves nothing, picks a segment.
  listen() {
    const { canvas, camera, onTurn } = this, fingers = new Map();
    let pressed = null;
    const moved = (event) => Math.hypot(event.clientX - pressed.clientX, event.clientY - pressed.clientY);
    const spread = () => {
      const [a, b] = [...fingers.values()];
      return Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY);
    };
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      fingers.set(event.pointerId, event);
      pressed = fingers.size === 1 ? event : null;
    });
    canvas.addEventListener("pointermove", (event) => {
      const before = fingers.get(event.pointerId);
      if (!before) return this.onMuscle(this.muscleAt(event.offsetX, event.offsetY), false);
      const spreadBefore = fingers.size === 2 ? spread() : 0;
      fingers.set(event.pointerId, event);
      if (pressed && moved(event) < LEAST_DRAG) return;
      pressed = null;
      if (fingers.size === 2) camera.magnify(spread() / (spreadBefore || 1) || 1);
      else camera.turn((event.clientX - before.clientX) * 0.008, (event.clientY - before.clientY) * 0.006);
      onTurn(null);
    });
    for (const end of ["pointerup", "pointercancel"]) {
      canvas.addEventListener(end, (event) => {
        fingers.delete(event.pointerId);
        if (end === "pointerup" && pressed) this.click(event.offsetX, event.offsetY);
        pressed = null;
      });
    }
    canvas.addEventListener("pointerleave", () => this.onMuscle(-1, false));
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      const { clientWidth: width, clientHeight: height } = canvas;
      const place = [(2 * event.offsetX - width) / height, 1 - 2 * event.offsetY / height];
      camera.magnify(Math.exp(-event.deltaY * 0.0012), place, width / height);
      onTurn(null);
    }, { passive: false });
  }
}
