// The programs that run on the graphics processor.
"use strict";

const shaders = (() => {
    const instance = `#version 300 es
        layout(location = 0) in vec4 corner;      // on the unit shape; w: the side of a capsule
        layout(location = 1) in vec3 normal;
        layout(location = 2) in vec4 place;       // centre; w: 0 box, 1 ball or capsule, 2 ground
        layout(location = 3) in vec4 turn;
        layout(location = 4) in vec4 size;        // half extents or radius; w: half length of a capsule
        layout(location = 5) in vec3 tint;
        vec3 rotate(vec4 q, vec3 v) { return v + 2.0 * cross(q.xyz, cross(q.xyz, v) + q.w * v); }
        vec3 local() { return corner.xyz * size.xyz + vec3(corner.w * size.w, 0.0, 0.0); }
        vec3 world() { return place.xyz + rotate(turn, local()); }
    `;

    const shadow = [instance + `
        uniform mat4 sun;
        void main() { gl_Position = sun * vec4(world(), 1.0); }
    `, `#version 300 es
        precision mediump float;
        void main() {}
    `];

    const body = [instance + `
        uniform mat4 view;
        uniform mat4 sun;
        out vec3 spot, facing, inside;
        flat out vec3 colour;
        flat out vec4 bounds;
        flat out float form;
        flat out vec3 face;
        out vec3 lit;
        void main() {
            spot = world();
            facing = rotate(turn, normal);
            inside = local();
            face = abs(normal);
            colour = tint;
            bounds = size;
            form = place.w;
            lit = (sun * vec4(spot, 1.0)).xyz * 0.5 + 0.5;
            gl_Position = view * vec4(spot, 1.0);
        }
    `, `#version 300 es
        precision highp float;
        precision highp sampler2DShadow;
        uniform sampler2DShadow shade;
        uniform vec3 sunward, eye, centre, edge, groundLine;
        uniform float fade, texel, dark;
        in vec3 spot, facing, inside, lit;
        flat in vec3 colour;
        flat in vec4 bounds;
        flat in float form;
        flat in vec3 face;
        out vec4 pixel;

        vec3 linear(vec3 c) { return pow(c, vec3(2.2)); }

        // The part of the sun that reaches the spot, over a soft neighbourhood.
        float sunlight(vec3 n) {
            vec3 at = lit;
            if (any(lessThan(at, vec3(0.0))) || any(greaterThan(at, vec3(1.0)))) return 1.0;
            at.z -= 0.0012 + 0.002 * (1.0 - clamp(dot(n, sunward), 0.0, 1.0));
            float sum = 0.0;
            for (int i = -2; i <= 2; ++i) {
                for (int j = -2; j <= 2; ++j) sum += texture(shade, at + vec3(vec2(i, j) * texel * 1.3, 0.0));
            }
            return sum / 25.0;
        }

        // One on the lines where the value is zero, about as wide as told, in pixels; it fades where lines would crowd.
        float line(float value, float width) {
            float step = fwidth(value);
            return 1.0 - smoothstep(step * (width - 0.5), step * (width + 0.7), abs(value));
        }

        void main() {
            vec3 n = normalize(facing);
            float sun = sunlight(n);
            if (form > 1.5) {
                vec2 away = spot.xz - centre.xz;
                float near = 1.0 - smoothstep(0.18, 1.0, length(spot - centre) / fade);
                vec2 cell = abs(fract(inside.xz + 0.5) - 0.5) / max(fwidth(inside.xz), vec2(1e-4));
                float crowd = max(fwidth(inside.x), fwidth(inside.z));
                float mesh = (1.0 - smoothstep(0.4, 1.4, min(cell.x, cell.y))) * (1.0 - smoothstep(0.03, 0.16, crowd));
                vec3 base = mix(linear(colour), linear(groundLine), mesh * 0.26);
                vec3 shaded = mix(base * mix(0.42, 0.3, dark), base, sun);
                float cover = near * mix(0.92, 1.0, 1.0 - sun);
                pixel = vec4(pow(shaded, vec3(1.0 / 2.2)) * cover, cover);
                return;
            }
            vec3 base = linear(colour);
            float mark = 0.0;
            if (form < 0.5) {
                vec3 d = bounds.xyz - abs(inside) + 1.0e6 * face;      // to the edges of this face
                float rim = min(d.x, min(d.y, d.z));
                float least = min(bounds.x, min(bounds.y, bounds.z));
                float crowd = fwidth(rim) / least;
                mark = line(rim, 1.15) * (1.0 - smoothstep(0.1, 0.5, crowd)) * 0.62;
                base *= 1.0 + 0.10 * smoothstep(0.14, 0.0, rim / least) * (1.0 - smoothstep(0.02, 0.12, crowd));
            } else {
                vec3 ring = inside;
                if (bounds.w > 0.0) ring.x = abs(inside.x) - bounds.w;
                ring /= bounds.x;
                mark = max(line(ring.y, 0.9), max(line(ring.x, 0.9), bounds.w > 0.0 ? 0.0 : line(ring.z, 0.9))) * 0.45;
            }
            float lambert = max(dot(n, sunward), 0.0);
            vec3 sky = mix(vec3(0.50, 0.55, 0.62), vec3(0.34, 0.40, 0.48), dark);
            vec3 floorGlow = mix(vec3(0.36, 0.34, 0.31), vec3(0.16, 0.17, 0.18), dark);
            vec3 ambient = mix(floorGlow, sky, n.y * 0.5 + 0.5);
            vec3 warm = vec3(1.0, 0.965, 0.91) * mix(0.78, 0.72, dark);
            vec3 shaded = base * (ambient + warm * lambert * sun);
            vec3 seen = normalize(eye - spot);
            shaded += 0.05 * pow(1.0 - max(dot(n, seen), 0.0), 3.0) * sky;
            shaded = mix(shaded, linear(edge) + base * 0.16, mark);
            pixel = vec4(pow(shaded, vec3(1.0 / 2.2)), 1.0);
        }
    `];

    // A contact: a disc that faces the viewer, and a stroke along the normal. Sizes are in pixels.
    const touch = [`#version 300 es
        layout(location = 0) in vec2 corner;
        layout(location = 1) in vec4 from;        // w: radius of the disc
        layout(location = 2) in vec4 to;          // w: width of the stroke
        layout(location = 3) in vec3 tint;
        uniform mat4 view;
        uniform vec2 window;
        uniform float stroke;
        out vec2 inside;
        flat out vec3 colour;
        void main() {
            vec4 a = view * vec4(from.xyz, 1.0), b = view * vec4(to.xyz, 1.0);
            inside = corner;
            colour = tint;
            if (stroke > 0.5) {
                vec2 along = (b.xy / b.w - a.xy / a.w) * window;
                vec2 across = length(along) > 1e-4 ? normalize(vec2(-along.y, along.x)) : vec2(0.0);
                gl_Position = corner.x < 0.0 ? a : b;
                gl_Position.xy += across * corner.y * to.w / window * gl_Position.w;
            } else {
                gl_Position = a;
                gl_Position.xy += corner * (from.w + 1.0) * 2.0 / window * a.w;
            }
            gl_Position.z -= 0.004 * gl_Position.w * (1.0 - gl_Position.z / gl_Position.w);
        }
    `, `#version 300 es
        precision highp float;
        uniform float stroke, cover;
        uniform vec3 rim;
        in vec2 inside;
        flat in vec3 colour;
        out vec4 pixel;
        void main() {
            float alpha = cover;
            vec3 ink = colour;
            if (stroke < 0.5) {
                float r = length(inside), step = fwidth(r);
                alpha *= 1.0 - smoothstep(1.0 - step, 1.0, r);
                ink = mix(colour, rim, smoothstep(0.72 - step, 0.72 + step, r) * 0.85);
            }
            pixel = vec4(ink * alpha, alpha);
        }
    `];

    return { shadow, body, touch };
})();
