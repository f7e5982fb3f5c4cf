// The map in three dimensions, by three.js: levels of detail one after another, coloured by what is
// known of a point or of the scan that stood nearest; before and after closing; places, distances.

const kColours = {
  height: "height", flat: "one colour", recording: "recording", time: "time", error: "error",
  uncertainty: "uncertainty", thickness: "surface thickness",
};
const kRamp = ["#30123b", "#4675ed", "#1bcfd4", "#61fc6c", "#d1e834", "#fe9b2d", "#d93806", "#7a0403"];
const kSessionColours = ["#3a9bdc", "#f2a23c", "#45c98a", "#d46ac0", "#c9a23a", "#35c2cc", "#e0645c", "#9a8cf0"];
const kMoving = 400000;  // points drawn while the view moves

class View {
  constructor(report, scans, links) {
    Object.assign(this, { report, scans, links, frame: 0, before: false, colour: "height", measuring: false, picks: [], chunks: [] });
    this.node = section("In three dimensions", "Drag to turn, with the right button (or two fingers) to move, wheel with Ctrl or after a click to come closer. Click a point for its place and scan.");
    this.stage = element("div", { class: "stage view" });
    this.controls = element("div", { class: "controls" });
    this.read = element("output", { class: "readout", "aria-live": "polite" }, "\u00a0");
    this.node.append(this.controls, this.stage, this.read);
  }

  // True where there is WebGL; else the picture from above stands in.
  async start() {
    if (!this.report.frames.some((f) => f.cloud)) {
      this.instead("This report was made without points (report.points is 0).");
      return false;
    }
    const canvas = element("canvas", { tabindex: 0, role: "img", "aria-label": "The map in three dimensions; keys are listed below it" });
    const settings = { antialias: true, preserveDrawingBuffer: true };
    const context = canvas.getContext("webgl", settings);
    if (!context) {
      this.instead("This browser shows no WebGL: here is the map from above instead.");
      return false;
    }
    await loadLibrary("three");
    this.renderer = new THREE.WebGLRenderer({ canvas, context, ...settings });
    this.stage.append(canvas);
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(50, 1, 0.5, 20000);
    this.camera.up.set(0, 0, 1);
    keepScrolling(canvas);
    this.orbit = new THREE.OrbitControls(this.camera, canvas);
    this.orbit.enableKeys = false;
    this.orbit.addEventListener("change", () => this.draw());
    this.orbit.addEventListener("start", () => { this.moving = true; });
    this.orbit.addEventListener("end", () => { this.moving = false; this.draw(); });
    this.clip = [new THREE.Plane(new THREE.Vector3(0, 0, -1), 1e6), new THREE.Plane(new THREE.Vector3(0, 0, 1), 1e6)];
    this.renderer.clippingPlanes = this.clip;
    this.buildControls();
    this.listen(canvas);
    new ResizeObserver(() => this.resize()).observe(this.stage);
    await this.show(0);
    return true;
  }

  instead(text) {
    this.controls.replaceChildren();
    this.stage.replaceChildren(element("p", { class: "note" }, text), element("img", { src: document.getElementById("picture-0").src, alt: "The map from above" }));
    this.stage.dataset.instead = "picture";
  }

  buildControls() {
    const modes = Object.entries(kColours).filter(([key]) =>
      (key !== "error" || this.scans.hasTruth()) && (key !== "uncertainty" || this.scans.sigma) && (key !== "recording" || this.report.strands.length > 1));
    const colour = choice("colour by", modes, (mode) => this.colourBy(mode));
    this.colourSelect = colour.querySelector("select");
    const frames = this.report.frames;
    const when = element("button", { type: "button", "aria-pressed": "false", onclick: () => this.setBefore(!this.before) }, "before closing (b)");
    this.whenButton = when;
    const measure = element("button", { type: "button", "aria-pressed": "false", onclick: () => this.setMeasuring(!this.measuring) }, "measure (m)");
    this.measureButton = measure;
    const slider = (label, value) => {
      const input = element("input", { type: "range", min: 0, max: 1000, value });
      input.addEventListener("input", () => this.setClip());
      return [element("label", {}, label + " ", input), input];
    };
    const [lowLabel, low] = slider("from height", 0), [highLabel, high] = slider("to", 1000);
    Object.assign(this, { low, high });
    const size = element("input", { type: "range", min: 1, max: 6, step: 0.5, value: 1.5 });
    this.size = size;
    size.addEventListener("input", () => { for (const c of this.chunks) c.material.size = Number(size.value); this.draw(); });
    this.legend = element("div", { class: "legend" });
    this.controls.append(
      this.frameChoice(frames),
      colour, when, lowLabel, highLabel, element("label", {}, "point size ", size), measure,
      element("button", { type: "button", onclick: () => this.overview() }, "see all (0)"));
    this.node.append(this.legend, element("p", { class: "note keys" },
      "Keys, once the view has the focus: b before and after closing, c next colour, m measure, 0 see all, t from above, arrows move, + and - come closer and go back."));
  }

