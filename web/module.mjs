// Builds the module of the page into src/module: `node module.mjs`; the native twin for the tests: `node module.mjs twin`.
import { execFileSync } from "node:child_process";
import { copyFileSync, mkdirSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const web = dirname(fileURLToPath(import.meta.url)), root = dirname(web);
const target = process.env.CARGO_TARGET_DIR ?? join(root, "target");
const environment = { ...process.env, CARGO_TARGET_DIR: target };
const manifest = join(root, "crates", "contrapposto-web", "Cargo.toml");

function run(program, ...given) {
  execFileSync(program, given, { stdio: "inherit", env: environment });
}

if (process.argv[2] === "twin") {
  run("cargo", "build", "--locked", "--manifest-path", manifest, "--example", "twin");
} else {
  run("cargo", "build", "--release", "--locked", "--manifest-path", manifest, "--lib", "--target", "wasm32-unknown-unknown");
  const folder = join(web, "src", "module");
  mkdirSync(folder, { recursive: true });
  for (const [name, copy] of [["adult.skin", "adult.skin"], ["LICENSE.md", "skin-license.txt"]]) {
    copyFileSync(join(root, "crates", "contrapposto-formats", "data", "skin", name), join(folder, copy));
  }
  const module = join(target, "wasm32-unknown-unknown", "release", "contrapposto_web.wasm");
  run("cargo", "run", "--release", "--locked", "--quiet", "--manifest-path", join(web, "bindgen", "Cargo.toml"), "--", module, folder);
}
