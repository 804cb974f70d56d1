// Draws scenes in space on a plain canvas, far faces first: for browsers without WebGL.
"use strict";

const wire = (() => {
    const FACES = [[0, 1, -1], [0, 1, 1], [1, 2, -1], [1, 2, 1], [2, 0, -1], [2, 0, 1]];

    function make(canvas) {
        const context = canvas.getContext("2d");
        return {
            name: "canvas",
            begin() {
                context.setTransform(1, 0, 0, 1, 0, 0);
                context.clearRect(0, 0, canvas.width, canvas.height);
            },
            draw: (panel, ratio, what) => draw(context, panel, ratio, what),
        };
    }

    function draw(context, panel, ratio, { scene, poses, contacts, levels, extent, camera, colours, drawing }) {
        const theme = paint.now();
        const { right, up, back, eye } = paint.axes(camera);
        const focal = panel.height / (2 * paint.TAN), cx = panel.x + panel.width / 2, cy = panel.y + panel.height / 2;
        const near = 0.05;
        /// Pixels, and the distance along the view.
        const project = p => {
            const v = [p[0] - eye[0], p[1] - eye[1], p[2] - eye[2]];
            const depth = -paint.dot(v, back), scale = focal / Math.max(depth, near);
            return [cx + paint.dot(v, right) * scale, cy - paint.dot(v, up) * scale, depth, scale];
        };
        context.save();
        context.beginPath();
        context.rect(panel.x, panel.y, panel.width, panel.height);
        context.clip();
        context.lineJoin = context.lineCap = "round";

        const items = [], grounds = [], seen = new Set();
        let floor = null;
        for (const { body, shape, at } of sample.shapes(scene, poses)) {
            seen.add(body);
            if (shape.hollow) continue;
            const turn = [at[3], at[4], at[5], at[6]], colour = colours[body];
            if (shape.form === "halfspace") {
                const n = sample.rotate(turn, shape.size);
                const offset = paint.dot(n, at) + shape.size[3];
                grounds.push({ n, offset });
                if (n[1] > 0.99) floor = offset;
            } else {
                items.push({ shape, at, turn, colour });
            }
        }
        for (const { shape, at } of sample.rods(scene, poses, 0.07 * extent.size))
            items.push({ shape, at, turn: at.slice(3), colour: theme.rod });
        const middle = extent.low.map((value, k) => (value + extent.high[k]) / 2);
        const radius = Math.max(Math.hypot(...extent.high.map((value, k) => value - extent.low[k])) / 2, 1);
        for (const ground of grounds) plane(context, project, ground, middle, radius, theme);
        if (floor !== null) shadows(context, project, items, floor, theme);

        const faces = [];
        for (const item of items) {
            if (item.shape.form === "box") boxFaces(faces, item, project, eye, theme);
            else ball(faces, item, project, theme);
        }
        faces.sort((a, b) => b.depth - a.depth);
        context.lineWidth = 1.1 * ratio;
        for (const face of faces) face.paint(context);
        paint.strokes(context, ratio, drawing, project);
        for (const contact of contacts) touch(context, project, ratio, contact, levels, extent, theme);
        context.restore();
        return seen.size;
    }

    const shadeOf = (normal, theme) => {
        const light = 0.62 + 0.2 * normal[1] + 0.38 * Math.max(paint.dot(normal, paint.SUN), 0);
        return theme.dark ? light * 0.86 : light;
    };

    function boxFaces(faces, { shape, at, turn, colour }, project, eye, theme) {
        const axes = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map((axis, k) =>
            sample.rotate(turn, axis).map(value => value * shape.size[k]));
        for (const [u, v, sign] of FACES) {
            const w = 3 - u - v;
            const normal = paint.unit(axes[w]).map(value => value * sign);
            const centre = axes[w].map((value, k) => at[k] + value * sign);
            if (paint.dot(normal, eye) <= paint.dot(normal, centre)) continue;
            const corners = [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(([a, b]) =>
                project(centre.map((value, k) => value + a * axes[u][k] + b * axes[v][k])));
            if (corners.some(corner => corner[2] < 0.1)) continue;
            const shade = shadeOf(normal, theme);
            // A large face is sorted by its farthest point, so that small things stay on top of it.
            const depth = project(centre)[2] * 0.6 + Math.max(...corners.map(corner => corner[2])) * 0.4;
            faces.push({
                depth,
                paint(context) {
                    context.beginPath();
                    corners.forEach((corner, i) => context[i ? "lineTo" : "moveTo"](corner[0], corner[1]));
                    context.closePath();
                    context.fillStyle = paint.css(colour.map(value => value * shade));
                    context.strokeStyle = paint.css(paint.mix(colour.map(value => value * shade), theme.edge, 0.5));
                    context.fill();
                    context.stroke();
                },
            });
        }
    }

    function ball(faces, { shape, at, turn, colour }, project, theme) {
        const [r, half = 0] = shape.size;
        const axis = sample.rotate(turn, [half, 0, 0]);
        const ends = half ? [-1, 1].map(s => project([at[0] + s * axis[0], at[1] + s * axis[1], at[2] + s * axis[2]]))
                          : [project(at)];
        if (ends.some(end => end[2] < 0.1)) return;
        // A ring shows how it is turned.
        const rim = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12].map(i => {
            const angle = i * Math.PI / 12;
            const local = sample.rotate(turn, [r * Math.cos(angle) + half, r * Math.sin(angle), 0]);
            return project([at[0] + local[0], at[1] + local[1], at[2] + local[2]]);
        });
        const middle = project(at);
        faces.push({
            depth: middle[2],
            paint(context) {
                const outline = scale => {
                    context.beginPath();
                    if (ends.length === 1) {
                        context.arc(ends[0][0], ends[0][1], r * ends[0][3] * scale, 0, 2 * Math.PI);
                    } else {
                        const [a, b] = ends, angle = Math.atan2(b[1] - a[1], b[0] - a[0]);
                        context.arc(a[0], a[1], r * a[3] * scale, angle + Math.PI / 2, angle - Math.PI / 2);
                        context.arc(b[0], b[1], r * b[3] * scale, angle - Math.PI / 2, angle + Math.PI / 2);
                        context.closePath();
                    }
                };
                const size = (r + half) * middle[3];
                const glow = context.createRadialGradient(middle[0] - size * 0.3, middle[1] - size * 0.45, size * 0.05,
                                                          middle[0], middle[1], size * 1.1);
                const [light, low] = theme.dark ? [0.98, 0.45] : [1.12, 0.62];
                glow.addColorStop(0, paint.css(colour.map(value => value * light)));
                glow.addColorStop(1, paint.css(colour.map(value => value * low)));
                context.fillStyle = glow;
                outline(1);
                context.fill();
                context.strokeStyle = paint.css(paint.mix(colour, theme.edge, 0.55));
                context.stroke();
                context.beginPath();
                rim.forEach((p, i) => context[i && p[2] <= middle[2] ? "lineTo" : "moveTo"](p[0], p[1]));
                context.strokeStyle = paint.css(paint.mix(colour, theme.edge, 0.35), 0.7);
                context.stroke();
            },
        });
    }

    /// The ground as a soft-edged disc.
    function plane(context, project, { n, offset }, middle, radius, theme) {
        const foot = middle.map((value, k) => value - n[k] * (paint.dot(n, middle) - offset));
        const side = paint.unit(Math.abs(n[0]) < 0.9 ? paint.cross(n, [1, 0, 0]) : paint.cross(n, [0, 1, 0]));
        const ahead = paint.cross(n, side);
        const rings = 14;
        for (let ring = 0; ring < rings; ++ring) {
            const size = 3 - 2.2 * ring / rings;
            context.beginPath();
            let shown = true;
            for (let i = 0; i < 72; ++i) {
                const c = Math.cos(i * Math.PI / 36) * size * radius, s = Math.sin(i * Math.PI / 36) * size * radius;
                const p = project(foot.map((value, k) => value + c * side[k] + s * ahead[k]));
                shown = shown && p[2] > 0.1;
                context[i ? "lineTo" : "moveTo"](p[0], p[1]);
            }
            context.closePath();
            context.fillStyle = paint.css(theme.ground, 0.13);
            if (shown) context.fill();
        }
    }

    /// The shadows on a level floor, all in one path so that they do not darken each other.
    function shadows(context, project, items, floor, theme) {
        context.beginPath();
        for (const { shape, at, turn } of items) {
            const points = [];
            const cast = p => {
                const t = (p[1] - floor) / paint.SUN[1];
                if (t >= -0.2) points.push(project([p[0] - paint.SUN[0] * t, floor, p[2] - paint.SUN[2] * t]));
            };
            if (shape.form === "box") {
                for (let corner = 0; corner < 8; ++corner) {
                    const local = sample.rotate(turn, shape.size.map((value, k) => corner >> k & 1 ? value : -value));
                    cast([at[0] + local[0], at[1] + local[1], at[2] + local[2]]);
                }
            } else {
                const [r, half = 0] = shape.size, axis = sample.rotate(turn, [half, 0, 0]);
                for (let i = 0; i < 16; ++i) {
                    for (const end of half ? [-1, 1] : [0]) {
                        const c = Math.cos(i * Math.PI / 8) * r * 1.15, s = Math.sin(i * Math.PI / 8) * r * 1.15;
                        cast([at[0] + end * axis[0] + c, at[1] + end * axis[1], at[2] + end * axis[2] + s]);
                    }
                }
            }
            if (points.length < 3 || points.some(point => point[2] < 0.1)) continue;
            hull(points).forEach((p, i) => context[i ? "lineTo" : "moveTo"](p[0], p[1]));
            context.closePath();
        }
        context.fillStyle = theme.dark ? "rgb(0 0 0 / .34)" : "rgb(40 44 52 / .2)";
        context.fill("nonzero");
    }

    /// The convex hull, always in the same sense of turning.
    function hull(points) {
        points.sort((a, b) => a[0] - b[0] || a[1] - b[1]);
        const half = list => {
            const out = [];
            for (const p of list) {
                while (out.length > 1) {
                    const [a, b] = out.slice(-2);
                    if ((b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) > 0) break;
                    out.pop();
                }
                out.push(p);
            }
            return out.slice(0, -1);
        };
        return [...half(points), ...half([...points].reverse())];
    }

    function touch(context, project, ratio, contact, levels, extent, theme) {
        const { part, colour } = paint.heat(contact[6], levels);
        const length = extent.size * (0.25 + 0.4 * part);
        const a = project(contact), b = project([0, 1, 2].map(k => contact[k] + contact[3 + k] * length));
        if (a[2] < 0.1 || b[2] < 0.1) return;
        const radius = Math.min(Math.max(extent.size * a[3] * 0.085, 1.7 * ratio), 4.2 * ratio);
        context.lineWidth = radius * 0.7;
        context.strokeStyle = context.fillStyle = paint.css(colour);
        context.beginPath();
        context.moveTo(a[0], a[1]);
        context.lineTo(b[0], b[1]);
        context.stroke();
        context.beginPath();
        context.arc(a[0], a[1], radius, 0, 2 * Math.PI);
        context.fill();
        context.lineWidth = 0.8 * ratio;
        context.strokeStyle = paint.css(theme.dark ? theme.edge : [1, 1, 1], 0.85);
        context.stroke();
    }

    return { make };
})();
