// The page as static files under dist/, for `papilio serve` to carry.
// `vite` alone serves the sources and passes /api on to a `papilio serve` at PAPILIO (default port 7417).

import { defineConfig } from "vite";

const server = process.env["PAPILIO"] ?? "http://127.0.0.1:7417";

export default defineConfig({
  base: "./",
  // A strict Content-Security-Policy allows no data: addresses for fonts and scripts.
  build: { target: "es2022", assetsInlineLimit: 0, modulePreload: { polyfill: false } },
  server: {
    fs: { allow: ["../.."] },
    proxy: { "/api": { target: server, changeOrigin: true, headers: { origin: server } } },
  },
});
