// The map from above: a picture with trajectories and closures over it. Wheel with Ctrl, or wheel
// after a click into it, zooms; dragging moves.

class TopMap {
  constructor(report, scans, links) {
    this.report = report;
    this.scans = scans;
    this.links = links;
    this.frame = 0;
    this.shown = { after: true, odometry: !this.several(), optimised: true, truth: scans.hasTruth(), accepted: true, rejected: false };
    this.node = section("Map from above", "x to the right, y up, in the world of the first scan; metres. What stands upright is dark.");
    this.controls = element("div", { class: "controls" });
    this.stage = element("div", { class: "stage" });
    this.read = element("output", { class: "readout" }, "\u00a0");
    this.node.append(this.controls, this.stage, this.read);
    if (this.several())
      this.node.append(element("p", {}, ...report.strands.map((s, k) => element("span", { class: "key" }, element("span", { class: "swatch session" + (k % 8) }), s.name))));
    this.build();
  }
  several() { return this.report.strands.length > 1; }
  strands() { return this.report.strands.map((s, k) => [s, k]).filter(([s]) => s.frame === this.frame); }

  build() {
    const frames = this.report.frames;
    this.controls.replaceChildren();
    if (frames.length > 1) {
      const select = choice("frame of", frames.map((f, k) => [k, f.name]), (k) => { this.frame = Number(k); this.draw(); });
      this.frameSelect = select.querySelector("select");
      this.controls.append(select);
    }
    const has = (status) => this.report.closures.some((c) => (c.status === "accepted") === status);
    const switches = [["after", "map after closing (off: before)", null], ["optimised", "optimised", "after"], ["odometry", "odometry", "before"]];
    if (this.scans.hasTruth()) switches.push(["truth", "ground truth", "truth"]);
    if (has(true)) switches.push(["accepted", "closures accepted", "good"]);
    if (has(false)) switches.push(["rejected", "rejected", "bad"]);
    for (const [key, label, swatch] of switches)
      this.controls.append(toggle(label, this.shown[key], (on) => { this.shown[key] = on; this.update(); }, swatch));
    this.draw();
  }

  draw() {
    const frame = this.report.frames[this.frame];
    const w = frame.width * frame.pixel, h = frame.height * frame.pixel;
    this.stage.replaceChildren();
    const svg = d3.select(this.stage).append("svg").attr("class", "top").attr("viewBox", `${frame.low[0]} ${-(frame.low[1] + h)} ${w} ${h}`)
      .attr("role", "img").attr("tabindex", 0).attr("aria-label", "The map from above with the trajectories");
    this.svg = svg;
    this.layer = svg.append("g");
    const picture = (name, href) => this.layer.append("image").attr("class", "ground " + name).attr("href", href)
      .attr("x", frame.low[0]).attr("y", -(frame.low[1] + h)).attr("width", w).attr("height", h);
    picture("map-before", frame.odometry_picture);
    picture("map-after", document.getElementById("picture-" + this.frame).src);
    this.drawLines();
    this.drawClosures();
    this.zoom = d3.behavior.zoom().scaleExtent([0.8, 200]).on("zoom", () => {
      this.layer.attr("transform", `translate(${d3.event.translate})scale(${d3.event.scale})`);
    });
    keepScrolling(svg.node());
    svg.call(this.zoom);
    svg.on("mousemove.read", () => this.hover());
    svg.on("click.read", () => { if (!d3.event.defaultPrevented && this.row !== undefined) this.links.show(this.row); });
    this.update();
  }

  drawLines() {
    const scans = this.scans;
    const path = (which, strand) => {
      const points = [];
      for (let row = strand.first_row; row < strand.first_row + strand.rows; ++row) points.push(row);
      return d3.svg.line().defined((row) => isFinite(scans.position(which, row)[0]))
        .x((row) => scans.position(which, row)[0]).y((row) => -scans.position(which, row)[1])(points);
    };
    for (const [strand, k] of this.strands()) {
      const style = this.several() ? "session" + (k % 8) : "";
      if (scans.hasTruth()) this.layer.append("path").attr("class", "line truth").attr("d", path("truth", strand));
      this.layer.append("path").attr("class", "line before odometry " + style).attr("d", path("odometry", strand));
      this.layer.append("path").attr("class", "line after optimised " + style).attr("d", path("optimised", strand)).append("title").text(strand.name);
    }
    this.mark = this.layer.append("circle").attr("class", "mark").attr("r", 0);
  }

  drawClosures() {
    const here = (c) => c.one_frame && this.scans.strand(c.query_row).frame === this.frame;
    const at = (row) => this.scans.position("optimised", row);
    const closures = this.report.closures.filter(here).sort((a, b) => (a.status === "accepted") - (b.status === "accepted"));
    this.layer.selectAll("line.closure").data(closures).enter().append("line")
      .attr("class", (c) => "closure " + (c.status === "accepted" ? "good" : "bad"))
      .attr("x1", (c) => at(c.reference_row)[0]).attr("y1", (c) => -at(c.reference_row)[1])
      .attr("x2", (c) => at(c.query_row)[0]).attr("y2", (c) => -at(c.query_row)[1])
      .on("click", (c) => { d3.event.stopPropagation(); this.links.closure(c.id); })
      .append("title").text((c) => `closure ${closureName(this.report, c)}: ${c.status}, ${c.inliers} inliers`);
  }

  update() {
    const show = (selector, on) => this.layer.selectAll(selector).style("display", on ? null : "none");
    const s = this.shown;
    show(".map-after", s.after);
    show(".map-before", !s.after);
    show("path.optimised", s.optimised);
    show("path.odometry", s.odometry);
    show("path.truth", s.truth);
    show("line.good", s.accepted);
    show("line.bad", s.rejected);
  }

  hover() {
    const [x, y] = d3.mouse(this.layer.node());
    let best = Infinity;
    for (const [strand] of this.strands()) {
      for (let row = strand.first_row; row < strand.first_row + strand.rows; ++row) {
        const p = this.scans.position("optimised", row);
        const d = (p[0] - x) ** 2 + (p[1] + y) ** 2;
        if (d < best) { best = d; this.row = row; }
      }
    }
    if (this.row !== undefined) this.point(this.row);
  }

  // Marks a scan and tells of it.
  point(row) {
    const frame = this.scans.strand(row).frame;
    if (frame !== this.frame) {
      this.frame = frame;
      this.frameSelect.value = frame;
      this.draw();
    }
    const p = this.scans.position("optimised", row), f = this.report.frames[this.frame];
    this.mark.attr("cx", p[0]).attr("cy", -p[1]).attr("r", (f.width * f.pixel) / 150);
    this.read.textContent = this.scans.describe(row) + ` at ${p.map((v) => number(v, 2)).join(", ")}`;
  }
}

// The wheel scrolls the page over a picture that does not have the focus.
function keepScrolling(node) {
  node.addEventListener("wheel", (event) => {
    if (!event.ctrlKey && document.activeElement !== node) event.stopImmediatePropagation();
  }, { capture: true });
}

function closureName(report, closure) {
  const name = (side) => (report.kind === "merge" ? report.parts[side.part] + "/" : "") + side.map;
  return `${name(closure.query)} to ${name(closure.reference)}`;
}
