// The picture: the body with its loads in colour, contact forces, centre of mass, held points, things; and the hand that drags.
import {
  ArrowHelper,
  BoxGeometry,
  Color,
  DirectionalLight,
  EdgesGeometry,
  GridHelper,
  Group,
  HemisphereLight,
  Line,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshBasicMaterial,
  MeshLambertMaterial,
  type Object3D,
  PerspectiveCamera,
  Plane,
  Raycaster,
  Scene as World,
  SphereGeometry,
  Vector2,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { colourOf } from "./colours";
import { hull } from "./figure";
import type { Handle, Place, Scene, Shown, SkinScene, Vector } from "./messages";
import { Skin } from "./skin";

/** Length of an arrow of the whole weight, m. */
const ARROW = 0.6;

/** Directions from which the body is looked at: x ahead, y up, z right. */
const SIDES = {
  aslant: [2.25, 0.55, 2.1],
  front: [1, 0.08, 0],
  right: [0, 0.08, 1],
  back: [-1, 0.08, 0],
  left: [0, 0.08, -1],
} satisfies Record<string, Vector>;
export type Side = keyof typeof SIDES;
export const sides = Object.keys(SIDES) as Side[];

/** Width and height of a small picture, px. */
const PICTURE = [192, 288] as const;

/** What the view tells the page. */
export interface Dragging {
  grab(segment: string, point: Vector): void;
  drag(target: Vector): void;
  release(): void;
}

/** The ball that all marks share. */
const BALL = new SphereGeometry(1, 16, 12);

/** Takes an object out of the picture, and its shapes and materials off the graphics card. All balls, and all arrows, share their shapes. */
function discard(object: Object3D): void {
  object.removeFromParent();
  object.traverse((part) => {
    if (!(part instanceof Mesh || part instanceof Line)) return;
    if (part.geometry !== BALL && !(part.parent instanceof ArrowHelper)) part.geometry.dispose();
    for (const material of [part.material].flat()) material.dispose();
  });
}

function put(object: Group, place: Place): void {
  object.position.set(place[0], place[1], place[2]);
  object.quaternion.set(place[3], place[4], place[5], place[6]);
}

export class View {
  private readonly renderer: WebGLRenderer;
  private readonly world = new World();
  private readonly camera = new PerspectiveCamera(40, 1, 0.05, 60);
  private readonly controls: OrbitControls;
  private body = new Group();
  private marks = new Group();
  private segments: Group[] = [];
  private materials: MeshLambertMaterial[][] = [];
  private solids: Mesh[] = [];
  private things: Group[] = [];
  private pulled?: ArrowHelper;
  private scene?: Scene;
  private shown?: Shown;
  private skin?: Skin;
  private woodenOnly = false;
  /** Of the body that is shown: another number for another body. */
  private bodyNumber = 0;
  private due = false;
  private readonly colours = new Map<string, Color>();

  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly dragging: Dragging,
  ) {
    this.renderer = new WebGLRenderer({ canvas, antialias: true, preserveDrawingBuffer: true });
    this.camera.position.set(1.95, 1.35, 1.8);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.target.set(0.05, 0.87, 0);
    this.controls.enablePan = false;
    this.controls.minDistance = 0.8;
    this.controls.maxDistance = 8;
    this.controls.addEventListener("change", () => this.redraw());
    this.world.add(new HemisphereLight("#ffffff", "#a3a8b0", 2.9), this.body, this.marks, this.camera);
    // A lamp beside the eye: no side of the body is dark.
    const lamp = new DirectionalLight("#ffffff", 1.3);
    lamp.position.set(1, 2, 1.5);
    this.camera.add(lamp);
    this.listen();
    new ResizeObserver(() => this.redraw()).observe(canvas);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
      this.colours.clear();
      this.paint();
    });
    this.controls.update();
  }

  /** Looks at the middle of what is shown from a side, as far away as now. */
  lookFrom(side: Side): void {
    const { target } = this.controls;
    const distance = this.camera.position.distanceTo(target);
    this.camera.position.copy(target).addScaledVector(new Vector3(...SIDES[side]).normalize(), distance);
    this.controls.update();
  }

  /** Another body or another job. */
  open(scene: Scene): void {
    const before = this.scene;
    this.scene = scene;
    this.things.forEach((thing) => discard(thing));
    if (JSON.stringify(before?.segments) !== JSON.stringify(scene.segments)) this.build(scene);
    this.things = scene.things.map(({ size, place, segment }) => {
      const box = new BoxGeometry(...size);
      const group = new Group();
      const colour = this.colour("--thing");
      group.add(new Mesh(box, new MeshLambertMaterial({ color: colour, transparent: true, opacity: 0.35 })));
      group.add(new LineSegments(new EdgesGeometry(box), new LineBasicMaterial({ color: colour })));
      put(group, place);
      (segment === null ? this.world : this.segments[segment]).add(group);
      return group;
    });
    this.show(scene.shown, scene.held);
  }

  private build(scene: Scene): void {
    if (this.skin) discard(this.skin.mesh);
    this.skin = undefined;
    this.bodyNumber++;
    this.segments.forEach((segment) => discard(segment));
    this.segments = [];
    [this.materials, this.solids] = [[], []];
    for (const [index, segment] of scene.segments.entries()) {
      const group = new Group();
      const materials: MeshLambertMaterial[] = [];
      for (const balls of segment.hulls) {
        const material = new MeshLambertMaterial();
        const mesh = new Mesh(hull(balls), material);
        mesh.userData.segment = index;
        this.solids.push(mesh);
        materials.push(material);
        group.add(mesh);
      }
      this.segments.push(group);
      this.materials.push(materials);
      this.body.add(group);
    }
  }

  /** Names the body that is shown. */
  get bodyShown(): number {
    return this.bodyNumber;
  }

  /** Whether the body has its skin, shown or not. */
  get dressed(): boolean {
    return this.skin !== undefined;
  }

  /** The wooden figure is shown though there is a skin. */
  get wooden(): boolean {
    return this.woodenOnly;
  }

  set wooden(wooden: boolean) {
    this.woodenOnly = wooden;
    this.showFigure();
  }

  /** Gives the body its skin. */
  dress(scene: SkinScene): void {
    this.skin = new Skin(scene);
    this.body.add(this.skin.mesh);
    this.showFigure();
  }

  private showFigure(): void {
    const skin = this.skin && !this.woodenOnly;
    if (this.skin) this.skin.mesh.visible = !this.woodenOnly;
    for (const solid of this.solids) solid.visible = !skin;
    this.pose();
    this.paint();
  }

  /** Puts the parts of the body where they are in the posture that is shown. */
  private pose(): void {
    this.shown?.places.forEach((place, i) => put(this.segments[i], place));
    if (this.shown && this.skin && !this.woodenOnly) this.skin.move(this.shown.bones);
  }

  /** The segment at the end of a ray, and the point. */
  private hit(ray: Raycaster): { index: number; point: Vector3 } | undefined {
    const { skin } = this;
    if (!skin || this.woodenOnly) {
      const [found] = ray.intersectObjects(this.solids);
      return found && { index: found.object.userData.segment as number, point: found.point };
    }
    const [found] = ray.intersectObject(skin.mesh);
    return found?.face ? { index: skin.segmentAt(found.face.a), point: found.point } : undefined;
  }

  /** The picture as PNG. */
  whole(): Promise<Blob | null> {
    this.renderer.render(this.world, this.camera);
    return new Promise((resolve) => this.canvas.toBlob(resolve));
  }

  /** A small picture of another posture of the same body, from the side it is looked at now. */
  picture(shown: Shown): string {
    const [before, size] = [this.shown, this.renderer.getSize(new Vector2())];
    const { aspect } = this.camera;
    this.shown = shown;
    this.marks.visible = false;
    this.pose();
    this.paint();
    this.renderer.setPixelRatio(1);
    this.renderer.setSize(PICTURE[0], PICTURE[1], false);
    this.camera.aspect = PICTURE[0] / PICTURE[1];
    this.camera.zoom = 1.1;
    this.camera.updateProjectionMatrix();
    this.renderer.render(this.world, this.camera);
    const url = this.canvas.toDataURL();
    this.marks.visible = true;
    this.shown = before;
    this.pose();
    this.paint();
    [this.camera.aspect, this.camera.zoom] = [aspect, 1];
    this.renderer.setSize(size.x, size.y, false);
    return url;
  }

  /** Another posture. */
  show(shown: Shown, held: Handle[]): void {
    if (!this.scene) return;
    this.shown = shown;
    this.pose();
    this.mark(shown, held);
    this.paint();
  }

  private paint(): void {
    const { scene, shown } = this;
    if (!scene || !shown) return;
    const colours = scene.segments.map(({ coordinates: [from, to] }) => {
      let share: number | null = null;
      for (let c = from; c < to; c++) if (scene.coordinates[c].groups) share = Math.max(share ?? 0, shown.load[c]);
      return share === null ? this.colour("--none") : colourOf(share, new Color());
    });
    if (this.skin && !this.woodenOnly) this.skin.paint(colours);
    else this.materials.forEach((materials, i) => materials.forEach(({ color }) => color.copy(colours[i])));
    this.world.background = this.colour("--scene");
    this.redraw();
  }

  /** Things that are put down are not there. */
  putDown(indices: number[]): void {
    this.things.forEach((thing, i) => (thing.visible = !indices.includes(i)));
    this.redraw();
  }

  /** Which things are there. */
  get thingsShown(): boolean[] {
    return this.things.map(({ visible }) => visible);
  }

  /** The force of an arrow of one metre, N. */
  get newtonsPerMetre(): number {
    const weight = this.shown?.contacts.reduce((sum, { force }) => sum + force[1], 0) || 600;
    return Math.abs(weight) / ARROW;
  }

  /** Draws a force that the pointer draws; without one takes it away. */
  pull(at?: Vector, force: Vector = [0, 0, 0]): void {
    if (this.pulled) discard(this.pulled);
    this.pulled = at && this.arrow(at, force, "--load", 0);
    if (this.pulled) this.world.add(this.pulled);
    this.redraw();
  }

  /** An arrow of a force, at least so long, m; none of next to no force. */
  private arrow(at: Vector, force: Vector, colour: string, least: number): ArrowHelper | undefined {
    const way = new Vector3(...force);
    const length = Math.max(way.length() / this.newtonsPerMetre, least);
    if (length < 0.012 || !Number.isFinite(length)) return undefined;
    const drawn = new ArrowHelper(way.normalize(), new Vector3(...at), length, this.colour(colour), 0.07, 0.045);
    // Forces within the body are seen through it.
    for (const part of [drawn.line, drawn.cone]) {
      Object.assign(part.material, { depthTest: false, transparent: true });
      part.renderOrder = 1;
    }
    return drawn;
  }

  private mark(shown: Shown, held: Handle[]): void {
    for (const old of [...this.marks.children]) discard(old);
    const arrow = (at: Vector, force: Vector, colour: string, least: number) => {
      const drawn = this.arrow(at, force, colour, least);
      if (drawn) this.marks.add(drawn);
    };
    for (const { at, force } of shown.contacts) if (at) arrow(at, force, "--force", 0);
    for (const { at, force } of shown.pushes) arrow(at, force, "--load", 0.16);
    const [x, y, z] = shown.center;
    const ball = (at: Vector, radius: number, colour: string, through: boolean) => {
      const material = new MeshBasicMaterial({ color: this.colour(colour), depthTest: !through, transparent: through });
      const mesh = new Mesh(BALL, material);
      mesh.scale.setScalar(radius);
      mesh.position.set(...at);
      mesh.renderOrder = through ? 1 : 0;
      this.marks.add(mesh);
    };
    ball([x, y, z], 0.025, "--center", true);
    if (shown.patches.length > 0) {
      const floor = Math.min(...shown.patches.map((corner) => corner[1]));
      ball([x, floor + 0.004, z], 0.018, "--center", false);
      const grid = new GridHelper(3, 12, this.colour("--ground"), this.colour("--ground"));
      grid.position.y = floor - 0.001;
      this.marks.add(grid);
    }
    for (const { segment, point } of held) {
      const index = this.scene!.segments.findIndex(({ name }) => name === segment);
      const at = new Vector3(...point).applyQuaternion(this.segments[index].quaternion).add(this.segments[index].position);
      ball([at.x, at.y, at.z], 0.022, "--target", true);
    }
  }

  private colour(name: string): Color {
    let colour = this.colours.get(name);
    if (!colour) {
      colour = new Color(getComputedStyle(this.canvas).getPropertyValue(name).trim() || "#888888");
      this.colours.set(name, colour);
    }
    return colour;
  }

  private redraw(): void {
    if (this.due) return;
    this.due = true;
    requestAnimationFrame(() => {
      this.due = false;
      const { clientWidth: width, clientHeight: height } = this.canvas;
      if (!width || !height) return;
      this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
      this.renderer.setSize(width, height, false);
      this.camera.aspect = width / height;
      this.camera.updateProjectionMatrix();
      this.renderer.render(this.world, this.camera);
    });
  }

  /** Shapes that the graphics card holds. */
  get geometries(): number {
    return this.renderer.info.memory.geometries;
  }

  /** Places of the vertices of the skin; undefined without one. */
  get skinPlaces(): number[] | undefined {
    return this.skin && [...(this.skin.mesh.geometry.getAttribute("position").array as Float32Array)];
  }

  /** Where a point of ground is on the canvas, px. */
  onCanvas(at: Vector): [number, number] {
    this.camera.updateMatrixWorld();
    const seen = new Vector3(...at).project(this.camera);
    return [((seen.x + 1) / 2) * this.canvas.clientWidth, ((1 - seen.y) / 2) * this.canvas.clientHeight];
  }

  /** A press on a part drags it in the plane of the screen; a press beside the body turns the view. */
  private listen(): void {
    const ray = new Raycaster();
    const plane = new Plane();
    let pointer: number | null = null;
    const aim = (event: PointerEvent) => {
      const box = this.canvas.getBoundingClientRect();
      const x = ((event.clientX - box.left) / box.width) * 2 - 1;
      const y = 1 - ((event.clientY - box.top) / box.height) * 2;
      this.camera.updateMatrixWorld();
      ray.setFromCamera(new Vector2(x, y), this.camera);
    };
    this.canvas.addEventListener(
      "pointerdown",
      (event) => {
        if (pointer !== null || event.button !== 0 || !this.scene) return;
        aim(event);
        const hit = this.hit(ray);
        if (!hit) return;
        const { index } = hit;
        pointer = event.pointerId;
        this.controls.enabled = false;
        this.canvas.setPointerCapture(pointer);
        plane.setFromNormalAndCoplanarPoint(this.camera.getWorldDirection(new Vector3()), hit.point);
        const inside = this.segments[index].worldToLocal(hit.point.clone());
        this.dragging.grab(this.scene.segments[index].name, [inside.x, inside.y, inside.z]);
        event.stopImmediatePropagation();
      },
      { capture: true },
    );
    this.canvas.addEventListener("pointermove", (event) => {
      if (event.pointerId !== pointer) return;
      aim(event);
      const target = ray.ray.intersectPlane(plane, new Vector3());
      if (target) this.dragging.drag([target.x, target.y, target.z]);
    });
    for (const end of ["pointerup", "pointercancel"] as const) {
      this.canvas.addEventListener(end, (event) => {
        if (event.pointerId !== pointer) return;
        pointer = null;
        this.controls.enabled = true;
        this.dragging.release();
      });
    }
  }
}
