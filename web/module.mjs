// Builds the modules of the page into src/module, and into src/module/all the one with all readers and writers: `node module.mjs`; the native twin
// for the tests: `node module.mjs twin`.
import { execFileSync } from "node:child_process";
import { copyFileSync, mkdirSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const web = dirname(fileURLToPath(import.meta.url)), root = dirname(web);
const target = process.env.CARGO_TARGET_DIR ?? join(root, "target");
const environment = { ...process.env, CARGO_TARGET_DIR: target };
const workspace = ["--locked", "--manifest-path", join(root, "Cargo.toml")];

function run(program, ...given) {
  execFileSync(program, given, { stdio: "inherit", env: environment });
}

if (process.argv[2] === "twin") {
  run("cargo", "build", ...workspace, "--workspace", "--example", "twin"); // what the tests of the workspace have built already
} else {
  const folder = join(web, "src", "module");
  mkdirSync(folder, { recursive: true });
  const module = join(target, "wasm32-unknown-unknown", "page", "contrapposto_web.wasm");
  for (const [into, features] of [[folder, ["--no-default-features"]], [join(folder, "all"), []]]) {
    run("cargo", "build", ...workspace, "--package", "contrapposto-web", "--profile", "page", "--lib", "--target", "wasm32-unknown-unknown", ...features);
    run("cargo", "run", "--locked", "--quiet", "--manifest-path", join(web, "bindgen", "Cargo.toml"), "--", module, into);
  }
  for (const [name, copy] of [["adult.skin", "adult.skin"], ["LICENSE.md", "skin-license.txt"]]) {
    copyFileSync(join(root, "crates", "contrapposto-formats", "data", "skin", name), join(folder, copy));
  }
  copyFileSync(join(root, "crates", "contrapposto-report", "vendor", "plotly.js", "plotly-basic.min.js"), join(folder, "charts.txt"));
}
