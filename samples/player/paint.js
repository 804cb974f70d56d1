// Colours of the page's theme, and the camera that both 3D views share.
"use strict";

const paint = (() => {
    const BODIES = 6;
    let theme = null;

    /// Reads the colours from the style sheet, once per theme.
    function read() {
        const style = getComputedStyle(document.documentElement);
        const colour = name => {
            const text = style.getPropertyValue("--" + name).trim();
            return [1, 3, 5].map(i => parseInt(text.slice(i, i + 2), 16) / 255);
        };
        theme = {
            bodies: Array.from({ length: BODIES }, (_, i) => colour("body-" + i)),
            fixed: colour("fixed"), kinematic: colour("kinematic"), edge: colour("edge"),
            ground: colour("ground"), groundLine: colour("ground-line"), ink: colour("ink"),
            pale: colour("pale"), rod: colour("rod"),
            heat: [0, 1, 2, 3].map(i => colour("heat-" + i)),
            dark: matchMedia("(prefers-color-scheme: dark)").matches,
        };
        return theme;
    }
    const now = () => theme || read();

    /// A dynamic body keeps its colour through all runs: it depends on its number alone.
    function tint(body) {
        let mix = Math.imul(body + 11, 0x9e3779b1) >>> 0;
        mix = Math.imul(mix ^ mix >>> 15, 0x85ebca6b) >>> 0;
        return (mix >>> 8) % BODIES;
    }
    /// A colour for every body, its own or the one told; pale when contacts are to stand out.
    function bodies(scene, pale, told) {
        const { fixed, kinematic, bodies: palette, pale: paper } = now();
        return scene.bodies.map(({ motion }, number) => {
            const own = motion === 0 ? fixed : motion === 1 ? kinematic : palette[tint(number)];
            const colour = told ? told[number] : own;
            return pale ? mix(colour, paper, 0.66) : colour;
        });
    }

    /// The colour of an impulse level, and how far it is up the scale.
    function heat(level, [low, high]) {
        const part = level <= decode.NONE ? 0 : Math.min(Math.max((level - low) / (high - low), 0), 1);
        const at = Math.min(part * 3, 2.9999), i = Math.floor(at), stops = now().heat;
        return { part, colour: stops[i].map((value, k) => value + (stops[i + 1][k] - value) * (at - i)) };
    }

    const css = (colour, alpha = 1) =>
        `rgb(${colour.map(value => Math.round(Math.min(Math.max(value, 0), 1) * 255)).join(" ")} / ${alpha})`;
    const mix = (a, b, part) => a.map((value, k) => value + (b[k] - value) * part);

    const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    const unit = a => { const n = Math.hypot(...a) || 1; return a.map(value => value / n); };
    const SUN = unit([-0.5, 1, 0.62]);
    const TAN = Math.tan(0.5 * 32 * Math.PI / 180);      // half the vertical field of view

    /// The axes of an orbiting camera: right, up, and back (towards the viewer), and where it stands.
    function axes({ yaw, pitch, distance, target }) {
        const back = [Math.cos(pitch) * Math.sin(yaw), Math.sin(pitch), Math.cos(pitch) * Math.cos(yaw)];
        const right = [Math.cos(yaw), 0, -Math.sin(yaw)];
        return { right, up: cross(back, right), back, eye: target.map((value, k) => value + back[k] * distance) };
    }

    /// Places the camera so that the box fills the window.
    function fit(camera, { low, high }, aspect) {
        camera.target = low.map((value, k) => (value + high[k]) / 2);
        const { right, up, back } = axes(camera);
        camera.distance = 0;
        for (let corner = 0; corner < 8; ++corner) {
            const at = low.map((value, k) => (corner >> k & 1 ? high[k] : value) - camera.target[k]);
            const wide = Math.abs(dot(at, right)) / (TAN * aspect * 0.9), tall = Math.abs(dot(at, up)) / (TAN * 0.84);
            camera.distance = Math.max(camera.distance, Math.max(wide, tall) + dot(at, back));
        }
    }

    /// Lines and dots of debug drawing on a plain canvas, a path for each colour; project gives pixels, and the depth.
    function strokes(context, ratio, drawing, project) {
        const paths = new Map();
        for (const { ends, colour } of drawing) {
            const from = project(ends.subarray(0, 3)), to = project(ends.subarray(3, 6));
            if (from[2] < 0.1 || to[2] < 0.1) continue;
            if (!paths.has(colour)) paths.set(colour, [new Path2D(), new Path2D()]);
            const [stroke, dots] = paths.get(colour), r = 2.2 * ratio;
            if (lines.isDot(ends)) {
                dots.moveTo(from[0] + r, from[1]);
                dots.arc(from[0], from[1], r, 0, 2 * Math.PI);
            } else {
                stroke.moveTo(from[0], from[1]);
                stroke.lineTo(to[0], to[1]);
            }
        }
        context.lineWidth = 1.2 * ratio;
        for (const [colour, [stroke, dots]] of paths) {
            context.strokeStyle = context.fillStyle = css(colour);
            context.stroke(stroke);
            context.fill(dots);
        }
    }

    /// The matrix from the world to clip space, by columns.
    function matrix(camera, aspect, near, far) {
        const { right, up, back, eye } = axes(camera);
        const fx = 1 / (TAN * aspect), fy = 1 / TAN, a = (near + far) / (near - far), b = 2 * near * far / (near - far);
        const out = new Float32Array(16);
        for (let k = 0; k < 3; ++k) {
            out[4 * k] = fx * right[k];
            out[4 * k + 1] = fy * up[k];
            out[4 * k + 2] = a * back[k];
            out[4 * k + 3] = -back[k];
        }
        out[12] = -fx * dot(right, eye);
        out[13] = -fy * dot(up, eye);
        out[14] = -a * dot(back, eye) + b;
        out[15] = dot(back, eye);
        return out;
    }

    return { read, now, bodies, heat, css, mix, dot, cross, unit, axes, fit, strokes, matrix, SUN, TAN };
})();
