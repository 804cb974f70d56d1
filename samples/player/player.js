// The player: what is shown, the clock, the controls, and the facts that a check may read (window.player).
// The address may say what to show: #scene=1&t=2.5&paused&contacts&debug&compare&speed=0.5&yaw=1&pitch=0.4&zoom=2
// &renderer=canvas; scenes count from 0 in the order of the table.
"use strict";

(() => {
    const $ = id => document.getElementById(id);
    const recording = {
        title: "No recording", subtitle: "", bytes: 0, scenes: [], ...JSON.parse($("recording").textContent),
    };
    const scenes = recording.scenes, groups = [];
    for (const [index, raw] of scenes.entries()) {
        let group = groups.find(other => other.title === raw.title && other.dimension === raw.dimension);
        if (!group) groups.push(group = { title: raw.title, dimension: raw.dimension, runs: [] });
        group.runs.push(index);
    }
    const hasDrawing = scenes.some(scene => scene.palette);
    const groupOf = index => groups.find(group => group.runs.includes(index));

    const asked = new URLSearchParams(location.hash.slice(1));
    const stage = makeStage($("stage"), asked, draw);
    const state = {
        index: 0, compare: false, time: 0, playing: false, speed: 1, loop: true, contacts: false, debug: false,
        last: 0, pace: 0,       // the time of the last frame, and seconds a frame of late
    };
    let drawn = { bodies: 0, joints: 0, touches: 0, strokes: 0, time: -1 };

    // ---- Runs, unpacked when they are first shown

    const unpacked = new Map();
    function open(index) {
        if (!unpacked.has(index)) {
            const raw = scenes[index], scene = decode.scene(raw);
            unpacked.set(index, {
                raw, scene, extent: sample.extent(scene), levels: sample.levels(scene),
                poses: new Float32Array(scene.bodies.length * 7),
            });
        }
        return unpacked.get(index);
    }
    const shown = () => state.compare ? groupOf(state.index).runs : [state.index];
    const interval = () => scenes[state.index].dt * scenes[state.index].every;
    const duration = () => Math.max(...shown().map(i => (scenes[i].frames - 1) * scenes[i].dt * scenes[i].every));
    const levels = () => {
        const all = shown().map(index => open(index).levels);
        return [Math.min(...all.map(pair => pair[0])), Math.max(...all.map(pair => pair[1]))];
    };

    // ---- What the controls do

    function select(index, compare) {
        const former = groupOf(state.index), group = groupOf(index);
        state.index = index;
        state.compare = compare && group.runs.length > 1;
        if (group !== former) {
            state.time = 0;
            for (const run of unpacked.keys()) if (!group.runs.includes(run)) unpacked.delete(run);
        }
        stage.show(group, shown().map(open), state.compare);
        state.time = Math.min(state.time, duration());
        choices();
        refresh();
    }
    function seek(time) {
        state.time = Math.min(Math.max(time, 0), duration());
        refresh();
    }
    function play(on) {
        if (on && state.time >= duration()) state.time = 0;
        state.playing = on;
        refresh();
    }
    /// To the next recorded frame, or to another one from there.
    function step(frames) {
        state.playing = false;
        const at = state.time / interval(), near = Math.round(at);
        const here = Math.abs(at - near) < 1e-6 ? near : frames > 0 ? Math.floor(at) : Math.ceil(at);
        seek((here + frames) * interval());
    }
    function setSpeed(speed) {
        state.speed = speed;
        refresh();
    }
    function faster(by) {
        const options = $("speed").options;
        setSpeed(Number(options[Math.min(Math.max($("speed").selectedIndex + by, 0), options.length - 1)].value));
    }
    function toggle(what) {
        state[what] = !state[what];
        refresh();
    }

    // ---- The page around the stage

    function radio(holder, name, text, checked, action) {
        const [label, input, span] = ["label", "input", "span"].map(tag => document.createElement(tag));
        Object.assign(input, { type: "radio", name, checked });
        input.addEventListener("change", action);
        span.textContent = text;
        label.append(input, span);
        holder.append(label);
        return input;
    }
    let groupInputs = [], runInputs = [], runsOf = null;
    function choices() {
        const group = groupOf(state.index);
        if (!groupInputs.length && groups.length > 1)
            groupInputs = groups.map(one => radio($("groups"), "group", one.title, false, () => {
                const twin = one.runs.find(run => scenes[run].scalar === scenes[state.index].scalar);
                select(twin === undefined ? one.runs[0] : twin, state.compare);
            }));
        if (runsOf !== group) {
            runsOf = group;
            $("runs").textContent = "";
            runInputs = group.runs.length < 2 ? [] : [
                ...group.runs.map(run => radio($("runs"), "run", scenes[run].scalar, false, () => select(run, false))),
                radio($("runs"), "run", "Side by side", false, () => select(state.index, true)),
            ];
        }
        groupInputs.forEach((input, i) => { input.checked = groups[i] === group; });
        runInputs.forEach((input, i) => {
            input.checked = state.compare ? i === group.runs.length : group.runs[i] === state.index;
        });
        rows.forEach((row, i) => row.setAttribute("aria-current", shown().includes(i)));
    }

    const bytes = size => size < 1e6 ? `${Math.max(1, Math.round(size / 1e3))} kB` : `${(size / 1e6).toFixed(1)} MB`;
    const rows = [];
    function table() {
        const labels = [...new Set(scenes.flatMap(scene => scene.facts.map(fact => fact[0])))];
        const columns = [
            ["scene", scene => scene.title], ["run", scene => scene.scalar], ["space", scene => scene.dimension + "D"],
            ["bodies", scene => String(scene.bodies.length)],
            ...labels.map(label => [label, scene => (scene.facts.find(fact => fact[0] === label) || ["", ""])[1]]),
            ["recording", scene => bytes(scene.data.length)],
        ];
        const code = /^(0x)?[0-9a-f]{8,}$/i, figure = /^[-+−]?[\d.,   ]+(e[-+]?\d+)?( ?[^\d]{1,8})?$/;
        const styles = columns.map(([, text], i) => {
            const texts = scenes.map(text).filter(Boolean), all = kind => texts.every(value => kind.test(value));
            return i < 2 ? "" : all(code) ? "code" : all(figure) ? "figure" : "";
        });
        const row = (cells, parent) => {
            const line = document.createElement("tr");
            cells.forEach(([kind, text], i) => {
                const cell = document.createElement(kind);
                if (kind === "th") cell.scope = parent === "thead" ? "col" : "row";
                cell.textContent = text;
                if (styles[i] && !(styles[i] === "code" && parent === "thead")) cell.className = styles[i];
                line.append(cell);
            });
            document.querySelector(`#facts ${parent}`).append(line);
            return line;
        };
        row(columns.map(([label]) => ["th", label]), "thead");
        scenes.forEach((scene, index) => {
            const line = row(columns.map(([, text], i) => [i ? "td" : "th", text(scene)]), "tbody");
            if (groupOf(index).runs[0] === index) line.className = "first";
            line.addEventListener("click", () => select(index, false));
            rows.push(line);
        });
        $("facts").hidden = !scenes.length;
    }

    const impulse = level => {
        const value = 2 ** (level / 3);
        return `${value >= 100 ? Math.round(value) : value.toPrecision(2).replace(/e.*/, power => power)} N s`;
    };
    function refresh() {
        const total = duration(), time = state.time.toFixed(2);
        $("scrub").max = total;
        $("scrub").value = state.time;
        $("scrub").style.setProperty("--done", `${total ? 100 * state.time / total : 0}%`);
        $("scrub").setAttribute("aria-valuetext", `${time} of ${total.toFixed(2)} seconds`);
        $("time").firstElementChild.textContent = time;
        $("time").lastChild.textContent = ` / ${total.toFixed(2)} s`;
        $("play").toggleAttribute("data-on", state.playing);
        $("play").setAttribute("aria-label", state.playing ? "Pause" : "Play");
        $("speed").value = String(state.speed);
        $("loop").setAttribute("aria-pressed", state.loop);
        $("contacts").setAttribute("aria-pressed", state.contacts);
        $("debug").disabled = !shown().some(index => scenes[index].palette);
        $("debug").setAttribute("aria-pressed", state.debug);
        $("legend").hidden = !state.contacts;
        if (state.contacts) {
            const [low, high] = levels();
            $("legend-low").textContent = impulse(low);
            $("legend-high").textContent = impulse(high);
        }
        stage.spoil();
    }

    function draw() {
        if (scenes.length)
            drawn = { ...stage.draw(state.time, state.contacts, levels(), state.debug), time: state.time };
    }
    function tick(now) {
        const passed = Math.min(Math.max((now - state.last) / 1000, 0), 0.25);
        state.last = now;
        try {
            if (state.playing) {
                const total = duration();
                state.pace += 0.15 * (passed - state.pace);
                if (state.pace > 0.14) stage.hurry();
                let time = state.time + passed * state.speed;
                if (time >= total) {
                    state.playing = state.loop && total > 0;
                    time = state.playing ? time % total : total;
                }
                state.time = time;
                refresh();
            }
            if (stage.needsDrawing()) draw();
        } catch (error) {
            fail(error);
            return;
        }
        requestAnimationFrame(tick);
    }

    function controls() {
        $("play").addEventListener("click", () => play(!state.playing));
        $("back").addEventListener("click", () => step(-1));
        $("forward").addEventListener("click", () => step(1));
        $("loop").addEventListener("click", () => toggle("loop"));
        $("contacts").addEventListener("click", () => toggle("contacts"));
        $("debug").addEventListener("click", () => toggle("debug"));
        $("fit").addEventListener("click", () => stage.fit());
        $("speed").addEventListener("change", () => setSpeed(Number($("speed").value)));
        $("scrub").addEventListener("input", () => seek(Number($("scrub").value)));
        const keys = {
            " ": () => play(!state.playing), ArrowLeft: event => step(event.shiftKey ? -10 : -1),
            ArrowRight: event => step(event.shiftKey ? 10 : 1), ArrowUp: () => faster(1), ArrowDown: () => faster(-1),
            Home: () => seek(0), End: () => seek(duration()), c: () => toggle("contacts"), b: () => toggle("debug"),
            l: () => toggle("loop"), f: () => stage.fit(),
            "+": () => stage.zoom(1.15), "=": () => stage.zoom(1.15), "-": () => stage.zoom(1 / 1.15),
            a: () => stage.turn(-18, 0), d: () => stage.turn(18, 0),
            w: () => stage.turn(0, 18), s: () => stage.turn(0, -18),
        };
        addEventListener("keydown", event => {
            if (event.ctrlKey || event.metaKey || event.altKey) return;
            const action = keys[event.key.length === 1 ? event.key.toLowerCase() : event.key], at = event.target;
            const own = at.type === "radio" || at.tagName === "SELECT";        // they use the arrows themselves
            if (!action || own && (event.key.startsWith("Arrow") || event.key === " ")) return;
            if (at.tagName === "BUTTON" && event.key === " ") return;
            event.preventDefault();
            action(event);
        });
        const hints = [["space", "play"], ["← →", "frame"], ["↑ ↓", "speed"], ["C", "contacts"],
                       ...hasDrawing ? [["B", "debug drawing"]] : [], ["F", "fit"],
                       ["drag, wheel, WASD, + −", "view"]];
        for (const [key, text] of hints) {
            const hint = document.createElement("span"), name = document.createElement("kbd");
            name.textContent = key;
            hint.append(name, " " + text);
            $("keys").append(hint);
        }
    }

    /// Follows the address, at the start and when it changes.
    function follow() {
        for (const key of [...asked.keys()]) asked.delete(key);
        for (const [key, value] of new URLSearchParams(location.hash.slice(1))) asked.set(key, value);
        const index = Number(asked.get("scene"));
        const speed = [...$("speed").options].find(option => option.value === asked.get("speed"));
        if (speed) state.speed = Number(speed.value);
        state.contacts = asked.has("contacts");
        state.debug = asked.has("debug");
        state.playing = !asked.has("paused") && !matchMedia("(prefers-reduced-motion: reduce)").matches;
        stage.forgetCameras();
        select(scenes[index] ? index : 0, asked.has("compare"));
        seek(Number(asked.get("t")) || 0);
    }

    const facts = {
        sceneCount: () => scenes.length, scene: () => state.index, title: () => (scenes[state.index] || {}).title,
        scalar: () => (scenes[state.index] || {}).scalar, dimension: () => (scenes[state.index] || {}).dimension,
        frameCount: () => scenes.length ? scenes[state.index].frames : 0, time: () => state.time,
        frame: () => scenes.length ? Math.round(1e6 * state.time / interval()) / 1e6 : 0,
        duration: () => scenes.length ? duration() : 0,
        playing: () => state.playing, speed: () => state.speed, loop: () => state.loop, compare: () => state.compare,
        contactsShown: () => state.contacts,
        debugShown: () => state.debug,
        drawnTime: () => drawn.time, bodies: () => drawn.bodies, joints: () => drawn.joints,
        contacts: () => drawn.touches, lines: () => drawn.strokes,
        renderer: () => stage.rendererName(), pageBytes: () => recording.bytes, errors: () => [...troubles],
    };
    window.player = Object.freeze(Object.defineProperties({
        /// The pose of a body as it was drawn last: x, y, z, quaternion; y is up.
        pose: body => [...open(state.index).poses.subarray(7 * body, 7 * body + 7)],
        /// Unpacks every scene, and gives their number; one that is damaged throws.
        verify: () => scenes.map(decode.scene).length,
    }, Object.fromEntries(Object.entries(facts).map(([name, get]) => [name, { get, enumerable: true }]))));

    $("title").textContent = recording.title;
    $("subtitle").textContent = recording.subtitle;
    $("size").textContent = recording.bytes ? `One page, ${bytes(recording.bytes)}` : "";
    $("debug").hidden = !hasDrawing;
    controls();
    if (!scenes.length) return;
    table();
    addEventListener("hashchange", follow);
    follow();
    requestAnimationFrame(now => { state.last = now; tick(now); });
})();
