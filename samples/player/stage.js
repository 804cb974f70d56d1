// The stage: canvases, the panels of the runs that are shown, cameras, and what mouse and fingers do to them.
"use strict";

function makeStage(element, asked, redraw) {
    const flatCanvas = document.getElementById("flat"), solidCanvas = document.getElementById("solid");
    const labels = document.getElementById("labels");
    const flatContext = flatCanvas.getContext("2d");
    const cameras = new Map();         // by group, so that all runs of a scene are seen alike
    let shown = [], group = null, compare = false, panels = [];
    let ratio = 1, width = 1, height = 1, dirty = true;

    // ---- How scenes in space are drawn: with WebGL, or without

    let solidView = null;
    const plainView = () => {
        dirty = true;
        return solidView = wire.make(flatCanvas);
    };
    function openSolid() {
        if (solidView) return solidView;
        if (asked.get("renderer") === "canvas") return plainView();
        try {
            solidView = solid.make(solidCanvas);
        } catch (error) {
            console.warn("WebGL is there, but does not work: " + error.message);
        }
        solidCanvas.addEventListener("webglcontextlost", plainView);
        return solidView || plainView();
    }
    /// Where WebGL runs on the processor the plain view is several times faster. The address can insist on WebGL.
    function hurry() {
        if (rendererName() === "webgl" && asked.get("renderer") !== "webgl") plainView();
    }
    const rendererName = () => group && group.dimension === 3 && solidView ? solidView.name : "canvas";

    // ---- Panels

    function resize() {
        ratio = Math.min(devicePixelRatio || 1, 3);
        width = Math.max(1, element.clientWidth);
        height = Math.max(1, element.clientHeight);
        for (const canvas of [flatCanvas, solidCanvas]) {
            canvas.width = Math.round(width * ratio);
            canvas.height = Math.round(height * ratio);
        }
        layout();
    }

    /// Shows these runs of a group, beside each other if there are several.
    function show(newGroup, runs, comparing) {
        group = newGroup;
        shown = runs;
        compare = comparing;
        layout();
    }

    function layout() {
        const stacked = width < 0.8 * height;
        labels.textContent = "";
        labels.className = stacked ? "stacked" : "";
        panels = shown.map((run, i) => {
            const panel = { run, x: 0, y: 0, width, height };
            if (stacked) panel.y = i * (panel.height = height / shown.length);
            else panel.x = i * (panel.width = width / shown.length);
            const [label, text, name] = ["p", "span", "b"].map(tag => document.createElement(tag));
            name.textContent = compare ? run.raw.scalar : run.raw.title;
            text.append(name, compare ? "" : " · " + run.raw.scalar);
            label.append(text);
            const place = { left: panel.x, top: panel.y, width: panel.width, height: panel.height };
            for (const [key, value] of Object.entries(place)) label.style[key] = value + "px";
            labels.append(label);
            return panel;
        });
        // A camera that nobody has moved goes on to fit.
        if (cameras.has(group) && !cameras.get(group).moved) cameras.delete(group);
        dirty = true;
    }

    function camera() {
        if (!cameras.has(group)) {
            const made = group.dimension === 2 ? {} : { yaw: 0.62, pitch: 0.26 };
            for (const angle of ["yaw", "pitch"]) {
                const value = parseFloat(asked.get(angle));
                if (angle in made && Number.isFinite(value)) made[angle] = value;
            }
            place(made);
            if (Number(asked.get("zoom")) > 0) zoom(made, Number(asked.get("zoom")));
            made.moved = false;
            cameras.set(group, made);
        }
        return cameras.get(group);
    }
    function place(view) {
        const { extent } = shown[0], panel = panels[0];
        if (group.dimension === 2) flat.fit(view, extent, panel.width, panel.height);
        else paint.fit(view, extent, panel.width / panel.height);
    }
    function fit() {
        place(camera());
        camera().moved = false;
        dirty = true;
    }

    // ---- Moving the camera; x and y are in CSS pixels

    const under = (x, y) =>
        panels.find(p => x >= p.x && x < p.x + p.width && y >= p.y && y < p.y + p.height) || panels[0];
    function changed(view) {
        view.moved = true;
        dirty = true;
    }
    function zoom(view, factor, x, y) {
        changed(view);
        if (group.dimension === 3) {
            const size = shown[0].extent.size;
            view.distance = Math.min(Math.max(view.distance / factor, 2 * size), 1000 * size);
            return;
        }
        const panel = panels.length && x !== undefined ? under(x, y) : null;
        const dx = panel ? x - panel.x - panel.width / 2 : 0, dy = panel ? panel.y + panel.height / 2 - y : 0;
        const before = view.scale;
        view.scale = Math.min(Math.max(view.scale * factor, 1), 4000);
        view.x += dx / before - dx / view.scale;
        view.y += dy / before - dy / view.scale;
    }
    function pan(view, dx, dy) {
        changed(view);
        if (group.dimension === 2) {
            view.x -= dx / view.scale;
            view.y += dy / view.scale;
            return;
        }
        const { right, up } = paint.axes(view), pixel = 2 * paint.TAN * view.distance / panels[0].height;
        view.target = view.target.map((value, k) => value - right[k] * dx * pixel + up[k] * dy * pixel);
    }
    function orbit(view, dx, dy) {
        changed(view);
        view.yaw -= dx * 0.007;
        view.pitch = Math.min(Math.max(view.pitch + dy * 0.006, -0.1), 1.55);
    }
    function turn(dx, dy) {
        if (group.dimension === 2) pan(camera(), dx, dy);
        else orbit(camera(), dx, dy);
    }

    const fingers = new Map();
    for (const canvas of [flatCanvas, solidCanvas]) {
        canvas.addEventListener("pointerdown", event => {
            canvas.setPointerCapture(event.pointerId);
            fingers.set(event.pointerId, event);
        });
        canvas.addEventListener("pointermove", event => {
            const former = fingers.get(event.pointerId);
            if (!former || !shown.length) return;
            const dx = event.clientX - former.clientX, dy = event.clientY - former.clientY;
            const other = [...fingers.values()].find(finger => finger.pointerId !== event.pointerId);
            if (other) {
                const apart = finger => Math.hypot(finger.clientX - other.clientX, finger.clientY - other.clientY) || 1;
                const box = element.getBoundingClientRect();
                zoom(camera(), apart(event) / apart(former), (event.clientX + other.clientX) / 2 - box.left,
                     (event.clientY + other.clientY) / 2 - box.top);
                pan(camera(), dx / 2, dy / 2);
            } else if (former.button === 2 || event.shiftKey) {
                pan(camera(), dx, dy);
            } else {
                turn(dx, dy);
            }
            // The button is told only when it goes down.
            const { pointerId, clientX, clientY } = event;
            fingers.set(pointerId, { pointerId, clientX, clientY, button: former.button });
        });
        for (const end of ["pointerup", "pointercancel"])
            canvas.addEventListener(end, event => fingers.delete(event.pointerId));
        canvas.addEventListener("contextmenu", event => event.preventDefault());
        canvas.addEventListener("dblclick", () => shown.length && fit());
        canvas.addEventListener("wheel", event => {
            event.preventDefault();
            if (!shown.length) return;
            const box = element.getBoundingClientRect(), unit = [1, 16, 300][event.deltaMode];
            zoom(camera(), Math.exp(-Math.max(-300, Math.min(300, event.deltaY * unit)) * 0.0016),
                 event.clientX - box.left, event.clientY - box.top);
        }, { passive: false });
    }

    /// Draws the runs at a time; gives the number of bodies, joints, contacts and lines that it drew.
    function draw(time, withContacts, levels, withDrawing) {
        dirty = false;
        const space = group.dimension === 3, view = space ? openSolid() : null;
        const onSolid = space && view.name === "webgl";
        solidCanvas.hidden = !onSolid;
        flatCanvas.hidden = onSolid;
        if (space) view.begin();
        else flatContext.clearRect(0, 0, flatCanvas.width, flatCanvas.height);
        let bodies = 0, joints = 0, touches = 0, strokes = 0;
        for (const panel of panels) {
            const { scene, extent, poses } = panel.run;
            const contacts = withContacts ? sample.contacts(scene, time) : [];
            const placed = sample.poses(scene, time, poses), isDrawn = withDrawing && scene.drawing !== null;
            const drawing = isDrawn ? lines.at(scene, time, placed) : [];
            const what = {
                scene, poses: placed, contacts, levels, extent, camera: camera(), drawing,
                colours: paint.bodies(scene, withContacts, isDrawn ? lines.tints(scene, time) : null),
            };
            const [x, y, right, low] = [panel.x, panel.y, panel.x + panel.width, panel.y + panel.height]
                .map(value => Math.round(value * ratio));
            const pixels = { x, y, width: right - x, height: low - y };
            bodies += space ? view.draw(pixels, ratio, what) : flat.draw(flatContext, pixels, ratio, what);
            joints += scene.joints.length;
            touches += contacts.length;
            strokes += drawing.length;
        }
        return { bodies, joints, touches, strokes };
    }

    // Resizing clears a canvas: draw before the browser shows it.
    new ResizeObserver(() => { resize(); redraw(); }).observe(element);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { paint.read(); dirty = true; });
    resize();
    return {
        show, draw, fit, turn, hurry, rendererName,
        zoom: factor => zoom(camera(), factor),
        needsDrawing: () => dirty,
        spoil() { dirty = true; },
        forgetCameras: () => cameras.clear(),
    };
}
