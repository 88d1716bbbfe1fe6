// Keeps every file of the page, so that it opens without a network after the first time. Files whose names carry a digest never change;
// the others are asked for first, and taken from here where there is no answer.
const KEPT = "contrapposto-studio-1";

self.addEventListener("install", () => self.skipWaiting());
self.addEventListener("activate", (event) => event.waitUntil(self.clients.claim()));

async function answer(request) {
  const kept = await caches.open(KEPT);
  const known = await kept.match(request, { ignoreSearch: true });
  if (known && new URL(request.url).pathname.includes("/assets/")) return known;
  try {
    const fresh = await fetch(request);
    if (fresh.ok) await kept.put(request, fresh.clone());
    return fresh;
  } catch (error) {
    if (known) return known;
    throw error;
  }
}

self.addEventListener("fetch", (event) => {
  const { request } = event;
  if (request.method === "GET" && new URL(request.url).origin === self.location.origin) event.respondWith(answer(request));
});

// The files that were loaded before this worker was there.
self.addEventListener("message", (event) => {
  event.waitUntil(caches.open(KEPT).then((kept) => Promise.allSettled(event.data.map((url) => kept.add(url)))));
});
