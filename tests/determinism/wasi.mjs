// Runs a WASI program: node wasi.mjs PROGRAM.
import fs from "node:fs";
import {WASI} from "node:wasi";

const wasi = new WASI({version: "preview1"});
const module = await WebAssembly.compile(fs.readFileSync(process.argv[2]));
const instance = await WebAssembly.instantiate(module, {wasi_snapshot_preview1: wasi.wasiImport});
process.exit(wasi.start(instance));
