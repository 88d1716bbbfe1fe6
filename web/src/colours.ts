// Colours of loads, shares of strength: those of the report (contrapposto-report/page/data.js), lighter is less.
import { Color } from "three";

const BANDS: [number, string, string][] = [
  [0, "#e2f5d3", "#bfe39f"],
  [0.08, "#efcf3a", "#e3b516"],
  [0.14, "#e8942a", "#cf6a12"],
  [0.5, "#b5301f", "#8c1418"],
  [1, "#3d0a1e", "#3d0a1e"],
];

/** Lower bounds and colours of the bands, for a scale. */
export const bands = BANDS.map(([from, low, high]) => ({ from, low, high }));

export function colourOf(share: number, into: Color): Color {
  const k = Math.max(0, BANDS.findLastIndex(([from]) => from <= share + 1e-9));
  const [from, low, high] = BANDS[k];
  const to = k + 1 < BANDS.length ? BANDS[k + 1][0] : 1;
  const place = to > from ? Math.min(1, Math.max(0, (share - from) / (to - from))) : 0;
  return into.set(low).lerp(new Color(high), place);
}
