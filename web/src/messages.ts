// Requests to a session, and its answers: the types of crates/contrapposto-web/src/message.rs.

export type Vector = [number, number, number];
/** Position, then quaternion x, y, z, w. */
export type Place = [number, number, number, number, number, number, number];

export type Request =
  | { do: "open"; scenario: string; files?: Record<string, string> }
  | { do: "open_model"; name: string; text: string }
  | { do: "adult"; sex: string; stature: number; mass: number }
  | { do: "percentile"; sex: string; percentile: number }
  | { do: "grab"; segment: string; point: Vector }
  | { do: "drag"; target: Vector }
  | { do: "release"; hold: boolean }
  | { do: "free"; segment: string }
  | { do: "settle" }
  | { do: "load"; segment: string; mass: number }
  | { do: "push"; segment: string; point: Vector; force: Vector }
  | { do: "put"; word: string; keys: Keys }
  | { do: "take_away"; word: string; number: number }
  | { do: "strategy"; kind: string; region?: string }
  | { do: "play"; samples: number }
  | { do: "stop"; take: boolean }
  | { do: "balance"; coordinate: string }
  | { do: "relax" }
  | { do: "go"; q: number[] }
  | { do: "at"; q: number[] }
  | { do: "motion"; name: string; text: string }
  | { do: "mirror" }
  | { do: "look"; time: number }
  | { do: "skin" }
  | { do: "gltf"; wooden: boolean; course?: Course }
  | { do: "bvh"; course?: Course }
  | { do: "report" }
  | { do: "export" }
  | { do: "state" }
  | { do: "restore"; state: string }
  | { do: "undo" }
  | { do: "redo" }
  | { do: "reset" };

export interface Verdict {
  kind: string;
  minutes: number | null;
  who: string | null;
  load: number | null;
  sentence: string;
  lines?: string[];
}

export interface Shown {
  q: number[];
  angles: number[];
  external: number[];
  passive: number[];
  active: number[];
  load: number[];
  places: Place[];
  bones: Place[];
  center: Vector;
  contacts: { force: Vector; share: number; at: Vector | null }[];
  patches: Vector[];
  pushes: { at: Vector; force: Vector }[];
  verdict: Verdict;
  miss: number | null;
  settled: boolean;
}

export interface Way {
  effort: number;
  on_ligaments: string[];
  shown: Shown;
}

export interface SkinScene {
  vertices: Vector[];
  triangles: Vector[];
  bones: [number, number, number, number][];
  weights: [number, number, number, number][];
  light: number[];
  heads: Vector[];
  segments: number[];
}

export interface Handle {
  label: string;
  segment: string;
  point: Vector;
}

export interface Coordinate {
  name: string;
  label: string;
  positive: string;
  turns: boolean;
  range: [number, number];
  groups: [string, string] | null;
}

export interface Segment {
  name: string;
  label: string;
  hulls: [number, number, number, number][][];
  coordinates: [number, number];
}

/** A force on a point of a segment: in the segment's frame, m, and in ground, N. */
export interface Pushed extends Handle {
  force: Vector;
}

/** Keys of a table of the scenario file. */
export type Keys = Record<string, unknown>;

export interface ThingTable {
  word: string;
  number: number;
  keys: Keys;
}

export interface Scene {
  title: string;
  person: { sex: string; stature: number; mass: number; percentiles: [number, number] } | null;
  coordinates: Coordinate[];
  segments: Segment[];
  handles: Handle[];
  held: Handle[];
  supports: string[];
  things: { name: string; size: Vector; place: Place; segment: number | null }[];
  loads: { segment: string; mass: number }[];
  tables: ThingTable[];
  forces: Pushed[];
  strategy: string;
  /** Strategies of regions: `active`, `passive`, `mixed`. */
  regions: { name: string; strategy: string }[];
  notes: string[];
  can_undo: boolean;
  can_redo: boolean;
  shown: Shown;
}

export interface Played {
  time: number;
  samples: number;
  fatigue: [number, number][];
  asking: string[];
  log: { time: number; sentence: string }[];
  decisions: number;
  /** Indices of the things that have been put down. */
  put_down: number[];
  ended: string | null;
  shown: Shown;
}

export interface Balance {
  coordinate: string;
  angle: number[];
  external: number[];
  minus_passive: number[];
}

/** Postures over time. */
export interface Course {
  times: number[];
  postures: number[][];
}

export type Answer =
  | ({ is: "scene" } & Scene)
  | ({ is: "shown" } & Shown)
  | ({ is: "played" } & Played)
  | ({ is: "balance" } & Balance)
  | { is: "ways"; ways: Way[] }
  | { is: "skin"; skin: SkinScene | null }
  | { is: "bytes"; bytes: number[] }
  | { is: "motion"; course: Course; notes: string[] }
  | { is: "text"; text: string }
  | { is: "elsewhere"; state: string; course: Course | null; samples: number }
  | { is: "refused"; sentence: string };

/** What the worker sends: an answer with the duration of the call, ms; or the reason why the module is gone. */
export type FromWorker =
  | { kind: "here" }
  | { kind: "ready"; version: string }
  | { kind: "answer"; id: number; answer: Answer; ms: number }
  | { kind: "sought"; count: number }
  | { kind: "broken"; id: number; sentence: string };

export interface ToWorker {
  id: number;
  request: Request;
}
