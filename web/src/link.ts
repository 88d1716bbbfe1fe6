// Links that hold a whole scenario: `#scenario=` with base64url of the TOML text.

export function encoded(text: string): string {
  let bytes = "";
  for (const byte of new TextEncoder().encode(text)) bytes += String.fromCharCode(byte);
  return btoa(bytes).replaceAll("+", "-").replaceAll("/", "_").replace(/=+$/, "");
}

/** The text of a part of a link; undefined where it is no text. */
export function decoded(part: string): string | undefined {
  try {
    const bytes = atob(part.replaceAll("-", "+").replaceAll("_", "/"));
    return new TextDecoder("utf-8", { fatal: true }).decode(Uint8Array.from(bytes, (c) => c.charCodeAt(0)));
  } catch {
    return undefined;
  }
}

/** The encoded scenario of an address; undefined without one. */
export function scenarioPart(hash: string): string | undefined {
  return /^#scenario=([A-Za-z0-9_=-]+)$/.exec(hash)?.[1];
}
