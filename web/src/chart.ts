// The torques of a joint over its range, as Figure 1 of the paper draws them: where the curves are apart, muscles work.
import type { Balance, Shown } from "./messages";
import { texts } from "./texts";

const WIDTH = 360;
const HEIGHT = 190;
const EDGE = { left: 44, right: 8, top: 8, bottom: 30 };

function element(name: string, attributes: Record<string, string | number>, text = ""): SVGElement {
  const made = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, String(value));
  made.textContent = text;
  return made;
}

/** Steps of 1, 2 or 5 between the lines of an axis. */
function step(span: number): number {
  const rough = span / 4;
  const power = 10 ** Math.floor(Math.log10(rough));
  return power * ([1, 2, 5].find((factor) => factor * power >= rough) ?? 10);
}

export function draw(svg: SVGSVGElement, balance: Balance, shown: Shown, index: number, label: string): void {
  svg.replaceChildren(element("title", {}, texts.chart(label)));
  svg.setAttribute("viewBox", `0 0 ${WIDTH} ${HEIGHT}`);
  const degrees = balance.angle.map((angle) => (angle * 180) / Math.PI);
  const [first, last] = [degrees[0], degrees[degrees.length - 1]];
  // Passive torque grows without a bound near the ends of a range: the scale is that of the external torque, at least 5 N m.
  const external = Math.max(...balance.external.map(Math.abs), Math.abs(shown.external[index]), 5) * 1.4;
  const x = (angle: number) => EDGE.left + ((angle - first) / (last - first || 1)) * (WIDTH - EDGE.left - EDGE.right);
  const y = (torque: number) =>
    EDGE.top + ((external - Math.max(-external, Math.min(external, torque))) / (2 * external)) * (HEIGHT - EDGE.top - EDGE.bottom);
  const grid = (at: number, vertical: boolean, text: string) => {
    const line = vertical
      ? { x1: x(at), x2: x(at), y1: EDGE.top, y2: HEIGHT - EDGE.bottom }
      : { x1: EDGE.left, x2: WIDTH - EDGE.right, y1: y(at), y2: y(at) };
    svg.append(element("line", { ...line, class: "grid" }));
    const place = vertical ? { x: x(at), y: HEIGHT - EDGE.bottom + 13, "text-anchor": "middle" } : { x: EDGE.left - 4, y: y(at) + 4, "text-anchor": "end" };
    svg.append(element("text", place, text));
  };
  const across = step(last - first);
  for (let at = Math.ceil(first / across) * across; at <= last; at += across) grid(at, true, `${Math.round(at)}°`);
  const up = step(2 * external);
  for (let at = Math.ceil(-external / up) * up; at <= external; at += up) grid(at, false, String(Math.round(at * 10) / 10));
  const curve = (torques: number[], name: string) =>
    svg.append(element("polyline", { class: name, points: torques.map((torque, k) => `${x(degrees[k])},${y(torque)}`).join(" ") }));
  curve(balance.external, "external");
  curve(balance.minus_passive, "passive");
  const now = x((shown.angles[index] * 180) / Math.PI);
  svg.append(
    element("line", { x1: now, x2: now, y1: y(shown.external[index]), y2: y(-shown.passive[index]), class: "active" }),
    element("circle", { cx: now, cy: y(shown.external[index]), r: 4, class: "external" }),
    element("circle", { cx: now, cy: y(-shown.passive[index]), r: 4, class: "passive" }),
    element("text", { x: WIDTH - EDGE.right, y: HEIGHT - 3, "text-anchor": "end" }, texts.angle),
    element("text", { x: 2, y: HEIGHT - 3 }, texts.quantity),
  );
}
