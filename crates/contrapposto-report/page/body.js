// The body in three dimensions: every part is the hull of a few balls, drawn with WebGL. Ground axes: y up.
function Body(canvas, onTurn) {
  const gl = canvas.getContext("webgl", { alpha: false, antialias: true, preserveDrawingBuffer: true });
  if (!gl) return null;
  const RINGS = 16, SLICES = 24;
  const cross = (p, q) => [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]];

  // --- Shaders: a light from above the left shoulder of who looks, and a little from everywhere. They are
  // compiled elsewhere while meshes are made here.
  const shader = (kind, source) => {
    const made = gl.createShader(kind);
    gl.shaderSource(made, source);
    gl.compileShader(made);
    return made;
  };
  const program = gl.createProgram();
  gl.attachShader(program, shader(gl.VERTEX_SHADER, `
    attribute vec3 point, normal;
    uniform mat4 place, view;
    varying vec3 facing;
    void main() {
      facing = mat3(place) * normal;
      gl_Position = view * place * vec4(point, 1.0);
    }`));
  gl.attachShader(program, shader(gl.FRAGMENT_SHADER, `
    precision mediump float;
    uniform vec4 color;
    uniform vec3 light, eye;
    uniform float flat_;
    varying vec3 facing;
    void main() {
      vec3 n = normalize(facing);
      float shade = 0.58 + 0.2 * n.y + 0.34 * max(dot(n, light), 0.0);
      shade *= 0.72 + 0.28 * smoothstep(0.0, 0.55, abs(dot(n, eye)));
      gl_FragColor = vec4(color.rgb * mix(shade, 1.0, flat_), color.a);
    }`));
  gl.linkProgram(program);

  // --- Meshes: one triangle list a part; a normal a point.
  const directions = [];
  for (let ring = 0; ring <= RINGS; ring++) {
    for (let slice = 0; slice <= SLICES; slice++) {
      const a = Math.PI * ring / RINGS, b = 2 * Math.PI * slice / SLICES;
      directions.push([Math.sin(a) * Math.cos(b), Math.cos(a), Math.sin(a) * Math.sin(b)]);
    }
  }
  const corners = [];
  for (let ring = 0; ring < RINGS; ring++) {
    for (let slice = 0; slice < SLICES; slice++) {
      const a = ring * (SLICES + 1) + slice, b = a + SLICES + 1;
      corners.push(a, a + 1, b, a + 1, b + 1, b);
    }
  }
  const buffer = (kind, data) => {
    const made = gl.createBuffer();
    gl.bindBuffer(kind, made);
    gl.bufferData(kind, data, gl.STATIC_DRAW);
    return made;
  };
  const cornerBuffer = buffer(gl.ELEMENT_ARRAY_BUFFER, new Uint16Array(corners));
  // The farthest point of the hull in each direction.
  const hull = (balls) => {
    const points = [];
    for (const d of directions) {
      let best = null, reach = -Infinity;
      for (const ball of balls) {
        const far = ball[0] * d[0] + ball[1] * d[1] + ball[2] * d[2] + ball[3];
        if (far > reach) [reach, best] = [far, ball];
      }
      points.push(best[0] + best[3] * d[0], best[1] + best[3] * d[1], best[2] + best[3] * d[2], ...d);
    }
    return buffer(gl.ARRAY_BUFFER, new Float32Array(points));
  };
  const parts = report.segments.map((segment) => hull(segment.balls));
  const ball = hull([[0, 0, 0, 1]]);
  const shaft = hull([[0, 0, 0, 0.012], [0, 1, 0, 0.012]]);
  const tip = hull([[0, -0.09, 0, 0.034], [0, -0.002, 0, 0.002]]);
  // Seats, tables, walls: a thin slab each, its faces as triangles and its edges as lines.
  const slabs = report.surfaces.map((top) => {
    const [u, v] = [1, 3].map((i) => top[i].map((x, k) => x - top[0][k]));
    const across = cross(u, v), size = Math.hypot(...across) || 1, down = across.map((x) => -x / size);
    const bottom = top.map((corner) => corner.map((x, k) => x + 0.025 * down[k]));
    const faces = [], edges = [], add = (list, corner, n) => list.push(...corner, ...n);
    const face = (a, b, c, d, n) => { for (const corner of [a, b, c, a, c, d]) add(faces, corner, n); };
    face(...top, down.map((x) => -x));
    face(...bottom, down);
    top.forEach((a, i) => {
      const j = (i + 1) % 4, out = cross(top[j].map((x, k) => x - a[k]), down), length = Math.hypot(...out) || 1;
      face(a, top[j], bottom[j], bottom[i], out.map((x) => x / length));
      for (const corner of [a, top[j], bottom[i], bottom[j], a, bottom[i]]) add(edges, corner, [0, 1, 0]);
    });
    return [[gl.TRIANGLES, faces, 0.45], [gl.LINES, edges, 0.85]].map(([kind, list, alpha]) => ({ kind, alpha, count: list.length / 6, data: buffer(gl.ARRAY_BUFFER, new Float32Array(list)) }));
  });

  gl.useProgram(program);
  const at = (name) => gl.getUniformLocation(program, name);
  const place = at("place"), view = at("view"), color = at("color"), light = at("light"), eye = at("eye"), flat = at("flat_");
  const point = gl.getAttribLocation(program, "point"), normal = gl.getAttribLocation(program, "normal");
  gl.enableVertexAttribArray(point);
  gl.enableVertexAttribArray(normal);
  gl.enable(gl.DEPTH_TEST);
  gl.depthFunc(gl.LEQUAL);
  gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);

  // --- Where things are: matrices in columns.
  const placed = (p, frame) => {
    const [x, y, z, w, a, b, c] = p.map((column) => column[frame]);
    const s = 2 / (w * w + a * a + b * b + c * c || 1);
    return [
      1 - s * (b * b + c * c), s * (a * b + c * w), s * (a * c - b * w), 0,
      s * (a * b - c * w), 1 - s * (a * a + c * c), s * (b * c + a * w), 0,
      s * (a * c + b * w), s * (b * c - a * w), 1 - s * (a * a + b * b), 0, x, y, z, 1];
  };
  // A matrix that takes the y axis to `along` (of any length) at `from`; across it, size `thick`.
  const pointing = (from, along, thick, stretch) => {
    const length = Math.hypot(...along) || 1, y = along.map((v) => v / length);
    const k = Math.abs(y[0]) < 0.9 ? [1, 0, 0] : [0, 0, 1];
    const across = cross(k, y), size = Math.hypot(...across), x = across.map((v) => v / size), z = cross(x, y);
    return [...x.map((v) => v * thick), 0, ...y.map((v) => v * stretch), 0, ...z.map((v) => v * thick), 0, ...from, 1];
  };

  // --- The space that everything takes: the eye looks at its middle.
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  const frames = Array.from({ length: 12 }, (_, i) => Math.round(i / 11 * (report.frames - 1)));
  const reach = (k, from, to) => {
    low[k] = Math.min(low[k], from);
    high[k] = Math.max(high[k], to);
  };
  for (const segment of report.segments) {
    for (const m of [placed(segment.start, 0), ...frames.map((frame) => placed(segment.places, frame))]) {
      for (const [x, y, z, r] of segment.balls) {
        for (let k = 0; k < 3; k++) {
          const c = m[k] * x + m[4 + k] * y + m[8 + k] * z + m[12 + k];
          reach(k, c - r, c + r);
        }
      }
    }
  }
  for (const corner of [...report.surfaces.flat(), ...report.targets]) corner.forEach((c, k) => reach(k, c, c));
  const middle = low.map((v, k) => (v + high[k]) / 2 || 0);
  const tall = Math.max(0.3, high[1] - low[1]) || 1, wide = Math.max(0.2, Math.hypot(high[0] - low[0], high[2] - low[2])) || 1;
  const floor = report.ground;
  const ground = [];
  for (let i = -6; i <= 6; i++) {
    const [x, z] = [Math.round(4 * middle[0]) / 4, Math.round(4 * middle[2]) / 4];
    ground.push(x - 1.5, floor, z + i / 4, 0, 1, 0, x + 1.5, floor, z + i / 4, 0, 1, 0);
    ground.push(x + i / 4, floor, z - 1.5, 0, 1, 0, x + i / 4, floor, z + 1.5, 0, 1, 0);
  }
  const grid = buffer(gl.ARRAY_BUFFER, new Float32Array(ground));

  // --- From where it is seen: yaw 0 is from the front, from the body's right at a quarter turn.
  const camera = { yaw: 0.45, pitch: 0.14, near: 1 };
  const look = (width, height) => {
    const fov = 0.45, spread = Math.tan(fov / 2), aspect = width / height;
    const distance = Math.max(tall / 1.75, wide / (1.85 * aspect)) / spread / camera.near + wide / 3;
    const [sy, cy, sp, cp] = [Math.sin(camera.yaw), Math.cos(camera.yaw), Math.sin(camera.pitch), Math.cos(camera.pitch)];
    const back = [cp * cy, sp, cp * sy], right = [sy, 0, -cy], up = [-sp * cy, cp, -sp * sy];
    const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    const f = 1 / spread, nearest = 0.05, farthest = distance + 20, d = nearest - farthest;
    const axes = [right, up, back], shift = [-dot(right, middle), -dot(up, middle), -dot(back, middle) - distance];
    const m = [];
    for (let k = 0; k < 4; k++) {
      const [x, y, z] = k < 3 ? axes.map((axis) => axis[k]) : shift;
      m.push(f / aspect * x, f * y, (nearest + farthest) / d * z + (k < 3 ? 0 : 2 * nearest * farthest / d), -z);
    }
    gl.uniformMatrix4fv(view, false, m);
    const l = [0, 1, 2].map((k) => 0.55 * back[k] + 0.7 * up[k] - 0.45 * right[k]), length = Math.hypot(...l);
    gl.uniform3fv(light, l.map((v) => v / length));
    gl.uniform3fv(eye, back);
  };

  const ready = (data, matrix, rgb, alpha) => {
    gl.bindBuffer(gl.ARRAY_BUFFER, data);
    gl.vertexAttribPointer(point, 3, gl.FLOAT, false, 24, 0);
    gl.vertexAttribPointer(normal, 3, gl.FLOAT, false, 24, 12);
    gl.uniformMatrix4fv(place, false, matrix);
    gl.uniform4f(color, ...rgb, alpha);
  };
  const mesh = (part, matrix, rgb, alpha = 1) => {
    ready(part, matrix, rgb, alpha);
    gl.drawElements(gl.TRIANGLES, corners.length, gl.UNSIGNED_SHORT, 0);
  };
  const here = (data, kind, count, rgb, alpha) => {
    ready(data, [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1], rgb, alpha);
    gl.drawArrays(kind, 0, count);
  };
  const paint = (name) => {
    const hex = getComputedStyle(document.documentElement).getPropertyValue(name).trim().replace(/^#(.)(.)(.)$/, "#$1$1$2$2$3$3");
    return [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16) / 255);
  };
  // Half a metre for the weight of the body.
  let weight = 0;
  for (let i = 0; i < report.frames; i++) {
    weight = Math.max(weight, Math.hypot(...[0, 1, 2].map((k) => report.supports.reduce((sum, s) => sum + s.force[k][i], 0))));
  }
  const marks = (frame, alpha) => {
    const force = paint("--force"), center = paint("--center");
    for (const support of report.supports) {
      const arrow = support.force.map((column) => column[frame] * 0.6 / (weight || 1)), length = Math.hypot(...arrow);
      if (length < 0.012) continue;
      const foot = support.at.map((column) => column[frame]);
      mesh(shaft, pointing(foot, arrow, 1, Math.max(0.001, length - 0.09)), force, alpha);
      mesh(tip, pointing(foot.map((v, k) => v + arrow[k]), arrow, 1, 1), force, alpha);
    }
    const spot = (at, size, flat, rgb) => mesh(ball, [size, 0, 0, 0, 0, flat, 0, 0, 0, 0, size, 0, ...at, 1], rgb, alpha);
    if (report.center) {
      const [x, y, z] = report.center.map((column) => column[frame]);
      spot([x, y, z], 0.03, 0.03, center);
      if (floor !== null) {
        mesh(shaft, pointing([x, floor, z], [0, 1, 0], 0.35, y - floor), center, alpha);
        spot([x, floor + 0.002, z], 0.025, 0.004, center);
      }
    }
    for (const target of report.targets) spot(target, 0.022, 0.022, paint("--target"));
  };

  function draw(frame, measure) {
    const scale = window.devicePixelRatio || 1;
    const [width, height] = [Math.round(canvas.clientWidth * scale), Math.round(canvas.clientHeight * scale)];
    if (!width || !height) return;
    if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
    gl.viewport(0, 0, width, height);
    gl.clearColor(...paint("--scene"), 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    look(width, height);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, cornerBuffer);
    gl.disable(gl.BLEND);
    gl.uniform1f(flat, 1);
    if (floor !== null) here(grid, gl.LINES, ground.length / 6, paint("--ground"), 1);
    gl.uniform1f(flat, 0);
    const unknown = paint("--none");
    report.segments.forEach((segment, i) => {
      const share = measure.of(segment, frame);
      mesh(parts[i], placed(segment.places, frame), share === null ? unknown : colorOf(measure, share));
    });
    gl.uniform1f(flat, 0.35);
    marks(frame, 1);
    // Seats, tables, walls: what is behind them shines through.
    gl.uniform1f(flat, 0.6);
    gl.enable(gl.BLEND);
    gl.depthMask(false);
    for (const { data, kind, count, alpha } of slabs.flat()) here(data, kind, count, paint("--surface"), alpha);
    gl.depthMask(true);
    // The start as a ghost: only its nearest surface, so that overlapping parts are not darker.
    gl.uniform1f(flat, 0);
    const ghost = paint("--ghost");
    const moved = report.segments.some((s) => s.start.some((column, k) => Math.abs(column[0] - s.places[k][frame]) > 1e-3));
    for (const pass of moved ? [false, true] : []) {
      gl.colorMask(pass, pass, pass, pass);
      report.segments.forEach((segment, i) => mesh(parts[i], placed(segment.start, 0), ghost, 0.24));
    }
    gl.colorMask(true, true, true, true);
    gl.disable(gl.DEPTH_TEST);
    gl.uniform1f(flat, 1);
    marks(frame, 0.4);
    gl.enable(gl.DEPTH_TEST);
  }

  // --- Orbit: one finger or the mouse turns, two fingers or the wheel come nearer.
  const fingers = new Map();
  const turn = (yaw, pitch) => {
    camera.yaw += yaw;
    camera.pitch = Math.min(1.5, Math.max(-0.4, camera.pitch + pitch));
    onTurn(null);
  };
  const nearer = (factor) => {
    camera.near = Math.min(6, Math.max(0.4, camera.near * factor));
    onTurn(null);
  };
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, event);
  });
  canvas.addEventListener("pointermove", (event) => {
    const before = fingers.get(event.pointerId);
    if (!before) return;
    const apart = () => { const [a, b] = [...fingers.values()]; return Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY); };
    const was = fingers.size === 2 ? apart() : 0;
    fingers.set(event.pointerId, event);
    if (fingers.size === 2) nearer(apart() / (was || 1) || 1);
    else turn((event.clientX - before.clientX) * 0.008, (event.clientY - before.clientY) * 0.006);
  });
  for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, (event) => fingers.delete(event.pointerId));
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    nearer(Math.exp(-event.deltaY * 0.0012));
  }, { passive: false });

  const VIEWS = { front: [0, 0.06], side: [Math.PI / 2, 0.06], between: [0.45, 0.14] };
  return {
    draw,
    camera,
    from(name) {
      [camera.yaw, camera.pitch] = VIEWS[name];
      onTurn(name);
    },
  };
}
