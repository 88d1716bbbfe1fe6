// Keeps in the browser what the page shows, so that it is there again after a reload.
import type { Request } from "./messages";

const KEY = "contrapposto-studio";

/** A scenario that was opened, and the document that has become of it. */
export interface Kept {
  opened: Request;
  state: string;
}

/** Keeps it; where the browser has no room or allows nothing, the page goes on without. */
export function keep(kept: Kept): void {
  try {
    sessionStorage.setItem(KEY, JSON.stringify(kept));
  } catch {
    forget();
  }
}

export function forget(): void {
  try {
    sessionStorage.removeItem(KEY);
  } catch {
    // There is nothing to forget where nothing can be kept.
  }
}

/** What was kept last; undefined without it. */
export function recall(): Kept | undefined {
  try {
    const kept = JSON.parse(sessionStorage.getItem(KEY) ?? "null") as Partial<Kept> | null;
    return kept?.opened && typeof kept.state === "string" ? (kept as Kept) : undefined;
  } catch {
    return undefined;
  }
}