  frameChoice(frames) {
    if (frames.length < 2) return "";
    const label = choice("frame of", frames.map((f, k) => [k, f.name]), (k) => this.show(Number(k)));
    this.frameSelect = label.querySelector("select");
    return label;
  }

  listen(canvas) {
    let down = null;
    canvas.addEventListener("pointerdown", (e) => { canvas.focus({ preventScroll: true }); down = [e.clientX, e.clientY]; });
    canvas.addEventListener("pointerup", (e) => {
      if (down && Math.hypot(e.clientX - down[0], e.clientY - down[1]) < 4) this.click(e);
      down = null;
    });
    canvas.addEventListener("keydown", (e) => {
      if (e.ctrlKey || e.altKey || e.metaKey) return;
      const far = this.camera.position.distanceTo(this.orbit.target);
      const keys = {
        b: () => this.setBefore(!this.before), m: () => this.setMeasuring(!this.measuring), 0: () => this.overview(), t: () => this.overview(true),
        c: () => { const s = this.colourSelect; s.selectedIndex = (s.selectedIndex + 1) % s.options.length; this.colourBy(s.value); },
        ArrowLeft: () => this.move(-0.1 * far, 0), ArrowRight: () => this.move(0.1 * far, 0), ArrowUp: () => this.move(0, 0.1 * far), ArrowDown: () => this.move(0, -0.1 * far),
        "+": () => this.closer(0.8), "-": () => this.closer(1.25), Escape: () => canvas.blur(),
      };
      if (keys[e.key]) { keys[e.key](); e.preventDefault(); }
    });
  }

  // Everything of one frame: lines at once, then its chunks, coarse ones first.
  async show(frame) {
    this.frame = frame;
    if (this.frameSelect) this.frameSelect.value = frame;
    const mine = (this.showing = (this.showing || 0) + 1);
    for (const c of this.chunks) { c.points.geometry.dispose(); c.material.dispose(); }
    this.chunks = [];
    this.scene.remove(...this.scene.children);
    this.addLines();
    this.range = null;
    const cloud = this.report.frames[frame].cloud;
    if (!cloud) return this.draw();
    const nodes = await arrayOf(cloud.nodes);
    let next = 0;
    for (const chunk of cloud.chunks) {
      const [place, row, thickness] = await Promise.all([arrayOf(chunk.place), arrayOf(chunk.row), arrayOf(chunk.thickness)]);
      if (mine !== this.showing) return;
      this.addChunk(nodes.subarray(7 * next, 7 * (next + chunk.nodes)), place, row, thickness);
      next += chunk.nodes;
      this.draw();
      this.stage.dataset.points = this.chunks.reduce((n, c) => n + c.rows.length, 0);
      await new Promise((done) => setTimeout(done));
    }
    this.stage.dataset.complete = "yes";
  }

