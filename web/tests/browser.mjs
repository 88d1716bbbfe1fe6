// Serves the built page, and opens it in headless Chromium. Counts every request that the browser makes.
import assert from "node:assert/strict";
import { existsSync, readFileSync } from "node:fs";
import { createServer } from "node:http";
import { dirname, extname, join } from "node:path";
import { after, before } from "node:test";
import { fileURLToPath } from "node:url";
import { chromium } from "playwright-core";

export const web = dirname(dirname(fileURLToPath(import.meta.url)));
export const root = dirname(web);
export const dist = join(web, "dist");
const TYPES = { ".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".wasm": "application/wasm", ".svg": "image/svg+xml" };
// This machine may be busy and has no graphics card: waits are long, bounds on times are the measuring test's alone.
const PATIENCE = 60_000;

let server, browser;

/** The port of the server. */
export const port = () => server.address().port;
export const stopServer = () => new Promise((resolve) => server.close(resolve) && server.closeAllConnections());

/** The server and the browser are there for the tests of a file. */
export function useBrowser() {
  before(async () => {
    server = createServer((request, response) => {
      const name = new URL(request.url, "http://page").pathname;
      const file = join(dist, name === "/" ? "index.html" : name);
      const found = file.startsWith(dist) && existsSync(file);
      response.writeHead(found ? 200 : 404, { "content-type": TYPES[extname(file)] ?? "application/octet-stream" });
      response.end(found ? readFileSync(file) : "");
    });
    await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
    browser = await chromium.launch({
      executablePath: process.env.CONTRAPPOSTO_CHROMIUM ?? "/usr/bin/chromium",
      args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-quic", "--no-first-run",
        "--disable-background-networking", "--disable-component-update", "--disable-sync"],
    });
  });
  after(async () => {
    await browser?.close();
    server?.close();
  });
}

/** A page, not yet gone anywhere. `requests` are the addresses of all requests of it and its workers; errors are those that nothing caught. */
export async function newPage(viewport = { width: 700, height: 500 }) {
  const context = await browser.newContext({ viewport, acceptDownloads: true });
  context.setDefaultTimeout(PATIENCE);
  const page = await context.newPage();
  const [requests, errors] = [[], []];
  context.on("request", (request) => requests.push(request.url()));
  page.on("websocket", (socket) => requests.push(socket.url()));
  page.on("pageerror", (error) => errors.push(error));
  return { context, page, requests, errors };
}

/** The page with a body. */
export async function open(hash = "", viewport = undefined) {
  const opened = await newPage(viewport);
  await opened.page.goto(`http://127.0.0.1:${port()}/${hash}`, { waitUntil: "commit" });
  await withBody(opened.page);
  return opened;
}

export const withBody = (page) => page.waitForFunction(() => JSON.parse(document.querySelector("#result").textContent).q);

export async function close({ context, errors }) {
  await context.close();
  assert.deepEqual(errors, []);
}

export const result = async (page) => JSON.parse(await page.textContent("#result"));

/** What the session was asked to do has been done, and the body has settled. */
export const atRest = (page) => page.waitForFunction(() => document.querySelector("#stage").getAttribute("aria-busy") === "false");

/** Sets a slider as a hand would that lets go of it. */
export const slide = (page, id, value) =>
  page.locator(id).evaluate((slider, value) => {
    slider.value = value;
    for (const kind of ["input", "change"]) slider.dispatchEvent(new Event(kind, { bubbles: true }));
  }, String(value));
