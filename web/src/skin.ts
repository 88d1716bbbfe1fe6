// The skin of the built-in adult: vertices that follow bones by their weights, each coloured as the segments that move it.
import { BufferAttribute, BufferGeometry, type Color, Matrix4, Mesh, MeshLambertMaterial, Quaternion, Vector3 } from "three";
import type { Place, SkinScene } from "./messages";

/** Brightness of light as an eye sees it (sRGB), as an amount of light. */
const amount = (seen: number) => seen ** 2.2;

export class Skin {
  readonly mesh: Mesh<BufferGeometry, MeshLambertMaterial>;
  private readonly places: BufferAttribute;
  private readonly normals: BufferAttribute;
  private readonly colours: BufferAttribute;
  private readonly rest: Float32Array;
  private readonly restNormals: Float32Array;
  private readonly light: Float32Array;

  constructor(private readonly scene: SkinScene) {
    const geometry = new BufferGeometry();
    this.rest = new Float32Array(scene.vertices.flat());
    this.places = new BufferAttribute(this.rest.slice(), 3);
    geometry.setAttribute("position", this.places);
    geometry.setIndex(scene.triangles.flat());
    geometry.computeVertexNormals();
    this.normals = geometry.getAttribute("normal") as BufferAttribute;
    this.restNormals = (this.normals.array as Float32Array).slice();
    this.colours = new BufferAttribute(new Float32Array(this.rest.length), 3);
    geometry.setAttribute("color", this.colours);
    this.light = Float32Array.from(scene.light, (share) => amount(share / 255));
    this.mesh = new Mesh(geometry, new MeshLambertMaterial({ vertexColors: true }));
    this.mesh.frustumCulled = false;
  }

  /** Moves all vertices with the bones. */
  move(bones: Place[]): void {
    const { vertices, heads, bones: of, weights } = this.scene;
    const matrices = bones.map(([x, y, z, i, j, k, w], bone) => {
      const [hx, hy, hz] = heads[bone];
      const moved = new Matrix4().compose(new Vector3(x, y, z), new Quaternion(i, j, k, w), new Vector3(1, 1, 1));
      return moved.multiply(new Matrix4().makeTranslation(-hx, -hy, -hz)).elements;
    });
    const [places, normals] = [this.places.array, this.normals.array];
    for (let v = 0; v < vertices.length; v++) {
      const at = 3 * v;
      const [x, y, z] = [this.rest[at], this.rest[at + 1], this.rest[at + 2]];
      const [nx, ny, nz] = [this.restNormals[at], this.restNormals[at + 1], this.restNormals[at + 2]];
      let [a, b, c, p, q, r] = [0, 0, 0, 0, 0, 0];
      for (let i = 0; i < 4; i++) {
        const weight = weights[v][i] / 255;
        if (weight === 0) continue;
        const m = matrices[of[v][i]];
        a += weight * (m[0] * x + m[4] * y + m[8] * z + m[12]);
        b += weight * (m[1] * x + m[5] * y + m[9] * z + m[13]);
        c += weight * (m[2] * x + m[6] * y + m[10] * z + m[14]);
        p += weight * (m[0] * nx + m[4] * ny + m[8] * nz);
        q += weight * (m[1] * nx + m[5] * ny + m[9] * nz);
        r += weight * (m[2] * nx + m[6] * ny + m[10] * nz);
      }
      [places[at], places[at + 1], places[at + 2]] = [a, b, c];
      // The shader gives normals their length.
      [normals[at], normals[at + 1], normals[at + 2]] = [p, q, r];
    }
    this.places.needsUpdate = this.normals.needsUpdate = true;
    // A ray that looks for the skin asks for its bounds anew.
    this.mesh.geometry.boundingSphere = null;
  }

  /** Gives the colours of segments over to vertices by their weights. */
  paint(ofSegment: Color[]): void {
    const { vertices, bones, weights, segments } = this.scene;
    const colours = this.colours.array;
    for (let v = 0; v < vertices.length; v++) {
      let [r, g, b] = [0, 0, 0];
      for (let i = 0; i < 4; i++) {
        const weight = weights[v][i] / 255;
        if (weight === 0) continue;
        const colour = ofSegment[segments[bones[v][i]]];
        r += weight * colour.r;
        g += weight * colour.g;
        b += weight * colour.b;
      }
      [colours[3 * v], colours[3 * v + 1], colours[3 * v + 2]] = [r * this.light[v], g * this.light[v], b * this.light[v]];
    }
    this.colours.needsUpdate = true;
  }

  /** The segment that moves a vertex most. */
  segmentAt(vertex: number): number {
    const weights = this.scene.weights[vertex];
    return this.scene.segments[this.scene.bones[vertex][weights.indexOf(Math.max(...weights))]];
  }
}
