// Draws scenes in space with WebGL: lit boxes, balls and capsules, soft shadows, contacts.
"use strict";

const solid = (() => {
    const FLOATS = 16;           // of an instance: place, turn, size, tint
    const SHADOW = 2048;         // pixels of the shadow map's side
    const forms = ["box", "ball", "ground"];

    function boxMesh() {
        const out = [];
        for (let axis = 0; axis < 3; ++axis) {
            for (const sign of [-1, 1]) {
                const normal = [0, 0, 0];
                normal[axis] = sign;
                const corners = [[-1, -1], [1, -1], [1, 1], [-1, -1], [1, 1], [-1, 1]];
                for (const [a, b] of sign > 0 ? corners : corners.reverse()) {
                    const at = [0, 0, 0];
                    at[axis] = sign;
                    at[(axis + 1) % 3] = a;
                    at[(axis + 2) % 3] = b;
                    out.push(...at, 0, ...normal);
                }
            }
        }
        return out;
    }

    /// A ball around the x axis whose halves can be pulled apart, which makes it a capsule.
    function ballMesh(rings = 10, turns = 28) {
        const rows = [];
        for (const side of [-1, 1]) {
            for (let i = 0; i <= rings; ++i) {
                const angle = side < 0 ? Math.PI - i * Math.PI / 2 / rings : Math.PI / 2 - i * Math.PI / 2 / rings;
                rows.push({ x: Math.cos(angle), r: Math.sin(angle), side });
            }
        }
        const out = [];
        const push = (row, turn) => {
            const angle = turn * 2 * Math.PI / turns;
            const at = [row.x, row.r * Math.cos(angle), row.r * Math.sin(angle)];
            out.push(...at, row.side, ...at);
        };
        for (let i = 0; i + 1 < rows.length; ++i) {
            for (let k = 0; k < turns; ++k) {
                push(rows[i], k); push(rows[i], k + 1); push(rows[i + 1], k + 1);
                push(rows[i], k); push(rows[i + 1], k + 1); push(rows[i + 1], k);
            }
        }
        return out;
    }

    const groundMesh = () =>
        [[-1, -1], [1, 1], [1, -1], [-1, -1], [-1, 1], [1, 1]].flatMap(([x, z]) => [x, 0, z, 0, 0, 1, 0]);

    /// Makes a view on a canvas, or null where WebGL 2 is missing.
    function make(canvas) {
        const gl = canvas.getContext("webgl2", { antialias: true });
        if (!gl) return null;

        const program = ([vertex, fragment]) => {
            const made = gl.createProgram();
            for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
                const part = gl.createShader(kind);
                gl.shaderSource(part, text);
                gl.compileShader(part);
                if (!gl.getShaderParameter(part, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(part));
                gl.attachShader(made, part);
            }
            gl.linkProgram(made);
            if (!gl.getProgramParameter(made, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(made));
            const uniforms = {};
            for (let i = 0; i < gl.getProgramParameter(made, gl.ACTIVE_UNIFORMS); ++i) {
                const { name } = gl.getActiveUniform(made, i);
                uniforms[name] = gl.getUniformLocation(made, name);
            }
            return { made, uniforms };
        };
        const shadowProgram = program(shaders.shadow), bodyProgram = program(shaders.body);
        const touchProgram = program(shaders.touch);

        const attribute = (place, count, stride, offset, each) => {
            gl.enableVertexAttribArray(place);
            gl.vertexAttribPointer(place, count, gl.FLOAT, false, 4 * stride, 4 * offset);
            gl.vertexAttribDivisor(place, each);
        };
        const meshes = [boxMesh(), ballMesh(), groundMesh()].map(mesh => {
            const array = gl.createVertexArray(), vertices = gl.createBuffer(), instances = gl.createBuffer();
            gl.bindVertexArray(array);
            gl.bindBuffer(gl.ARRAY_BUFFER, vertices);
            gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(mesh), gl.STATIC_DRAW);
            attribute(0, 4, 7, 0, 0);
            attribute(1, 3, 7, 4, 0);
            gl.bindBuffer(gl.ARRAY_BUFFER, instances);
            for (let i = 0; i < 4; ++i) attribute(2 + i, i === 3 ? 3 : 4, FLOATS, 4 * i, 1);
            return { array, instances, vertices: mesh.length / 7, count: 0 };
        });
        const touchArray = gl.createVertexArray(), touchQuad = gl.createBuffer(), touchInstances = gl.createBuffer();
        gl.bindVertexArray(touchArray);
        gl.bindBuffer(gl.ARRAY_BUFFER, touchQuad);
        gl.bufferData(gl.ARRAY_BUFFER, new Float32Array([-1, -1, 1, -1, -1, 1, 1, 1]), gl.STATIC_DRAW);
        attribute(0, 2, 2, 0, 0);
        gl.bindBuffer(gl.ARRAY_BUFFER, touchInstances);
        attribute(1, 4, 11, 0, 1);
        attribute(2, 4, 11, 4, 1);
        attribute(3, 3, 11, 8, 1);
        gl.bindVertexArray(null);

        const shade = gl.createTexture();
        gl.bindTexture(gl.TEXTURE_2D, shade);
        gl.texStorage2D(gl.TEXTURE_2D, 1, gl.DEPTH_COMPONENT24, SHADOW, SHADOW);
        for (const [key, value] of [
            [gl.TEXTURE_MIN_FILTER, gl.LINEAR], [gl.TEXTURE_MAG_FILTER, gl.LINEAR],
            [gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE], [gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE],
            [gl.TEXTURE_COMPARE_MODE, gl.COMPARE_REF_TO_TEXTURE], [gl.TEXTURE_COMPARE_FUNC, gl.LEQUAL],
        ]) gl.texParameteri(gl.TEXTURE_2D, key, value);
        const shadowFrame = gl.createFramebuffer();
        gl.bindFramebuffer(gl.FRAMEBUFFER, shadowFrame);
        gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.TEXTURE_2D, shade, 0);
        gl.bindFramebuffer(gl.FRAMEBUFFER, null);

        const drawMesh = mesh => {
            if (!mesh.count) return;
            gl.bindVertexArray(mesh.array);
            gl.drawArraysInstanced(gl.TRIANGLES, 0, mesh.vertices, mesh.count);
        };
        const upload = (buffer, data) => {
            gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
            gl.bufferData(gl.ARRAY_BUFFER, data, gl.DYNAMIC_DRAW);
        };

        function begin() {
            gl.bindFramebuffer(gl.FRAMEBUFFER, null);
            gl.disable(gl.SCISSOR_TEST);
            gl.clearColor(0, 0, 0, 0);
            gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
        }

        /// Draws one panel: { x, y, width, height } in pixels from the upper left.
        function draw(panel, ratio, { scene, poses, contacts, levels, extent, camera, colours, drawing }) {
            const theme = paint.now();
            const middle = extent.low.map((value, k) => (value + extent.high[k]) / 2);
            const radius = Math.max(Math.hypot(...extent.high.map((value, k) => value - extent.low[k])) / 2, 1);
            const fade = 3.2 * radius;

            const lists = forms.map(() => []);
            const seen = new Set();
            for (const { body, shape, at } of sample.shapes(scene, poses)) {
                seen.add(body);
                if (shape.hollow) continue;
                const [a, b, c, d] = shape.size, tint = colours[body];
                if (shape.form === "box") {
                    lists[0].push(at[0], at[1], at[2], 0, at[3], at[4], at[5], at[6], a, b, c, 0, ...tint, 1);
                } else if (shape.form === "sphere" || shape.form === "capsule") {
                    const half = shape.form === "capsule" ? b : 0;
                    lists[1].push(at[0], at[1], at[2], 1, at[3], at[4], at[5], at[6], a, a, a, half, ...tint, 1);
                } else if (shape.form === "halfspace") {
                    // The part of the plane that is below the scene.
                    const n = sample.rotate([at[3], at[4], at[5], at[6]], [a, b, c]);
                    const near = middle.map(Math.round), height = paint.dot(n, near) - paint.dot(n, at) - d;
                    const foot = near.map((value, k) => value - n[k] * height);
                    const turn = n[1] < -0.9999 ? [1, 0, 0, 0] : [n[2], 0, -n[0], 1 + n[1]];
                    const length = Math.hypot(...turn), unit = turn.map(value => value / length);
                    lists[2].push(...foot, 2, ...unit, fade, 1, fade, 0, ...theme.ground, 1);
                }
            }
            for (const { shape, at } of sample.rods(scene, poses, 0.07 * extent.size)) {
                const [r, half] = shape.size;
                lists[1].push(at[0], at[1], at[2], 1, at[3], at[4], at[5], at[6], r, r, r, half, ...theme.rod, 1);
            }
            lists.forEach((list, i) => {
                meshes[i].count = list.length / FLOATS;
                if (list.length) upload(meshes[i].instances, new Float32Array(list));
            });

            gl.enable(gl.DEPTH_TEST);
            gl.depthFunc(gl.LEQUAL);
            gl.depthMask(true);
            gl.disable(gl.BLEND);
            const sun = sunMatrix(middle, radius);
            gl.bindFramebuffer(gl.FRAMEBUFFER, shadowFrame);
            gl.disable(gl.SCISSOR_TEST);
            gl.viewport(0, 0, SHADOW, SHADOW);
            gl.clear(gl.DEPTH_BUFFER_BIT);
            gl.useProgram(shadowProgram.made);
            gl.uniformMatrix4fv(shadowProgram.uniforms.sun, false, sun);
            drawMesh(meshes[0]);
            drawMesh(meshes[1]);
            gl.bindFramebuffer(gl.FRAMEBUFFER, null);

            const low = canvas.height - panel.y - panel.height;
            gl.viewport(panel.x, low, panel.width, panel.height);
            gl.enable(gl.SCISSOR_TEST);
            gl.scissor(panel.x, low, panel.width, panel.height);
            const { eye } = paint.axes(camera);
            const near = Math.max(camera.distance - 2 * radius, 0.02 * camera.distance, 0.05);
            const view = paint.matrix(camera, panel.width / panel.height, near, camera.distance + 2 * fade);
            const u = bodyProgram.uniforms;
            gl.useProgram(bodyProgram.made);
            gl.uniformMatrix4fv(u.view, false, view);
            gl.uniformMatrix4fv(u.sun, false, sun);
            gl.uniform3fv(u.sunward, paint.SUN);
            gl.uniform3fv(u.eye, eye);
            gl.uniform3f(u.centre, middle[0], extent.low[1], middle[2]);
            gl.uniform3fv(u.edge, theme.edge);
            gl.uniform3fv(u.groundLine, theme.groundLine);
            gl.uniform1f(u.fade, fade);
            gl.uniform1f(u.texel, 1 / SHADOW);
            gl.uniform1f(u.dark, theme.dark ? 1 : 0);
            drawMesh(meshes[0]);
            drawMesh(meshes[1]);
            gl.enable(gl.BLEND);
            gl.blendFunc(gl.ONE_MINUS_DST_ALPHA, gl.ONE);      // behind what is there
            gl.depthMask(false);
            drawMesh(meshes[2]);
            if (drawing.length) drawStrokes(panel, ratio, view, drawing, theme);
            if (contacts.length) drawTouches(panel, ratio, view, contacts, levels, extent, theme, camera);
            gl.depthMask(true);
            return seen.size;
        }

        function drawTouches(panel, ratio, view, contacts, levels, extent, theme, camera) {
            const pixels = extent.size * panel.height / (2 * paint.TAN * camera.distance);
            const radius = Math.min(Math.max(pixels * 0.085, 1.7 * ratio), 4.2 * ratio);
            const data = new Float32Array(contacts.length * 11);
            contacts.forEach((contact, i) => {
                const { part, colour } = paint.heat(contact[6], levels);
                const length = extent.size * (0.25 + 0.4 * part);
                data.set([contact[0], contact[1], contact[2], radius,
                          contact[0] + contact[3] * length, contact[1] + contact[4] * length,
                          contact[2] + contact[5] * length, radius * 0.75, ...colour], i * 11);
            });
            drawMarks(panel, view, data, [1, 0], theme);
        }
        /// Lines and dots of debug drawing.
        function drawStrokes(panel, ratio, view, drawing, theme) {
            for (const dots of [false, true]) {
                const list = drawing.filter(({ ends }) => lines.isDot(ends) === dots);
                const data = new Float32Array(list.length * 11);
                list.forEach(({ ends: [x, y, z, a, b, c], colour }, i) =>
                    data.set([x, y, z, 2.2 * ratio, a, b, c, 1.2 * ratio, ...colour], i * 11));
                if (list.length) drawMarks(panel, view, data, [dots ? 0 : 1], theme);
            }
        }
        /// Strokes (1) and discs (0) at their beginnings, eleven numbers each.
        function drawMarks(panel, view, data, kinds, theme) {
            upload(touchInstances, data);
            const u = touchProgram.uniforms;
            gl.useProgram(touchProgram.made);
            gl.bindVertexArray(touchArray);
            gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
            gl.uniformMatrix4fv(u.view, false, view);
            gl.uniform2f(u.window, panel.width, panel.height);
            gl.uniform3fv(u.rim, theme.dark ? theme.edge : [1, 1, 1]);
            // First, faintly, those behind a body; then those in sight.
            for (const [test, cover] of [[gl.GREATER, 0.5], [gl.LEQUAL, 1]]) {
                gl.depthFunc(test);
                gl.uniform1f(u.cover, cover);
                for (const stroke of kinds) {
                    gl.uniform1f(u.stroke, stroke);
                    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, data.length / 11);
                }
            }
        }

        return { name: "webgl", begin, draw };
    }

    /// The sun sees the ball around the scene.
    function sunMatrix(middle, radius) {
        const back = paint.SUN, right = paint.unit(paint.cross([0, 1, 0], back)), up = paint.cross(back, right);
        const out = new Float32Array(16), r = 1.15 * radius;
        [right, up, back.map(value => -value)].forEach((axis, row) => {
            const scale = row === 2 ? 1 / (2 * r) : 1 / r;
            for (let k = 0; k < 3; ++k) out[4 * k + row] = axis[k] * scale;
            out[12 + row] = -paint.dot(axis, middle) * scale;
        });
        out[15] = 1;
        return out;
    }

    return { make };
})();