  addChunk(nodes, place, row, thickness) {
    const n = row.length, after = new Float32Array(3 * n);
    const unzigzag = (v) => ((v >>> 1) ^ -(v & 1)) & 0xffff;
    for (let axis = 0; axis < 3; ++axis) {
      let i = 0;
      for (let k = 0; k < nodes.length; k += 7) {
        const corner = nodes[k + 2 + axis], unit = nodes[k + 5], end = i + nodes[k + 6];
        for (let at = 0; i < end; ++i) {
          at = (at + unzigzag(place[axis * n + i])) & 0xffff;
          after[3 * i + axis] = corner + at * unit;
        }
      }
    }
    for (let i = 0, at = 0; i < n; ++i) { at = (at + row[i]) >>> 0; row[i] = at; }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(after, 3));
    geometry.setAttribute("color", new THREE.BufferAttribute(new Uint8Array(3 * n), 3, true));
    const material = new THREE.PointsMaterial({ size: Number(this.size.value), sizeAttenuation: false, vertexColors: THREE.VertexColors });
    const points = new THREE.Points(geometry, material);
    const chunk = { points, material, after, before: null, rows: row, thickness };
    this.chunks.push(chunk);
    if (this.before) this.place(chunk);
    if (this.chunks.length === 1) this.firstChunk(chunk);
    this.paint(chunk);
    geometry.computeBoundingSphere();
    this.scene.add(points);
  }

  // The coarsest level says how far the map reaches.
  firstChunk(chunk) {
    const z = Array.from({ length: chunk.rows.length }, (_, i) => chunk.after[3 * i + 2]).sort(d3.ascending);
    this.heights = [z[0], z[z.length - 1]];
    this.range = { height: [d3.quantile(z, 0.02), d3.quantile(z, 0.98)] };
    this.box = new THREE.Box3().setFromBufferAttribute(chunk.points.geometry.getAttribute("position"));
    this.overview();
    this.setClip();
    this.colourBy(this.colour);
  }

  // Where odometry had the points: each by the scan that stood nearest.
  place(chunk) {
    if (this.before && !chunk.before) {
      const { optimised, odometry } = this.scans;
      chunk.before = new Float32Array(chunk.after.length);
      for (let i = 0; i < chunk.rows.length; ++i) {
        const k = 7 * chunk.rows[i], a = chunk.after;
        const local = rotate(-optimised[k + 3], -optimised[k + 4], -optimised[k + 5], optimised[k + 6],
          [a[3 * i] - optimised[k], a[3 * i + 1] - optimised[k + 1], a[3 * i + 2] - optimised[k + 2]]);
        const p = transform(odometry.subarray(k, k + 7), local);
        chunk.before[3 * i] = p[0]; chunk.before[3 * i + 1] = p[1]; chunk.before[3 * i + 2] = p[2];
      }
    }
    const geometry = chunk.points.geometry;
    geometry.setAttribute("position", new THREE.BufferAttribute(this.before ? chunk.before : chunk.after, 3));
    geometry.computeBoundingSphere();
  }

  setBefore(on) {
    this.before = on;
    this.whenButton.setAttribute("aria-pressed", on);
    for (const chunk of this.chunks) { this.place(chunk); if (this.colour === "error" || this.colour === "height") this.paint(chunk); }
    this.clearPicks();
    this.weighLines();
    this.draw();
    this.say(on ? "The map as odometry alone has it." : "The map after closing loops.");
  }

  // What a point is coloured by: a number, or NaN.
  valueOf(mode) {
    const { scans } = this, which = this.before ? "odometry" : "optimised";
    const by = {
      height: (c, i) => (this.before ? c.before : c.after)[3 * i + 2],
      time: (c, i) => scans.stamp[c.rows[i]],
      error: (c, i) => scans.error(which, c.rows[i]),
      uncertainty: (c, i) => scans.sigma[2 * c.rows[i]],
      thickness: (c, i) => (c.thickness[i] === 0 ? NaN : 0.5 * ((c.thickness[i] - 1) / 254) ** 2),
    };
    return by[mode];
  }

  colourBy(mode) {
    this.colour = mode;
    if (this.chunks.length === 0) return;
    const value = this.valueOf(mode);
    if (value && mode !== "height") {
      const chunk = this.chunks[0];
      const values = Array.from({ length: chunk.rows.length }, (_, i) => value(chunk, i)).filter(isFinite).sort(d3.ascending);
      this.range[mode] = values.length > 0 ? [mode === "thickness" || mode === "error" ? 0 : values[0], d3.quantile(values, mode === "time" ? 1 : 0.98)] : [0, 1];
    }
    for (const c of this.chunks) this.paint(c);
    this.drawLegend();
    this.draw();
  }

  paint(chunk) {
    const colour = chunk.points.geometry.getAttribute("color"), rgb = colour.array, value = this.valueOf(this.colour);
    const range = (this.range && this.range[this.colour]) || [0, 1], ramp = rampTable();
    const hex = (text) => [1, 3, 5].map((k) => parseInt(text.slice(k, k + 2), 16));
    const sessions = kSessionColours.map(hex), grey = [140, 146, 154];
    for (let i = 0; i < chunk.rows.length; ++i) {
      let c = grey;
      if (this.colour === "recording") c = sessions[this.scans.strandOfRow[chunk.rows[i]] % sessions.length];
      else if (value) {
        const v = (value(chunk, i) - range[0]) / (range[1] - range[0] || 1);
        if (isFinite(v)) c = ramp[Math.round(255 * Math.min(1, Math.max(0, v)))];
      }
      rgb[3 * i] = c[0]; rgb[3 * i + 1] = c[1]; rgb[3 * i + 2] = c[2];
    }
    colour.needsUpdate = true;
  }

  drawLegend() {
    const unit = { time: "s", thickness: "m", height: "m", error: "m", uncertainty: "m" }[this.colour];
    if (this.colour === "recording") {
      this.legend.replaceChildren(...this.report.strands.map((s, k) => {
        const swatch = element("span", { class: "swatch" });
        swatch.style.background = kSessionColours[k % kSessionColours.length];
        return element("span", { class: "key" }, swatch, s.name);
      }));
    } else if (unit) {
      const r = this.range[this.colour];
      const bar = element("span", { class: "ramp" });
      bar.style.background = `linear-gradient(to right, ${kRamp.join(",")})`;
      const grey = { thickness: "; grey: no surface", error: "; grey: no ground truth there" }[this.colour] || "";
      this.legend.replaceChildren(`${kColours[this.colour]}: ${number(r[0], 2)} `, bar, ` ${number(r[1], 2)} ${unit}${grey}`);
    } else this.legend.replaceChildren();
  }

  addLines() {
    this.lines = [];
    const line = (which, strand, colour) => {
      const values = [];
      for (let row = strand.first_row; row < strand.first_row + strand.rows; ++row) {
        const p = this.scans.position(which, row);
        if (isFinite(p[0])) values.push(...p);
      }
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(values), 3));
      const object = new THREE.Line(geometry, new THREE.LineBasicMaterial({ color: colour, transparent: true }));
      this.scene.add(object);
      this.lines.push({ which, object });
    };
    this.report.strands.forEach((strand, k) => {
      if (strand.frame !== this.frame) return;
      const own = this.report.strands.length > 1 ? kSessionColours[k % kSessionColours.length] : null;
      if (this.scans.hasTruth()) line("truth", strand, "#a0a6ae");
      line("odometry", strand, own || "#f2a23c");
      line("optimised", strand, own || "#4aa8f0");
    });
    const closures = [];
    for (const c of this.report.closures) {
      if (c.status === "accepted" && c.one_frame && this.scans.strand(c.query_row).frame === this.frame)
        closures.push(...this.scans.position("optimised", c.reference_row), ...this.scans.position("optimised", c.query_row));
    }
    if (closures.length > 0) {
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(closures), 3));
      const object = new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({ color: "#45c98a" }));
      this.scene.add(object);
      this.lines.push({ which: "optimised", object });
    }
    this.marker = new THREE.Mesh(new THREE.SphereGeometry(1, 16, 12), new THREE.MeshBasicMaterial({ color: "#ff3d7f" }));
    this.marker.visible = false;
    this.ruler = new THREE.Line(new THREE.BufferGeometry(), new THREE.LineBasicMaterial({ color: "#ff3d7f", depthTest: false }));
    this.ruler.visible = false;
    this.ruler.frustumCulled = false;
    this.scene.add(this.marker, this.ruler);
    this.weighLines();
  }
  weighLines() {
    const other = this.before ? "optimised" : "odometry";
    for (const { which, object } of this.lines) object.visible = which !== other;
  }

  setClip() {
    const [a, b] = this.heights, at = (input) => a + ((b - a) * Number(input.value)) / 1000;
    this.clip[0].constant = at(this.high) + 0.01;
    this.clip[1].constant = -at(this.low) + 0.01;
    this.draw();
  }

  overview(above) {
    if (!this.box) return;
    const centre = this.box.getCenter(new THREE.Vector3()), size = this.box.getSize(new THREE.Vector3());
    const reach = Math.max(size.x, size.y, 10);
    this.orbit.target.copy(centre);
    this.camera.position.copy(centre).add(above ? new THREE.Vector3(0, -0.001 * reach, 1.15 * reach) : new THREE.Vector3(0, -0.6 * reach, 0.62 * reach));
    this.camera.far = 20 * reach;
    this.camera.near = reach / 5000;
    this.camera.updateProjectionMatrix();
    this.orbit.update();
    this.draw();
  }
  // Along the ground, to the right and forward as the view looks.
  move(right, forward) {
    const look = this.orbit.target.clone().sub(this.camera.position).setZ(0);
    if (look.length() < 1e-6) look.set(0, 1, 0);
    look.normalize();
    const step = new THREE.Vector3(look.y * right + look.x * forward, -look.x * right + look.y * forward, 0);
    this.camera.position.add(step);
    this.orbit.target.add(step);
    this.orbit.update();
    this.draw();
  }
  closer(factor) {
    this.camera.position.sub(this.orbit.target).multiplyScalar(factor).add(this.orbit.target);
    this.orbit.update();
    this.draw();
  }

  // The view goes to a scan.
  async goTo(row) {
    if (!this.renderer) return;
    const frame = this.scans.strand(row).frame;
    if (frame !== this.frame) await this.show(frame);
    const p = new THREE.Vector3(...this.scans.position(this.before ? "odometry" : "optimised", row));
    this.orbit.target.copy(p);
    this.camera.position.copy(p).add(new THREE.Vector3(0, -45, 40));
    this.orbit.update();
    this.mark(p);
    this.say(this.scans.describe(row));
  }

  mark(p) {
    this.marker.position.copy(p);
    this.marker.visible = true;
    this.draw();
  }
  say(text) { this.read.textContent = text; }

  setMeasuring(on) {
    this.measuring = on;
    this.measureButton.setAttribute("aria-pressed", on);
    this.clearPicks();
    if (on) this.say("Click two points to measure between them.");
  }
  clearPicks() {
    this.picks = [];
    this.ruler.visible = this.marker.visible = false;
    this.draw();
  }

  // The point under the pointer that is nearest to the eye, of those not cut away.
  pick(event) {
    const box = this.renderer.domElement.getBoundingClientRect();
    const at = new THREE.Vector2(((event.clientX - box.left) / box.width) * 2 - 1, 1 - ((event.clientY - box.top) / box.height) * 2);
    const caster = new THREE.Raycaster();
    caster.setFromCamera(at, this.camera);
    const pixel = (2 * Math.tan((this.camera.fov * Math.PI) / 360)) / box.height;
    caster.params.Points.threshold = 6 * pixel * this.camera.position.distanceTo(this.orbit.target);
    const hits = caster.intersectObjects(this.chunks.map((c) => c.points))
      .filter((h) => this.clip.every((plane) => plane.distanceToPoint(h.point) >= 0) && h.distanceToRay < 6 * pixel * h.distance);
    if (hits.length === 0) return null;
    const chunk = this.chunks.find((c) => c.points === hits[0].object), i = hits[0].index;
    const p = (this.before ? chunk.before : chunk.after).subarray(3 * i, 3 * i + 3);
    return { p: new THREE.Vector3(p[0], p[1], p[2]), row: chunk.rows[i], thickness: this.valueOf("thickness")(chunk, i) };
  }

  click(event) {
    const hit = this.pick(event);
    if (!hit) return this.say("No point there.");
    this.mark(hit.p);
    const place = `x ${number(hit.p.x, 2)}, y ${number(hit.p.y, 2)}, z ${number(hit.p.z, 2)} m`;
    if (!this.measuring) {
      this.links.point(hit.row);
      return this.say(`${place}; nearest ${this.scans.describe(hit.row)}${isFinite(hit.thickness) ? `; surface ${number(hit.thickness, 3)} m thick` : ""}`);
    }
    this.picks = this.picks.length === 1 ? [this.picks[0], hit.p] : [hit.p];
    if (this.picks.length === 1) return this.say(`${place}; and the second point?`);
    const [a, b] = this.picks;
    this.ruler.geometry.setFromPoints([a, b]);
    this.ruler.visible = true;
    this.draw();
    this.say(`${number(a.distanceTo(b), 3)} m; level ${number(Math.hypot(b.x - a.x, b.y - a.y), 3)} m, upright ${number(b.z - a.z, 3)} m`);
  }

  resize() {
    const box = this.stage.getBoundingClientRect();
    if (box.width < 1) return;
    this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio));
    this.renderer.setSize(box.width, box.height);
    this.camera.aspect = box.width / box.height;
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  // Once a frame of the screen, however often it is asked for.
  draw() {
    if (this.waiting || !this.renderer) return;
    this.waiting = true;
    requestAnimationFrame(() => { this.waiting = false; this.render(); });
  }
  render() {
    let shown = 0;
    for (const c of this.chunks) {
      c.points.visible = !this.moving || shown < kMoving;
      shown += c.rows.length;
    }
    if (this.marker) this.marker.scale.setScalar(this.camera.position.distanceTo(this.marker.position) / 120);
    this.renderer.setClearColor(matchMedia("(prefers-color-scheme: dark)").matches ? "#101214" : "#f4f5f7");
    this.renderer.render(this.scene, this.camera);
  }
}

// 256 colours along the ramp.
function rampTable() {
  if (!rampTable.table) {
    const scale = d3.scale.linear().domain(kRamp.map((_, k) => (255 * k) / (kRamp.length - 1))).range(kRamp);
    rampTable.table = d3.range(256).map((v) => { const c = d3.rgb(scale(v)); return [c.r, c.g, c.b]; });
  }
  return rampTable.table;
}
