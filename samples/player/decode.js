// Unpacks a recorded scene: the mirror image of coder.hpp and scene.hpp.
"use strict";

const decode = (() => {
    class BitReader {
        constructor(text) {
            const raw = atob(text);
            this.bytes = new Uint8Array(raw.length);
            for (let i = 0; i < raw.length; ++i) this.bytes[i] = raw.charCodeAt(i);
            this.at = 4;
            this.low = 0;
            this.high = 0xffffffff;
            const b = this.bytes;
            this.code = (b[0] << 24 | b[1] << 16 | b[2] << 8 | b[3]) >>> 0;
        }
        narrow(yes) {
            const width = this.high - this.low;
            const middle = this.low + (width >>> 16) * yes + (((width & 0xffff) * yes) >>> 16);
            const bit = this.code <= middle;
            if (bit) this.high = middle; else this.low = middle + 1;
            while (((this.low ^ this.high) & 0xff000000) === 0) {
                this.low = (this.low << 8) >>> 0;
                this.high = (this.high << 8 | 255) >>> 0;
                this.code = (this.code << 8 | (this.at < this.bytes.length ? this.bytes[this.at] : 0)) >>> 0;
                ++this.at;
            }
            return bit;
        }
        get(chances, index) {
            const yes = chances[index], bit = this.narrow(yes);
            chances[index] = bit ? yes + ((65536 - yes) >> 5) : yes - (yes >> 5);
            return bit;
        }
        number(chances, base) {
            if (this.get(chances, base)) return 0;
            const negative = this.get(chances, base + 1);
            let length = 0;
            while (length < 31 && this.get(chances, base + 2 + length)) ++length;
            let size = 1;
            for (let i = length - 1; i >= 0; --i) {
                const bit = i === length - 1 ? this.get(chances, base + 34 + length) : this.narrow(32768);
                size = size * 2 + (bit ? 1 : 0);
            }
            return negative ? -size : size;
        }
    }

    const MODEL = 66;      // chances in the model of a number
    const QUANTA = 7;      // stored numbers of a pose or a contact, at most
    const NONE = -61;      // the impulse level that stands for none

    /// A list of numbers that grows.
    class Column {
        constructor(Type) { this.data = new Type(1024); this.length = 0; }
        push(value) {
            if (this.length === this.data.length) {
                const larger = new this.data.constructor(2 * this.length);
                larger.set(this.data);
                this.data = larger;
            }
            this.data[this.length++] = value;
        }
    }

    /// Gives poses (x, y, z, quaternion; y is up) of all bodies at all frames, and contacts with links from frame
    /// to frame. Throws if what comes out is not what went in.
    function scene(raw) {
        const plane = raw.dimension === 2, channels = plane ? 3 : 7;
        const input = new BitReader(raw.data);
        const chances = new Uint16Array(22 * 8 * MODEL).fill(32768);
        const flags = new Uint16Array(5).fill(32768);      // moved, touch moved, alive
        let check = 2166136261;
        const note = value => { check = Math.imul(check ^ value, 16777619); };

        const kinds = raw.kinds.map(([motion, ...shapes]) => ({
            motion,
            shapes: shapes.map(([form, ...numbers]) => ({
                form: form.replace("~", ""), hollow: form[0] === "~", size: numbers.slice(0, -7), local: numbers.slice(-7),
            })),
        }));
        const bodies = raw.bodies.map(kind => kinds[kind]);
        const count = bodies.length, frames = raw.frames;
        const movers = [];
        const slot = bodies.map((body, i) => body.motion === 0 ? -1 : movers.push(i) - 1);
        const track = new Float32Array(frames * movers.length * 7);
        const rest = new Float32Array(count * 7);

        const now = new Int32Array(count * QUANTA), before = new Int32Array(count * QUANTA);
        const size = new Uint8Array(count * QUANTA), moved = new Uint8Array(count);

        const turned = raw.up === "z" && !plane;
        const half = Math.SQRT1_2;
        const write = (out, o, b) => {
            let x = now[b] * raw.grid, y = now[b + 1] * raw.grid, z = 0, q;
            if (plane) {
                const angle = now[b + 2] * raw.turn / 2;
                q = [0, 0, Math.sin(angle), Math.cos(angle)];
            } else {
                z = now[b + 2] * raw.grid;
                q = [now[b + 3], now[b + 4], now[b + 5], now[b + 6]];
                const length = Math.hypot(...q) || 1;
                q = q.map(value => value / length);
                if (turned) {
                    // A quarter turn about x takes z to y.
                    [y, z] = [z, -y];
                    q = [half * (q[0] - q[3]), half * (q[1] + q[2]), half * (q[2] - q[1]), half * (q[3] + q[0])];
                }
            }
            out[o] = x; out[o + 1] = y; out[o + 2] = z;
            out[o + 3] = q[0]; out[o + 4] = q[1]; out[o + 5] = q[2]; out[o + 6] = q[3];
        };

        const contactStart = new Uint32Array(frames + 1);
        const spot = new Column(Float32Array);      // x, y, z
        const normal = new Column(Int8Array);       // 1/64 each
        const level = new Column(Int8Array);        // thirds of an octave
        const link = new Column(Int32Array);        // place of the same contact in the frame before, or -1
        let alive = [];
        const drawing = raw.palette ? lines.store(raw, turned) : null;
        const readLines = drawing && lines.reader(raw, input, plane, note);

        const readTouch = (contact, continued) => {
            const changed = !continued || input.get(flags, 2 + contact.moved);
            if (changed) {
                for (let i = 0; i < QUANTA; ++i) {
                    if (plane && (i === 2 || i === 5)) continue;
                    let step;
                    if (continued) {
                        const residual = input.number(chances, ((7 + i) * 8 + contact.size[i]) * MODEL);
                        contact.size[i] = Math.min(7, 32 - Math.clz32(Math.abs(residual)));
                        step = contact.change[i] + residual;
                    } else {
                        step = input.number(chances, (15 + i) * 8 * MODEL);
                    }
                    contact.now[i] += step;
                    contact.change[i] = i < 3 && continued ? step : 0;
                }
            }
            contact.moved = changed ? 1 : 0;
            for (let i = 0; i < QUANTA; ++i) note(contact.now[i]);
        };

        for (let frame = 0; frame < frames; ++frame) {
            for (let i = 0; i < count; ++i) {
                if (slot[i] < 0 && frame > 0) continue;
                const b = i * QUANTA;
                const changed = input.get(flags, moved[i]);
                for (let k = 0; k < channels; ++k) {
                    const former = now[b + k];
                    if (changed) {
                        const residual = input.number(chances, (k * 8 + size[b + k]) * MODEL);
                        size[b + k] = Math.min(7, 32 - Math.clz32(Math.abs(residual)));
                        now[b + k] = residual + (frame === 0 ? 0 : 2 * former - before[b + k]);
                    }
                    before[b + k] = frame === 0 ? now[b + k] : former;
                    note(now[b + k]);
                }
                moved[i] = changed ? 1 : 0;
                if (frame === 0) write(rest, i * 7, b);
                if (slot[i] >= 0) write(track, (frame * movers.length + slot[i]) * 7, b);
            }

            const next = [];
            for (let i = 0; i < alive.length; ++i) {
                if (!input.get(flags, 4)) continue;
                readTouch(alive[i], true);
                link.push(i);
                next.push(alive[i]);
            }
            const fresh = input.number(chances, 14 * 8 * MODEL);
            let last = new Int32Array(QUANTA);
            for (let i = 0; i < fresh; ++i) {
                const contact = {
                    now: last.slice(), change: new Int32Array(QUANTA), size: new Uint8Array(QUANTA), moved: 1,
                };
                readTouch(contact, false);
                last = contact.now.slice();
                link.push(-1);
                next.push(contact);
            }
            note(next.length);
            alive = next;
            for (const { now: q } of alive) {
                const order = turned ? [0, 2, 1] : [0, 1, 2], sign = turned ? [1, 1, -1] : [1, 1, 1];
                for (let k = 0; k < 3; ++k) spot.push(sign[k] * q[order[k]] * 4 * raw.grid);
                for (let k = 0; k < 3; ++k) normal.push(sign[k] * q[3 + order[k]]);
                level.push(q[6]);
            }
            contactStart[frame + 1] = level.length;
            if (drawing) drawing.add(readLines());
        }
        if ((check >>> 0) !== raw.check) throw new Error(`the recording of "${raw.title}, ${raw.scalar}" is damaged`);

        // Bodies that come or go: the frames in which each is seen.
        const spans = new Map();
        for (const [body, from, to] of raw.spans || []) spans.set(body, [...spans.get(body) || [], [from, to]]);

        // A joint is two bodies, and a point in the frame of each.
        const joints = raw.joints.map(([a, b, ...points]) => ({ a, b, at: points.slice(0, 3), to: points.slice(3) }));
        return {
            bodies, joints, spans, slot, movers: movers.length, track, rest, frames, plane, drawing,
            interval: raw.dt * raw.every,
            contacts: { start: contactStart, spot: spot.data, normal: normal.data, level: level.data, link: link.data },
        };
    }

    return { scene, NONE };
})();
