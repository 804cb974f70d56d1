// Plays scenes of bench/tradeoff with engines that run under node. bench/run copies it, with the adapters beside it, to
// build/bench/node, where their packages are installed.
//
//   node --single-threaded --no-liftoff play.mjs SCENE ENGINE RATE SUBSTEPS ITERATIONS
//                      plays, and prints the line of CSV that the program ../tradeoff makes of it
//   node play.mjs --list
//                      lists the engines that load, a line each: FILE NAME DIMENSION JOINTS SETTINGS
//
// An adapter exports `engines`: of each its name, dimension, whether it has joints (0 or 1), the settings that it takes
// ("substeps", "iterations", "substeps iterations" or "none") and load(), which promises a function that makes a world:
// make(scene, {dt, substeps, iterations}), 0: as it ships. A world has add(body), join(joint), drive(body, velocity,
// spin), step(), state(body), gravity() and free(), like bench/scenes/engine.hpp.
//
// The clock is CPU time of the process, which with --single-threaded has no other thread that works, so that collecting
// garbage counts too. It is read around the steps of a frame. Before it counts a scene is played once, and for 0.2 s of
// steps, so that what runs often has been compiled: wasm at its first call, with --no-liftoff, as well as it can be.
import { execFileSync, spawnSync } from "node:child_process";
import { readdirSync, readFileSync } from "node:fs";
import { fileURLToPath } from "node:url";

const here = fileURLToPath(new URL(".", import.meta.url));
const program = here + "../tradeoff";
// Standard output is for results alone.
console.log = console.info = console.warn = console.error;

function cpuSeconds(since) {
    const spent = process.cpuUsage(since);
    return (spent.user + spent.system) / 1e6;
}

/** Seconds of what always takes the same. */
function calibration() {
    const before = process.cpuUsage();
    let x = 1;
    for (let i = 0; i < 1e7; ++i) x = x * 0.999 + 0.001;
    return x > 0 ? cpuSeconds(before) : 0;
}

/** One run: what was seen of it, and CPU seconds in steps. */
function play(scene, make, rate, settings) {
    const dt = 1 / rate, steps = rate * scene.interval;
    const world = make(scene, { dt, ...settings });
    let next = 0, joined = 0, done = 0;
    const enter = () => {
        while (next < scene.bodies.length && scene.bodies[next].born <= done) world.add(scene.bodies[next++]);
        for (; joined < scene.joints.length; ++joined) {
            const joint = scene.joints[joined];
            if (Math.max(joint.a, joint.b) >= next) break;
            world.join(joint);
        }
    };
    const film = new Float64Array((scene.frames + 1) * scene.bodies.length * 14);
    let at = 0;
    const look = () => {
        for (let i = 0; i < scene.bodies.length; ++i) {
            const { place, turn, velocity, spin, mass } = world.state(i);
            film.set([...place, ...turn, ...velocity, ...spin, mass], at);
            at += 14;
        }
    };
    enter();
    look();
    let seconds = 0;
    for (let frame = 0; frame < scene.frames; ++frame) {
        const before = process.cpuUsage();
        for (let i = 0; i + 0.5 < steps; ++i) {
            for (const { body, reach, rate: often } of scene.swings) {
                const t = done * dt;
                world.drive(body, [reach * (Math.sin(often * (t + dt)) - Math.sin(often * t)) / dt, 0, 0], [0, 0, 0]);
            }
            world.step();
            ++done;
            enter();
        }
        seconds += cpuSeconds(before);
        look();
    }
    const gravity = world.gravity();
    world.free();
    return { film: new Uint8Array(film.buffer), gravity, seconds };
}

/** Plays until there are enough runs; the first of them, and the seconds of all that count. */
function measure(scene, make, rate, settings) {
    const first = play(scene, make, rate, settings);
    // What is as slow as this will not be compiled for long.
    if (first.seconds >= 20) return { first, seconds: [first.seconds] };
    const again = () => {
        const run = play(scene, make, rate, settings);
        if (Buffer.compare(run.film, first.film) !== 0) throw new Error("two runs differ");
        return run.seconds;
    };
    let warm = first.seconds;
    for (let i = 0; i < 100 && warm < 0.2; ++i) warm += again();
    let seconds = [];
    calibration();
    for (let tries = 0; tries < 3; ++tries) {
        seconds = [];
        let spent = 0;
        const before = calibration();
        do {
            seconds.push(again());
            spent += seconds.at(-1);
        } while (spent < 2 && (seconds.length < 3 || (spent < 0.2 && seconds.length < 100)));
        if (spent >= 2 || calibration() < 1.05 * before) break;
    }
    return { first, seconds };
}

/** Lists those of one file that load. */
async function list(file) {
    const { engines } = await import("./" + file);
    let said = "";
    for (const { name, dimension, joints, settings, load } of engines) {
        await load();
        said += `${file} ${name} ${dimension} ${joints} ${settings}\n`;
    }
    return said;
}

async function playTask(words) {
    const [sceneName, engineName, rate, substeps, iterations] = words;
    const lines = readFileSync(here + "engines.txt", "utf8").split("\n").map((line) => line.split(" "));
    const line = lines.find(([, name]) => name === engineName);
    if (!line) throw new Error("no such engine");
    const { engines } = await import("./" + line[0]);
    const make = await engines.find(({ name }) => name === engineName).load();
    const scene = JSON.parse(execFileSync(program, ["scene", sceneName], { maxBuffer: 1 << 28 }));
    const { first, seconds } = measure(scene, make, +rate, { substeps: +substeps, iterations: +iterations });
    const simulated = scene.frames * scene.interval;
    const head = `gravity ${first.gravity.join(" ")}\nseconds ${seconds.map((s) => s / simulated).join(" ")}\n` +
        `frames ${scene.frames + 1} bodies ${scene.bodies.length}\n`;
    const input = Buffer.concat([Buffer.from(head), first.film]);
    return spawnSync(program, ["judge", ...words], { input, stdio: ["pipe", "inherit", "inherit"] }).status ?? 1;
}

const words = process.argv.slice(2);
try {
    if (words.length === 5) process.exit(await playTask(words));
    if (words.length === 2 && words[0] === "--list") {
        process.stdout.write(await list(words[1]), () => process.exit(0));
    } else if (words[0] === "--list") {
        // Each in a process of its own, as a package may take its process with it.
        for (const file of readdirSync(here).filter((name) => name.endsWith(".mjs") && name !== "play.mjs").sort()) {
            const found = spawnSync(process.execPath, [here + "play.mjs", "--list", file],
                { encoding: "utf8", timeout: 60000 });
            if (found.status === 0) process.stdout.write(found.stdout);
            else console.error(`without ${file} there is no comparison: ${found.stderr.trim().split("\n").at(-1)}`);
        }
    } else {
        console.error("play.mjs --list | play.mjs SCENE ENGINE RATE SUBSTEPS ITERATIONS");
        process.exit(2);
    }
} catch (error) {
    console.error(`${words.slice(0, 2).join(" ")}: ${error.message ?? error}`);
    process.exit(1);
}
