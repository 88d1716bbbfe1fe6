// Keeps the files of the page, so that it opens without a network after the first time. All are of one build: a new build has a new cache.
const BUILD = "none"; // The build writes a digest of its files here,
const FILES = []; // and their names here.
const NAME = "contrapposto-studio-";

self.addEventListener("install", (event) => {
  const fill = async () => (await caches.open(NAME + BUILD)).addAll(FILES);
  event.waitUntil(fill().then(() => self.skipWaiting()));
});

self.addEventListener("activate", (event) => {
  const clear = async () => {
    const others = (await caches.keys()).filter((name) => name.startsWith(NAME) && name !== NAME + BUILD);
    await Promise.all(others.map((name) => caches.delete(name)));
    await self.clients.claim();
  };
  event.waitUntil(clear());
});

// Files whose names carry a digest never change; the others are asked for first, and taken from here where there is no answer.
async function answer(request) {
  const kept = await (await caches.open(NAME + BUILD)).match(request, { ignoreSearch: true });
  if (kept && new URL(request.url).pathname.includes("/assets/")) return kept;
  try {
    return await fetch(request);
  } catch (error) {
    if (kept) return kept;
    throw error;
  }
}

self.addEventListener("fetch", (event) => {
  const { request } = event;
  if (request.method === "GET" && new URL(request.url).origin === self.location.origin) event.respondWith(answer(request));
});
