// Keeps the files of the page in the browser, so that it opens without a network.

/** This machine itself: its files are here without a cache, and under another port they would be kept once more. */
const LOOPBACK = /^(localhost|127\.\d+\.\d+\.\d+|\[::1\])$/;

export function keepForOffline(): void {
  if (!import.meta.env.PROD || !("serviceWorker" in navigator) || LOOPBACK.test(location.hostname)) return;
  // After the first load, which is not to wait for it. A browser that refuses shows the page all the same.
  addEventListener("load", () => void navigator.serviceWorker.register("./service-worker.js").catch(() => undefined));
}
