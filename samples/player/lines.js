// Unpacks the lines of debug drawing, the mirror image of lines.hpp, and tells where they are at any time.
"use strict";

const lines = (() => {
    const MODEL = 66, STEPS = 16;       // chances in the model of a number; steps of the scene's grid

    /// Reads frame by frame from the stream of a scene.
    function reader(raw, input, plane, note) {
        const chances = new Uint16Array(22 * MODEL).fill(32768);
        const comes = new Uint16Array(2).fill(32768), stays = new Uint16Array(2).fill(32768);
        const tinted = new Uint16Array(1).fill(32768), foreseen = new Uint16Array(8).fill(32768);
        const axes = plane ? [0, 1, 3, 4] : [0, 1, 2, 3, 4, 5];
        const tints = new Int32Array(raw.bodies.length).fill(-1);
        const gone = [new Map(), new Map(), new Map()];
        const origin = () => ({ body: [0, 0], at: new Int32Array(6), hit: true });
        let alive = [], knownOf = [0, 0];

        const expected = (line, k) => {
            const at = line.at[k], places = gone[k % 3];
            if (places.has(at)) return [places.get(at), true];
            if (places.has(-at)) return [-places.get(-at), true];
            return [at + line.change[k], false];
        };
        const move = (line, former) => {
            if (line.body.some((body, end) => body !== knownOf[end])) gone.forEach(places => places.clear());
            knownOf = line.body;
            const places = axes.map(k => expected(line, k)), known = places.every(place => place[1]);
            const hit = input.get(foreseen, (known ? 4 : 0) + (former ? 2 : 0) + (line.hit ? 1 : 0));
            const next = line.at.slice();
            axes.forEach((k, i) => {
                if (hit) {
                    next[k] = places[i][0];
                } else {
                    const [place, isKnown] = expected(line, k);
                    const rest = input.number(chances, (isKnown ? 5 : (k < 3 ? 6 : 14) + line.size[k]) * MODEL);
                    if (!isKnown) line.size[k] = Math.min(7, 32 - Math.clz32(Math.abs(rest)));
                    next[k] = place + rest;
                }
                line.change[k] = next[k] - line.at[k];
                gone[k % 3].set(line.at[k], next[k]);
            });
            line.at = next;
            line.hit = hit;
        };

        /// The lines of the next frame, with the number of each in the frame before, or -1; and the tints of bodies.
        return () => {
            for (let i = 0; i < tints.length; ++i) {
                if (input.get(tinted, 0)) tints[i] = input.number(chances, 0);
                note(tints[i]);
            }
            const next = [];
            let last = origin(), went = 0;
            const arrivals = () => {
                for (let came = 0; input.get(comes, came); came = 1) {
                    const colour = input.number(chances, 0), body = last.body.slice(), at = last.at.slice();
                    for (const end of [0, 1]) {
                        body[end] += input.number(chances, MODEL);
                        for (const k of axes)
                            if ((k < 3 ? 0 : 1) === end) at[k] += input.number(chances, (2 + k % 3) * MODEL);
                    }
                    last = {
                        body, at, colour, change: new Int32Array(6), size: new Uint8Array(6), hit: true, former: -1,
                    };
                    next.push(last);
                }
            };
            alive.forEach((line, i) => {
                arrivals();
                const remains = input.get(stays, went);
                went = remains ? 0 : 1;
                if (!remains) return;
                move(line, last.hit);
                line.former = i;
                next.push(last = line);
            });
            arrivals();
            gone.forEach(places => places.clear());
            alive = next;
            note(alive.length);
            for (const { body, at, colour } of alive) {
                body.forEach(value => note(value));
                at.forEach(value => note(value));
                note(colour);
            }
            return { alive, tints };
        };
    }

    /// All frames' lines; `add` takes what the reader gives.
    function store(raw, turned) {
        const grid = STEPS * raw.grid, frames = [];
        return {
            frames, palette: raw.palette.map(value => [16, 8, 0].map(shift => (value >> shift & 255) / 255)),
            add({ alive, tints }) {
                const count = alive.length, bodies = new Uint16Array(2 * count), ends = new Float32Array(6 * count);
                const colour = new Uint16Array(count), former = new Int32Array(count);
                alive.forEach((line, i) => {
                    const [x, y, z, a, b, c] = line.at;
                    ends.set((turned ? [x, z, -y, a, c, -b] : [x, y, z, a, b, c]).map(value => value * grid), 6 * i);
                    bodies.set(line.body, 2 * i);
                    colour[i] = line.colour;
                    former[i] = line.former;
                });
                frames.push({ bodies, ends, colour, former, tints: Uint16Array.from(tints) });
            },
        };
    }

    /// What is drawn at a time: six numbers and a colour a line; one that both frames have moves from one to the other.
    function at(scene, time, poses) {
        const [frame, part] = sample.place(scene, time), { frames, palette } = scene.drawing;
        const now = frames[frame], next = part > 0 ? frames[frame + 1] : now;
        const list = [], goesOn = new Uint8Array(now.former.length);
        const push = (of, i, between) => {
            const ends = of.ends.slice(6 * i, 6 * i + 6);
            for (let k = 0; k < 6; ++k) {
                if (between !== undefined) ends[k] += (now.ends[6 * between + k] - ends[k]) * (1 - part);
                ends[k] += poses[7 * of.bodies[2 * i + (k < 3 ? 0 : 1)] + k % 3];
            }
            // Where a body is not there, neither are its lines.
            if (!ends.some(Number.isNaN)) list.push({ ends, colour: palette[of.colour[i]] });
        };
        for (let i = 0; part > 0 && i < next.former.length; ++i) {
            const from = next.former[i];
            if (from >= 0) goesOn[from] = 1;
            if (from >= 0) push(next, i, from);
            else if (part >= 0.5) push(next, i);
        }
        for (let i = 0; part < 0.5 && i < goesOn.length; ++i) if (!goesOn[i]) push(now, i);
        return list;
    }
    /// The colours of bodies at a time.
    function tints(scene, time) {
        const [frame, part] = sample.place(scene, time), { frames, palette } = scene.drawing;
        return Array.from(frames[part < 0.5 ? frame : frame + 1].tints, number => palette[number]);
    }
    const isDot = ends => ends[0] === ends[3] && ends[1] === ends[4] && ends[2] === ends[5];

    return { reader, store, at, tints, isDot };
})();
