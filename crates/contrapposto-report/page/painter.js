// Draws meshes with WebGL: one shader program, one light, and a little light from everywhere.
const VERTEX_SHADER = `
  attribute vec3 point, normal, paint;
  uniform mat4 place, view;
  varying vec3 facing, painted;
  void main() {
    painted = paint;
    facing = mat3(place) * normal;
    gl_Position = view * place * vec4(point, 1.0);
  }`;
const FRAGMENT_SHADER = `
  precision mediump float;
  uniform vec4 color;
  uniform vec3 light, eye;
  uniform float flatness;
  varying vec3 facing, painted;
  void main() {
    vec3 n = normalize(facing);
    // A surface that faces the viewer has its own colour, as in the key; those turned away are darker, none is brighter.
    float shade = min(1.0, 0.66 + 0.1 * n.y + 0.66 * max(dot(n, light), 0.0));
    shade *= 0.72 + 0.28 * smoothstep(0.0, 0.55, abs(dot(n, eye)));
    gl_FragColor = vec4(color.rgb * painted * mix(shade, 1.0, flatness), color.a);
  }`;

// Red, green and blue of a colour of the style sheet, each 0 to 1.
function styleColor(name) {
  const value = getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const hex = value.replace(/^#(.)(.)(.)$/, "#$1$1$2$2$3$3");
  return [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16) / 255);
}

class Painter {
  // The browser compiles the program while meshes are made; `start` waits for it.
  constructor(gl) {
    this.gl = gl;
    this.program = gl.createProgram();
    for (const [kind, source] of [[gl.VERTEX_SHADER, VERTEX_SHADER], [gl.FRAGMENT_SHADER, FRAGMENT_SHADER]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      gl.attachShader(this.program, shader);
    }
    gl.linkProgram(this.program);
    const triangles = sphereTriangles();
    this.directions = sphereDirections();
    this.hullTriangles = { count: triangles.length, data: this.buffer(gl.ELEMENT_ARRAY_BUFFER, new Uint16Array(triangles)) };
  }

  buffer(kind, data) {
    const made = this.gl.createBuffer();
    this.gl.bindBuffer(kind, made);
    this.gl.bufferData(kind, data, this.gl.STATIC_DRAW);
    return made;
  }

  // A mesh of the hull of balls, for `hull`.
  hullMesh(balls) {
    return this.buffer(this.gl.ARRAY_BUFFER, new Float32Array(hullPoints(balls, this.directions)));
  }

  // A mesh of separate triangles or lines, for `list`.
  listMesh(kind, points) {
    return { kind, count: points.length / 6, data: this.buffer(this.gl.ARRAY_BUFFER, new Float32Array(points)) };
  }

  // A mesh of triangles whose points and colours change, for `fillPoints`, `fillPaint` and `painted`.
  paintedMesh(triangles, count) {
    const gl = this.gl, empty = (size) => this.buffer(gl.ARRAY_BUFFER, new Float32Array(size * count));
    return { count: triangles.length, triangles: this.buffer(gl.ELEMENT_ARRAY_BUFFER, triangles), points: empty(6), paint: empty(3) };
  }

  fillPoints(mesh, points) {
    this.gl.bindBuffer(this.gl.ARRAY_BUFFER, mesh.points);
    this.gl.bufferSubData(this.gl.ARRAY_BUFFER, 0, points);
  }

  fillPaint(mesh, paint) {
    this.gl.bindBuffer(this.gl.ARRAY_BUFFER, mesh.paint);
    this.gl.bufferSubData(this.gl.ARRAY_BUFFER, 0, paint);
  }

  start() {
    const gl = this.gl;
    gl.useProgram(this.program);
    this.uniforms = {};
    for (const name of ["place", "view", "color", "light", "eye", "flatness"]) {
      this.uniforms[name] = gl.getUniformLocation(this.program, name);
    }
    [this.point, this.normal, this.paint] = ["point", "normal", "paint"].map((name) => gl.getAttribLocation(this.program, name));
    gl.enableVertexAttribArray(this.point);
    gl.enableVertexAttribArray(this.normal);
    gl.vertexAttrib3f(this.paint, 1, 1, 1);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
  }

  // Clears the picture and sets the camera.
  clear(width, height, background, camera) {
    const gl = this.gl;
    gl.viewport(0, 0, width, height);
    gl.clearColor(...background, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.uniformMatrix4fv(this.uniforms.view, false, camera.projection(width / height));
    gl.uniform3fv(this.uniforms.light, camera.light());
    gl.uniform3fv(this.uniforms.eye, camera.axes().back);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.hullTriangles.data);
    gl.disable(gl.BLEND);
  }

  // Share of the plain colour, against the shaded one.
  flatness(share) {
    this.gl.uniform1f(this.uniforms.flatness, share);
  }

  hull(mesh, matrix, color, alpha = 1) {
    this.use(mesh, matrix, color, alpha);
    this.gl.drawElements(this.gl.TRIANGLES, this.hullTriangles.count, this.gl.UNSIGNED_SHORT, 0);
  }

  // A mesh with a colour for every vertex, times `color`.
  painted(mesh, color, alpha) {
    const gl = this.gl;
    gl.bindBuffer(gl.ARRAY_BUFFER, mesh.paint);
    gl.enableVertexAttribArray(this.paint);
    gl.vertexAttribPointer(this.paint, 3, gl.FLOAT, false, 12, 0);
    this.use(mesh.points, IDENTITY, color, alpha);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, mesh.triangles);
    gl.drawElements(gl.TRIANGLES, mesh.count, gl.UNSIGNED_SHORT, 0);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.hullTriangles.data);
    gl.disableVertexAttribArray(this.paint);
    gl.vertexAttrib3f(this.paint, 1, 1, 1);
  }

  list(mesh, color, alpha, matrix = IDENTITY) {
    this.use(mesh.data, matrix, color, alpha);
    this.gl.drawArrays(mesh.kind, 0, mesh.count);
  }

  use(data, matrix, color, alpha) {
    const gl = this.gl;
    gl.bindBuffer(gl.ARRAY_BUFFER, data);
    gl.vertexAttribPointer(this.point, 3, gl.FLOAT, false, 24, 0);
    gl.vertexAttribPointer(this.normal, 3, gl.FLOAT, false, 24, 12);
    gl.uniformMatrix4fv(this.uniforms.place, false, matrix);
    gl.uniform4f(this.uniforms.color, ...color, alpha);
  }
}
