// After the first visit the page opens without a network; on the loopback of this machine nothing is kept.
import assert from "node:assert/strict";
import { test } from "node:test";
import { atRest, close, newPage, open, port, result, stopServer, useBrowser, withBody } from "./browser.mjs";

useBrowser();

test("on the loopback of this machine no service worker is registered", async () => {
  const opened = await open();
  await opened.page.waitForLoadState("load");
  await atRest(opened.page);
  const registered = () => navigator.serviceWorker.getRegistrations().then((all) => all.length);
  assert.equal(await opened.page.evaluate(registered), 0);
  await close(opened);
});

// The last test of this file: the server is gone then.
test("after one visit the page works without its server", async () => {
  const opened = await newPage();
  const { page } = opened;
  await page.goto(`http://studio.localhost:${port()}/`, { waitUntil: "commit" });
  await withBody(page);
  await page.evaluate(() => navigator.serviceWorker.ready.then(() => undefined));
  const online = await result(page);
  await stopServer();
  await page.reload({ waitUntil: "commit" });
  await withBody(page);
  await atRest(page);
  assert.deepEqual((await result(page)).names, online.names);
  await page.click("#move-up");
  await page.waitForSelector("#free-hand_r");
  await close(opened);
});
