"use strict";
// plays what bodies do, of several sources at once; the box around it has the stage and the controls
const Replay = (() => {
  const LINE = 14, SHADE = { ambient: 0.65, diffuse: 0.6, specular: 0.1, roughness: 0.8 };
  // half of the height that Plotly's eye sees at distance 1; parts of the stage that the scene may fill
  const SEEN_HALF = Math.tan(Math.PI / 8), FILL = { wide: 0.94, high: 0.8 };
  // width of a letter in a name, and rows in which names stand at most: more of them are left to the list
  const LETTER = 7.5, ROWS = 2;
  // a whole number that is 1 in a quaternion
  const ONE = 32767;
  // one that is the reach in a range, and how strong a ray is
  const FAR = 65535, RAY = 0.55;
  const FLOOR = "#E8E8E8", SEEN = { several: 0.72, alone: 1 };
  const bytes = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)).buffer;
  // where the eye stands, by the axis along which sources stand side by side
  const FRONT = 1;
  const VIEWS = {
    "from the corner": (across) => (across === 1 ? { x: 0.75, y: -1.5, z: 0.75 } : { x: 1.5, y: -0.75, z: 0.75 }),
    "from the front": (across) => (across === 1 ? { x: 1.9, y: 0, z: 0.12 } : { x: 0, y: -1.9, z: 0.12 }),
    "from the side": (across) => (across === 1 ? { x: 0, y: -1.9, z: 0.12 } : { x: 1.9, y: 0, z: 0.12 }),
    "from above": () => ({ x: 0, y: -0.01, z: 2.2 }),
  };
  const WEBGL = Boolean(document.createElement("canvas").getContext("webgl"));
  class Replay {
    static draws = WEBGL;
    constructor(box) {
      this.box = box;
      this.plot = box.querySelector(".stage");
      this.control = (name) => box.querySelector(`[name=${name}]`);
      this.playing = null;
      this.control("play").addEventListener("click", () => this.toggle());
      this.control("time").addEventListener("input", (event) => this.seek(Number(event.target.value)));
      this.control("time").addEventListener("keydown", (event) => {
        if (event.key !== " ") return;
        event.preventDefault();
        this.toggle();
      });
      this.control("view").addEventListener("change", () => this.look());
      for (const name of ["lanes", "rays"]) this.control(name)?.addEventListener("change", () => this.draw());
      if (this.control("level")) this.control("level").addEventListener("change", () => this.list());
      window.addEventListener("resize", () => this.draw());
    }
    // shows a scene; the same one with other motions keeps how it is looked at
    show(scene, isSame = false) {
      if (this.playing) this.toggle();
      for (const motion of scene.actors.flatMap((actor) => Object.values(actor.motions))) {
        motion.at = new Float32Array(bytes(motion.at));
        motion.turn = Float32Array.from(new Int16Array(bytes(motion.turn)), (one) => one / ONE);
      }
      for (const ranges of scene.actors.map((actor) => actor.ranges || {})) {
        for (const name of Object.keys(ranges)) ranges[name] = new Uint16Array(bytes(ranges[name]));
      }
      if (this.control("rays")) this.control("rays").closest("label").hidden = !Object.keys(scene.eyes || {}).length;
      this.scene = scene;
      this.time = scene.begin;
      Object.assign(this.control("time"), { min: scene.begin, max: scene.end });
      this.offer(scene.levels);
      if (!isSame) {
        this.control("lanes").checked = scene.flat;
        this.control("view").selectedIndex = scene.flat && scene.upright ? FRONT : 0;
        this.list();
        if (this.plot.layout) this.look();
      } else this.list();
    }
    // the levels of which one is shown
    offer(levels) {
      const list = this.control("level");
      if (!list) return;
      const last = list.value;
      list.replaceChildren(...levels.map((level) => new Option(level, level, false, level === last)));
      list.closest("label").hidden = levels.length < 2;
    }
    get faces() { return this.control("view").selectedIndex === FRONT; }
    get level() { return this.scene.levels.length > 1 ? this.control("level").value : this.scene.levels[0]; }
    get candidates() { return this.scene.actors.filter((actor) => !actor.level || actor.level === this.level); }
    get shown() {
      const off = new Set([...this.box.querySelectorAll(".sources input")].filter((one) => !one.checked).map((one) => one.value));
      return this.candidates.filter((actor) => !off.has(actor.label));
    }
    // one box to tick for each source of the level; what was hidden stays hidden
    list() {
      const list = this.box.querySelector(".sources"), last = [...list.querySelectorAll("input")];
      const off = new Set(last.filter((one) => !one.checked).map((one) => one.value));
      // the same boxes stay, so that a key that is on one of them stays there
      if (last.map((one) => one.value + one.dataset.colour).join() === this.candidates.map((actor) => actor.label + actor.colour).join()) return this.draw();
      list.replaceChildren(...this.candidates.map((actor) => {
        const label = document.createElement("label"), input = document.createElement("input"), swatch = document.createElement("span");
        Object.assign(input, { type: "checkbox", value: actor.label, checked: !off.has(actor.label) });
        input.dataset.colour = actor.colour;
        input.addEventListener("change", () => this.draw());
        swatch.className = "dot";
        swatch.style.background = actor.colour;
        label.append(input, swatch, actor.label);
        return label;
      }));
      this.draw();
    }
    // the picture before the instant that is shown, the one after it, and how far it is between them
    between() {
      const { begin, end, count } = this.scene;
      const exact = (this.time - begin) / (end - begin) * (count - 1), first = Math.min(Math.floor(exact), count - 1);
      return { first, second: Math.min(first + 1, count - 1), part: exact - first };
    }
    // place of a body, and rows of the matrix that turns it
    pose(motion, shift) {
      const { first, second, part } = this.between();
      const moves = motion.at.length > 3, here = moves ? 3 * first : 0, next = moves ? 3 * second : 0;
      const at = [0, 1, 2].map((i) => (1 - part) * motion.at[here + i] + part * motion.at[next + i]);
      at[this.scene.across] += shift;
      const turns = motion.turn.length > 4, a = turns ? 4 * first : 0, b = turns ? 4 * second : 0;
      // the shorter way from one turn to the next
      const sign = [0, 1, 2, 3].reduce((sum, i) => sum + motion.turn[a + i] * motion.turn[b + i], 0) < 0 ? -1 : 1;
      const q = [0, 1, 2, 3].map((i) => (1 - part) * motion.turn[a + i] + sign * part * motion.turn[b + i]);
      const length = Math.hypot(...q) || 1, [w, x, y, z] = q.map((one) => one / length);
      const rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
      ];
      return { at, rows };
    }
    // places of all corners of one source
    corners(actor, shift) {
      const found = [[], [], []];
      for (const [name, motion] of Object.entries(actor.motions)) {
        const { at, rows } = this.pose(motion, shift), [cx, cy, cz] = this.scene.bodies[name].corners;
        rows.forEach((row, axis) => {
          for (let k = 0; k < cx.length; k += 1) found[axis].push(at[axis] + row[0] * cx[k] + row[1] * cy[k] + row[2] * cz[k]);
        });
      }
      return found;
    }
    // the rays of one source as lines from its eyes to what they meet; none where they meet nothing
    rays(actor, shift) {
      const found = [[], [], []], { first, second, part } = this.between(), { across, eyes } = this.scene;
      for (const [name, ranges] of Object.entries(actor.ranges || {})) {
        const { body, at, rays, reach } = eyes[name], still = { at: [0, 1, 2].map((i) => (i === across ? shift : 0)), rows: [[1, 0, 0], [0, 1, 0], [0, 0, 1]] };
        const { at: place, rows } = body ? this.pose(actor.motions[body], shift) : still;
        const seen = (ray, far) => rows.map((row, axis) => place[axis] + row.reduce((sum, one, i) => sum + one * (at[i] + far * ray[i]), 0));
        const begin = seen([0, 0, 0], 0), picture = part < 0.5 ? first : second;
        rays.forEach((ray, zone) => {
          const far = ranges[picture * rays.length + zone] / FAR * reach;
          if (far) seen(ray, far).forEach((end, axis) => found[axis].push(begin[axis], end, null));
        });
      }
      return found;
    }
    // what of a source is drawn as lines
    beam([x, y, z], actor) {
      return { type: "scatter3d", mode: "lines", x, y, z, line: { width: 1.5, color: actor.colour }, opacity: RAY, hoverinfo: "skip", connectgaps: false };
    }
    // triangles of all bodies that a source tells of, numbered through
    triangles(actor) {
      const found = [[], [], []];
      let count = 0;
      for (const name of Object.keys(actor.motions)) {
        const { corners, triangles } = this.scene.bodies[name];
        triangles.forEach((row, i) => row.forEach((one) => found[i].push(one + count)));
        count += corners[0].length;
      }
      return found;
    }
    shifts(shown) {
      if (!this.control("lanes").checked) return shown.map(() => 0);
      return shown.map((_, i) => (i - (shown.length - 1) / 2) * this.scene.width);
    }
    // colour of each corner: parts of a body that are set off are darker
    tones(actor) {
      const rgb = [1, 3, 5].map((at) => parseInt(actor.colour.slice(at, at + 2), 16));
      return Object.keys(actor.motions).flatMap((name) => this.scene.bodies[name].tones.map((tone) => `rgb(${rgb.map((one) => Math.round(one * tone)).join(",")})`));
    }
    mesh([x, y, z], [i, j, k], colour, opacity, name) {
      return { type: "mesh3d", x, y, z, i, j, k, ...(Array.isArray(colour) ? { vertexcolor: colour } : { color: colour }), opacity, name, flatshading: false, lighting: SHADE, hoverinfo: name ? "name" : "skip" };
    }
    // what never moves: solids once in each lane, floors and walls once under all of them
    still(shifts) {
      const { still, ground, across, low, high } = this.scene, apart = [...new Set(shifts)];
      const ends = [Math.min(...apart, 0), Math.max(...apart, 0)], middle = (low[across] + high[across]) / 2;
      const places = [0, 1, 2].map((axis) => [
        ...apart.flatMap((shift) => still.corners[axis].map((one) => one + (axis === across ? shift : 0))),
        ...ground.corners[axis].map((one) => one + (axis === across ? ends[Number(one > middle)] : 0)),
      ]);
      const count = still.corners[0].length;
      const faces = [0, 1, 2].map((corner) => [
        ...apart.flatMap((_, n) => still.triangles[corner].map((one) => one + n * count)),
        ...ground.triangles[corner].map((one) => one + apart.length * count),
      ]);
      return { ...this.mesh(places, faces, FLOOR, 1, ""), lighting: { ambient: 0.85, diffuse: 0.25, specular: 0 } };
    }
    // in so many rows names do not lie on each other, seen from the front
    rows(shown) {
      const longest = Math.max(...shown.map((one) => this.short(one).length + 1)) * LETTER;
      return this.faces ? Math.ceil(longest * shown.length / (FILL.wide * this.plot.clientWidth)) : 1;
    }
    short(actor) { return actor.label.replace(/ \(.*/, ""); }
    // the name of each source: at the foot of its lane, or above where floors or another name would hide it
    names(shown, shifts) {
      const { low, high, across } = this.scene, rows = this.rows(shown);
      const above = shown.map((_, i) => !this.faces || i % rows > 0);
      const axes = [0, 1, 2].map((axis) => shifts.map((shift, i) => (axis === across ? (low[axis] + high[axis]) / 2 + shift : axis === 2 && above[i] ? high[axis] : low[axis])));
      const [x, y, z] = axes;
      return { type: "scatter3d", mode: "text", x, y, z, text: shown.map(this.short), textfont: { size: LINE - 1, color: "#222" }, textposition: above.map((one) => (one ? "top center" : "bottom center")), hoverinfo: "skip" };
    }
    range(shifts) {
      return [0, 1, 2].map((axis) => {
        const wider = axis === this.scene.across ? Math.max(...shifts, 0) : 0;
        return [this.scene.low[axis] - wider, this.scene.high[axis] + wider];
      });
    }
    // a metre is as long along each axis, and the whole is as large as fits into the stage
    aspect(range) {
      const sizes = range.map(([low, high]) => high - low), longest = Math.max(...sizes), { x, y, z } = this.camera().eye;
      let low = 0, high = 4;
      for (let k = 0; k < 24; k += 1) {
        const scale = (low + high) / 2;
        if (this.fits(sizes.map((one) => one / longest * scale), [x, y, z])) low = scale;
        else high = scale;
      }
      return Object.fromEntries(["x", "y", "z"].map((key, axis) => [key, sizes[axis] / longest * low]));
    }
    // whether a box about the origin is seen as a whole from a place
    fits(sizes, eye) {
      const dot = (a, b) => a.reduce((sum, one, i) => sum + one * b[i], 0), unit = (a) => a.map((one) => one / Math.hypot(...a));
      const ahead = unit(eye.map((one) => -one)), right = unit([ahead[1], -ahead[0], 0]);
      const up = [right[1] * ahead[2], -right[0] * ahead[2], right[0] * ahead[1] - right[1] * ahead[0]];
      const stage = this.plot.clientWidth / this.plot.clientHeight;
      return [0, 1, 2, 3, 4, 5, 6, 7].every((n) => {
        const corner = sizes.map((one, axis) => ((n >> axis) & 1 ? one : -one) / 2), half = (Math.hypot(...eye) + dot(corner, ahead)) * SEEN_HALF;
        return half > 0.05 && Math.abs(dot(corner, up)) < FILL.high * half && Math.abs(dot(corner, right)) < FILL.wide * stage * half;
      });
    }
    draw() {
      if (!this.scene || !this.plot.clientWidth) return;
      if (!WEBGL) {
        const picture = this.scene.pictures?.[this.level], text = this.box.dataset.flat || "";
        this.plot.replaceChildren(...(picture ? [Object.assign(new Image(), { src: picture, alt: "" })] : []), text);
        return;
      }
      const shown = this.shown, shifts = this.shifts(shown), lanes = this.control("lanes").checked;
      const seen = shown.length > 1 && !lanes ? SEEN.several : SEEN.alone;
      const data = shown.map((actor, n) => this.mesh(this.corners(actor, shifts[n]), this.triangles(actor), this.tones(actor), seen, actor.label));
      const looking = this.control("rays")?.checked ? shown.map((actor, n) => [actor, shifts[n]]).filter(([actor]) => Object.keys(actor.ranges || {}).length) : [];
      for (const [actor, shift] of looking) data.push(this.beam(this.rays(actor, shift), actor));
      if (this.scene.still.corners[0].length + this.scene.ground.corners[0].length) data.push(this.still(shifts));
      if (lanes && shown.length > 1 && this.rows(shown) <= ROWS) data.push(this.names(shown, shifts));
      // lanes have no place of their own, and what is seen from its end has no length
      const bare = (i) => lanes && i < 2 && (i === this.scene.across || this.faces);
      const range = this.range(shifts), sizes = range.map(([low, high]) => high - low), longest = Math.max(...sizes);
      const axis = (i, title) => ({ range: range[i], title: { text: bare(i) ? "" : title }, showticklabels: !bare(i), showspikes: false, backgroundcolor: "#fff", gridcolor: "#ddd", nticks: Math.max(3, Math.round(6 * sizes[i] / longest)), tickfont: { size: LINE - 3 } });
      const camera = this.plot.layout ? this.plot.layout.scene.camera : this.camera();
      const layout = {
        margin: { l: 0, r: 0, t: 0, b: 0 }, showlegend: false, width: this.plot.clientWidth, height: this.plot.clientHeight,
        paper_bgcolor: "#fff", font: { size: LINE },
        scene: { aspectmode: "manual", aspectratio: this.aspect(range), camera, xaxis: axis(0, "x (m)"), yaxis: axis(1, "y (m)"), zaxis: axis(2, "z (m)") },
      };
      Plotly.react(this.plot, data, layout, { displaylogo: false, displayModeBar: false, scrollZoom: false });
      this.drawn = shown.map((actor, n) => [actor, shifts[n]]);
      this.looking = looking;
      this.tell();
    }
    camera() { return { eye: VIEWS[this.control("view").value](this.scene.across), center: { x: 0, y: 0, z: 0 } }; }
    look() {
      if (!this.plot.layout) return;
      this.plot.layout.scene.camera = this.camera();
      this.draw();
    }
    tell() {
      const text = `${this.time.toFixed(3)} s`;
      this.control("time").value = this.time;
      this.control("time").setAttribute("aria-valuetext", text);
      this.box.querySelector("output").textContent = text;
    }
    seek(time) {
      this.time = time;
      this.tell();
      if (!this.drawn || !this.drawn.length) return Promise.resolve();
      const places = [...this.drawn.map(([actor, shift]) => this.corners(actor, shift)), ...this.looking.map(([actor, shift]) => this.rays(actor, shift))];
      const update = Object.fromEntries(["x", "y", "z"].map((key, axis) => [key, places.map((one) => one[axis])]));
      return Plotly.restyle(this.plot, update, places.map((_, n) => n));
    }
    toggle() {
      // each playing is one of its own: what is left of one before does not go on beside it
      const mine = this.playing = this.playing ? null : {};
      const button = this.control("play");
      button.textContent = mine ? button.dataset.pause : button.dataset.play;
      if (!mine) return;
      if (this.time >= this.scene.end) this.time = this.scene.begin;
      let last = performance.now();
      const step = (now) => {
        if (this.playing !== mine) return;
        const next = this.time + (now - last) / 1000 * Number(this.control("speed").value);
        last = now;
        this.seek(Math.min(next, this.scene.end)).then(() => {
          if (this.playing !== mine) return;
          if (this.time >= this.scene.end) this.toggle();
          else requestAnimationFrame(step);
        });
      };
      requestAnimationFrame(step);
    }
  }
  return Replay;
})();

// in a report every replay is played from the JSON in it; it is drawn when it comes into view
(() => {
  const boxes = new Set(document.querySelectorAll(".replay:has(> script)"));
  const begin = (box) => {
    if (!boxes.has(box) || !box.querySelector(".stage").clientWidth) return;
    boxes.delete(box);
    new Replay(box).show(JSON.parse(box.querySelector("script").textContent));
  };
  const watcher = new IntersectionObserver((seen) => seen.filter((one) => one.isIntersecting).forEach((one) => begin(one.target)), { rootMargin: "200px" });
  boxes.forEach((box) => watcher.observe(box));
  window.addEventListener("beforeprint", () => boxes.forEach(begin));
})();
