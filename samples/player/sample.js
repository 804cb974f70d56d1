// What a scene looks like at any time: poses and contacts between the recorded frames, and its extent.
"use strict";

const sample = (() => {
    /// The frame before a time and the fraction to the next one.
    function place(scene, time) {
        const last = scene.frames - 1;
        const at = Math.min(Math.max(time / scene.interval, 0), last);
        const nearest = Math.round(at);
        if (Math.abs(at - nearest) < 1e-6) return [nearest, 0];
        return [Math.floor(at), at - Math.floor(at)];
    }

    /// Fills out with seven numbers a body. Positions follow a cubic curve while the motion is smooth; at a kink,
    /// such as a bounce, the curve takes the tangent of its own side, so that the kink stays one.
    function poses(scene, time, out) {
        const [frame, part] = place(scene, time);
        const { track, rest, slot, movers, frames } = scene;
        const row = movers * 7;
        for (let body = 0; body < slot.length; ++body) {
            const o = body * 7;
            if (slot[body] < 0) {
                for (let k = 0; k < 7; ++k) out[o + k] = rest[o + k];
                continue;
            }
            const b = frame * row + slot[body] * 7;
            if (part === 0) {
                for (let k = 0; k < 7; ++k) out[o + k] = track[b + k];
                continue;
            }
            const c = b + row, a = frame > 0 ? b - row : -1, d = frame + 2 < frames ? c + row : -1;
            const u = part, u2 = u * u, u3 = u2 * u;
            const smoothBefore = a >= 0 && smooth(track, a, b, c), smoothAfter = d >= 0 && smooth(track, b, c, d);
            for (let k = 0; k < 3; ++k) {
                const p = track[b + k], q = track[c + k];
                const from = smoothBefore ? (q - track[a + k]) / 2 : q - p;
                const to = smoothAfter ? (track[d + k] - p) / 2 : q - p;
                out[o + k] = p + from * (u - 2 * u2 + u3) + (q - p) * (3 * u2 - 2 * u3) + to * (u3 - u2);
            }
            let same = 0, length = 0;
            for (let k = 3; k < 7; ++k) same += track[b + k] * track[c + k];
            const sign = same < 0 ? -u : u;
            for (let k = 3; k < 7; ++k) {
                out[o + k] = track[b + k] * (1 - u) + track[c + k] * sign;
                length += out[o + k] * out[o + k];
            }
            length = Math.sqrt(length) || 1;
            for (let k = 3; k < 7; ++k) out[o + k] /= length;
        }
        // Who is not there has no place.
        const now = part < 0.5 ? frame : frame + 1;
        for (const [body, spans] of scene.spans)
            if (!spans.some(([from, to]) => from <= now && now <= to)) out[body * 7] = NaN;
        return out;
    }

    function smooth(track, a, b, c) {
        let bend = 0, way = 0;
        for (let k = 0; k < 3; ++k) {
            const first = track[b + k] - track[a + k], second = track[c + k] - track[b + k];
            bend += (second - first) ** 2;
            way += Math.max(first * first, second * second);
        }
        return bend < 0.1 * way;
    }

    /// Contacts as [x, y, z, nx, ny, nz, level]; a contact that both frames have moves from one to the other.
    function contacts(scene, time) {
        const [frame, part] = place(scene, time);
        const { start, spot, normal, level, link } = scene.contacts;
        const heir = new Int32Array(start[frame + 1] - start[frame]).fill(-1);
        const list = [];
        if (part > 0) {
            for (let j = start[frame + 1]; j < start[frame + 2]; ++j) {
                if (link[j] >= 0) heir[link[j]] = j;
                else if (part >= 0.5) list.push(single(j));
            }
        }
        for (let i = start[frame]; i < start[frame + 1]; ++i) {
            const j = heir[i - start[frame]];
            if (j < 0) {
                if (part < 0.5) list.push(single(i));
                continue;
            }
            const from = single(i), to = single(j);
            const between = from.map((value, k) => value + (to[k] - value) * part);
            if (from[6] <= decode.NONE || to[6] <= decode.NONE) between[6] = part < 0.5 ? from[6] : to[6];
            list.push(between);
        }
        return list;

        function single(i) {
            return [spot[3 * i], spot[3 * i + 1], spot[3 * i + 2],
                    normal[3 * i] / 64, normal[3 * i + 1] / 64, normal[3 * i + 2] / 64, level[i]];
        }
    }

    const rotate = (q, v) => {
        const [x, y, z, w] = q;
        const tx = 2 * (y * v[2] - z * v[1]), ty = 2 * (z * v[0] - x * v[2]), tz = 2 * (x * v[1] - y * v[0]);
        return [v[0] + w * tx + y * tz - z * ty, v[1] + w * ty + z * tx - x * tz, v[2] + w * tz + x * ty - y * tx];
    };
    const multiply = (a, b) => [
        a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1],
        a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0],
        a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3],
        a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2],
    ];

    /// Every shape of the scene with its pose, [x, y, z, quaternion].
    function* shapes(scene, poses) {
        for (let body = 0; body < scene.bodies.length; ++body) {
            const pose = poses.subarray(body * 7, body * 7 + 7);
            if (Number.isNaN(pose[0])) continue;
            for (const shape of scene.bodies[body].shapes) {
                const turn = [pose[3], pose[4], pose[5], pose[6]], local = shape.local;
                const away = rotate(turn, local);
                const at = [pose[0] + away[0], pose[1] + away[1], pose[2] + away[2],
                            ...multiply(turn, [local[3], local[4], local[5], local[6]])];
                yield { body, kind: scene.bodies[body], shape, at };
            }
        }
    }

    /// Every joint of the scene by its two points.
    function joints(scene, poses) {
        const place = (body, point) => {
            const [x, y, z, ...turn] = poses.subarray(body * 7, body * 7 + 7), away = rotate(turn, point);
            return [x + away[0], y + away[1], z + away[2]];
        };
        return scene.joints.map(({ a, b, at, to }) => [place(a, at), place(b, to)])
            .filter(ends => !ends.flat().some(Number.isNaN));
    }
    /// Those whose points are apart, as thin capsules: ropes, rods and springs.
    function* rods(scene, poses, radius) {
        for (const [from, to] of joints(scene, poses)) {
            const along = to.map((value, k) => value - from[k]), length = Math.hypot(...along);
            if (length < radius) continue;
            // The rotation that takes the x axis there.
            const turn = [0, -along[2], along[1], length + along[0]];
            const norm = Math.hypot(...turn), unit = norm > 1e-6 * length ? turn.map(v => v / norm) : [0, 0, 1, 0];
            yield {
                shape: { form: "capsule", size: [radius, length / 2] },
                at: [...from.map((value, k) => (value + to[k]) / 2), ...unit],
            };
        }
    }

    const reach = ({ form, size }) =>
        form === "sphere" ? size[0] : form === "capsule" ? size[0] + size[1] : form === "box" ? Math.hypot(...size) : 0;

    /// How thick a shape is: a contact is drawn in proportion to that, so that planks do not get long arrows.
    const thickness = ({ form, size }) =>
        form === "box" ? 1.4 * Math.min(...size.filter(value => value > 0)) : size[0];

    /// The box in which nearly all of the motion is, so that one body that flies away does not make the others small;
    /// and the typical thickness of a moving shape.
    function extent(scene) {
        const poses = new Float32Array(scene.bodies.length * 7);
        const low = [[], [], []], high = [[], [], []], sizes = [];
        const stride = Math.max(1, Math.floor(scene.frames / 40));
        for (let frame = 0; frame < scene.frames; frame += stride) {
            sample.poses(scene, frame * scene.interval, poses);
            for (const { kind, shape, at } of shapes(scene, poses)) {
                const r = reach(shape);
                if (kind.motion === 0 || r === 0) continue;
                sizes.push(thickness(shape));
                for (let k = 0; k < 3; ++k) {
                    low[k].push(at[k] - 0.8 * r);
                    high[k].push(at[k] + 0.8 * r);
                }
            }
            // What hangs is seen with what it hangs on.
            for (const end of joints(scene, poses).flat())
                for (let k = 0; k < 3; ++k) {
                    low[k].push(end[k]);
                    high[k].push(end[k]);
                }
        }
        if (!sizes.length) return { low: [-5, -5, -5], high: [5, 5, 5], size: 1 };
        const rank = (list, part) => Float64Array.from(list).sort()[Math.round(part * (list.length - 1))];
        return {
            low: low.map(list => rank(list, 0.002)), high: high.map(list => rank(list, 0.998)), size: rank(sizes, 0.5),
        };
    }

    /// The impulse levels between which the colours run: nearly all that occur.
    function levels(scene) {
        const counts = new Map();
        let total = 0;
        const all = scene.contacts.level, end = scene.contacts.start[scene.frames];
        for (let i = 0; i < end; ++i) {
            if (all[i] <= decode.NONE) continue;
            counts.set(all[i], (counts.get(all[i]) || 0) + 1);
            ++total;
        }
        const keys = [...counts.keys()].sort((a, b) => a - b);
        let seen = 0, low = 0, high = 1;
        for (const key of keys) {
            if (seen <= 0.03 * total) low = key;
            if (seen <= 0.995 * total) high = key;
            seen += counts.get(key);
        }
        return [low, Math.max(high, low + 3)];
    }

    return { poses, contacts, shapes, joints, rods, extent, levels, rotate, multiply, place };
})();
