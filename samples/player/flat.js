// Draws scenes in the plane.
"use strict";

const flat = (() => {
    /// Places the camera so that the box fills the panel.
    function fit(camera, { low, high }, width, height) {
        const wide = high[0] - low[0], tall = high[1] - low[1];
        camera.scale = Math.min(width * 0.92 / wide, height * 0.8 / tall);
        camera.x = (low[0] + high[0]) / 2;
        // What is left of the height goes above.
        camera.y = low[1] + 0.36 * height / camera.scale;
    }

    /// Draws one panel: { x, y, width, height } in pixels of the canvas, `ratio` of them a CSS pixel.
    function draw(context, panel, ratio, { scene, poses, contacts, levels, extent, camera, colours, drawing }) {
        const theme = paint.now();
        const scale = camera.scale * ratio;
        const X = x => panel.x + panel.width / 2 + (x - camera.x) * scale;
        const Y = y => panel.y + panel.height / 2 - (y - camera.y) * scale;
        context.save();
        context.beginPath();
        context.rect(panel.x, panel.y, panel.width, panel.height);
        context.clip();
        context.lineJoin = "round";
        grid(context, panel, ratio, scale, camera, theme);

        // Shapes of one colour make one path, so that a scene costs a few fills.
        const paths = new Map();
        const pathOf = colour => {
            const key = colour.join();
            if (!paths.has(key))
                paths.set(key, { colour, fill: new Path2D(), mark: new Path2D(), hollow: new Path2D() });
            return paths.get(key);
        };
        let drawn = 0;
        const seen = new Set();
        for (const { body, shape, at } of sample.shapes(scene, poses)) {
            const angle = 2 * Math.atan2(at[5], at[6]), c = Math.cos(angle) * scale, s = Math.sin(angle) * scale;
            const x = X(at[0]), y = Y(at[1]);
            const to = (px, py) => [x + c * px - s * py, y - s * px - c * py];
            if (!seen.has(body)) { seen.add(body); ++drawn; }
            if (shape.form === "halfspace") {
                ground(context, panel, ratio, shape, at, X, Y, theme);
                continue;
            }
            const path = pathOf(colours[body]);
            const [fill, mark] = shape.hollow ? [path.hollow, path.hollow] : [path.fill, path.mark];
            if (shape.form === "box") {
                const [w, h] = shape.size;
                fill.moveTo(...to(-w, -h));
                fill.lineTo(...to(w, -h));
                fill.lineTo(...to(w, h));
                fill.lineTo(...to(-w, h));
                fill.closePath();
            } else if (shape.form === "sphere") {
                const r = shape.size[0] * scale;
                fill.moveTo(x + r, y);
                fill.arc(x, y, r, 0, 2 * Math.PI);
                mark.moveTo(...to(0.25 * shape.size[0], 0));
                mark.lineTo(...to(shape.size[0], 0));
            } else if (shape.form === "capsule") {
                const [r, half] = shape.size;
                fill.moveTo(...to(-half, -r));
                fill.arc(...to(half, 0), r * scale, -angle + Math.PI / 2, -angle - Math.PI / 2, true);
                fill.arc(...to(-half, 0), r * scale, -angle - Math.PI / 2, -angle + Math.PI / 2, true);
                fill.closePath();
                mark.moveTo(...to(-half, 0));
                mark.lineTo(...to(half, 0));
            } else {
                const path = shape.form === "polygon" ? fill : mark;
                for (let i = 0; i < shape.size.length; i += 2)
                    path[i ? "lineTo" : "moveTo"](...to(shape.size[i], shape.size[i + 1]));
                if (path === fill) fill.closePath();
            }
        }
        const pixels = extent.size * scale;
        const line = Math.min(Math.max(pixels * 0.07, 0.6 * ratio), 1.6 * ratio);
        for (const { colour, fill, mark, hollow } of paths.values()) {
            const paper = theme.dark ? paint.mix(colour, theme.edge, 0.08) : paint.mix(colour, [1, 1, 1], 0.14);
            context.fillStyle = paint.css(paper);
            context.fill(fill);
            context.lineWidth = line;
            context.strokeStyle = paint.css(paint.mix(colour, theme.edge, theme.dark ? 0.62 : 0.45));
            context.stroke(fill);
            context.lineCap = "round";
            context.stroke(mark);
            context.fillStyle = paint.css(paper, 0.18);
            context.fill(hollow);
            context.setLineDash([3 * ratio, 3 * ratio]);
            context.stroke(hollow);
            context.setLineDash([]);
        }
        joints(context, ratio, sample.joints(scene, poses), line, pixels, X, Y, theme);
        paint.strokes(context, ratio, drawing, point => [X(point[0]), Y(point[1]), 1]);
        for (const contact of contacts) touch(context, ratio, contact, levels, extent, scale, X, Y, theme);
        context.restore();
        return drawn;
    }

    function grid(context, panel, ratio, scale, camera, theme) {
        let step = 1;
        while (step * scale < 34 * ratio) step *= step.toString().startsWith("2") ? 2.5 : 2;
        while (step * scale > 120 * ratio) step /= 2;
        context.fillStyle = paint.css(theme.ink, theme.dark ? 0.13 : 0.11);
        const dot = 1.15 * ratio;
        const left = camera.x - panel.width / 2 / scale, low = camera.y - panel.height / 2 / scale;
        for (let x = Math.ceil(left / step) * step; x < left + panel.width / scale; x += step) {
            for (let y = Math.ceil(low / step) * step; y < low + panel.height / scale; y += step) {
                context.fillRect(panel.x + (x - left) * scale - dot / 2,
                                 panel.y + panel.height - (y - low) * scale - dot / 2, dot, dot);
            }
        }
    }

    function ground(context, panel, ratio, shape, at, X, Y, theme) {
        const normal = sample.rotate([at[3], at[4], at[5], at[6]], shape.size);
        const x = at[0] + normal[0] * shape.size[3], y = at[1] + normal[1] * shape.size[3];
        const far = 2 * (panel.width + panel.height);
        context.save();
        context.translate(X(x), Y(y));
        context.rotate(Math.atan2(-normal[1], normal[0]) + Math.PI / 2);
        // Slide along the surface, so that the part in view is always covered.
        context.fillStyle = paint.css(theme.ground);
        context.fillRect(-far, 0, 2 * far, far);
        context.fillStyle = paint.css(theme.groundLine);
        context.fillRect(-far, 0, 2 * far, 1.25 * ratio);
        context.restore();
    }

    /// A line from point to point, and where they are together a ring.
    function joints(context, ratio, all, line, pixels, X, Y, theme) {
        const lines = new Path2D(), rings = new Path2D(), r = Math.min(Math.max(pixels * 0.075, ratio), 2.6 * ratio);
        for (const [from, to] of all) {
            lines.moveTo(X(from[0]), Y(from[1]));
            lines.lineTo(X(to[0]), Y(to[1]));
            for (const [x, y] of [from, to]) {
                rings.moveTo(X(x) + r, Y(y));
                rings.arc(X(x), Y(y), r, 0, 2 * Math.PI);
            }
        }
        context.lineWidth = 1.6 * line;
        context.strokeStyle = paint.css(theme.ink, 0.8);
        context.stroke(lines);
        context.fillStyle = paint.css(theme.pale);
        context.fill(rings);
        context.lineWidth = line;
        context.strokeStyle = paint.css(theme.dark ? theme.edge : theme.ink);
        context.stroke(rings);
    }

    function touch(context, ratio, contact, levels, extent, scale, X, Y, theme) {
        const { part, colour } = paint.heat(contact[6], levels);
        const x = X(contact[0]), y = Y(contact[1]);
        const size = extent.size * scale;
        const length = size * (0.25 + 0.45 * part), radius = Math.min(Math.max(size * 0.09, 1.6 * ratio), 4 * ratio);
        context.lineCap = "round";
        context.lineWidth = radius * 0.7;
        context.strokeStyle = paint.css(colour);
        context.beginPath();
        context.moveTo(x, y);
        context.lineTo(x + contact[3] * length, y - contact[4] * length);
        context.stroke();
        context.beginPath();
        context.arc(x, y, radius, 0, 2 * Math.PI);
        context.fillStyle = paint.css(colour);
        context.fill();
        context.lineWidth = 0.8 * ratio;
        context.strokeStyle = paint.css(theme.dark ? theme.edge : [1, 1, 1], 0.85);
        context.stroke();
    }

    return { fit, draw };
})();
