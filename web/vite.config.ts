import { defineConfig } from "vite";

// Relative addresses: the page works from any folder of any file server.
export default defineConfig({
  base: "./",
  build: { target: "es2022", modulePreload: { polyfill: false }, assetsInlineLimit: 0, chunkSizeWarningLimit: 900 },
  worker: { format: "es" },
});
