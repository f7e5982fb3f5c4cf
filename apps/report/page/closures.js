// The candidates of closures.csv as a table, and what is to be seen of one: both density images
// with keypoints and matches (as in Fig. 8 of the paper), and both maps one over the other before
// and after registration, from above and in a cut.

class Closures {
  constructor(report, scans, links) {
    Object.assign(this, { report, scans, links });
    const left = report.closures_left_out;
    this.node = section("Closures", "Every candidate, accepted or not; open one to see it." + (left > 0 ? ` ${left} more with few inliers are in closures.csv.` : ""));
    if (report.closures.length === 0) {
      this.node.append(element("p", {}, "There was no candidate."));
      return;
    }
    this.detail = element("div", { class: "detail", tabindex: -1 });
    this.build();
    this.node.append(this.detail);
  }

  build() {
    const r = this.report;
    const metres = (key, name, title) => ({ name: `${name} [m]`, title, value: (c) => (c[key] ? c[key].m : null), text: (c) => (c[key] ? number(c[key].m, 3) : "–") });
    const degrees = (key, name) => ({ name: `${name} [°]`, value: (c) => (c[key] ? c[key].deg : null), text: (c) => (c[key] ? number(c[key].deg, 2) : "–") });
    const any = (key) => r.closures.some((c) => c[key] !== null);
    const columns = [
      { name: "query to reference", value: (c) => c.id, node: (c) => element("button", { type: "button", class: "link", onclick: () => this.open(c.id) }, closureName(r, c)) },
      { name: "source", value: (c) => c.source }, { name: "verdict", value: (c) => c.status, style: "status" },
      { name: "matches", value: (c) => c.matches }, { name: "inliers", value: (c) => c.inliers },
      { name: "overlap", value: (c) => c.overlap, text: (c) => number(c.overlap, 2) },
      { name: "ICP rmse [m]", value: (c) => c.rmse_m, text: (c) => number(c.rmse_m, 3) },
      metres("residual", "off the solution", "between the closure and the final trajectory, at the scans that met"), degrees("residual", "off the solution"),
      metres("correction", "off odometry", "between the closure and odometry: the drift it tells of"),
    ];
    if (any("error")) columns.push(metres("error", "error", "against ground truth, at the scans that met"), degrees("error", "error"));
    const table = sortedTable(columns, r.closures, { label: "closures", rowClass: (c) => (c.status === "accepted" ? "good" : "bad") });
    this.lines = table.lines;
    const counts = d3.nest().key((c) => c.status).rollup((v) => v.length).map(r.closures);
    const filter = choice("show", [["", `all ${r.closures.length}`], ...Object.entries(counts).map(([s, n]) => [s, `${s} (${n})`])], (s) => table.filter((c) => s === "" || c.status === s));
    if (counts.accepted) { filter.querySelector("select").value = "accepted"; table.filter((c) => c.status === "accepted"); }
    this.node.append(element("div", { class: "controls" }, filter), table.node);
  }

  async open(id) {
    const c = this.report.closures.find((k) => k.id === id);
    if (!c) return;
    this.lines.classed("open", (k) => k === c);
    this.detail.replaceChildren(element("h3", {}, "Closure " + closureName(this.report, c)));
    const pair = (d) => (d ? `${number(d.m, 3)} m, ${number(d.deg, 2)}°` : null);
    const d = this.report.details.closures[id];
    this.detail.append(plainTable([], [
      ["verdict", `${c.status}; found by ${c.source}`], ["matches, inliers", `${c.matches}, ${c.inliers}`],
      ["overlap of occupied voxels", number(c.overlap, 3)], ["agreement of tall structure", d && d.agreement !== undefined ? number(d.agreement, 3) : null],
      ["ICP rmse", c.rmse_m === null ? null : `${number(c.rmse_m, 3)} m`], ["standard deviation, by its information", pair(c.deviation)],
      ["registration moved it by", pair(c.moved)], ["off odometry", pair(c.correction)], ["residual in the solution", pair(c.residual)], ["error against ground truth", pair(c.error)],
    ].filter((row) => row[1] !== null)));
    this.detail.append(element("p", {}, element("button", { type: "button", onclick: () => this.links.show(c.query_row) }, "show the place")));
    if (d) {
      await this.pictures(c, d);
      await this.cuts(d);
    } else this.detail.append(element("p", { class: "note" }, "No pictures of this one: the report has room for those accepted and those nearest to it (report.closures)."));
    this.detail.focus({ preventScroll: true });
    this.detail.scrollIntoView({ block: "nearest" });
    this.detail.dataset.open = id;
  }

  // Both images side by side, a line a match.
  async pictures(c, d) {
    const maps = [this.report.details.maps[d.query], this.report.details.maps[d.reference]];
    const keypoints = await Promise.all(maps.map((m) => arrayOf(m.keypoints)));
    const matches = await arrayOf(d.matches);
    const gap = 10, height = Math.max(...maps.map((m) => m.height)), width = maps[0].width + maps[1].width + gap;
    const offset = [0, maps[0].width + gap];
    const figure = element("figure", {}, element("figcaption", {}, `Density images of map ${d.query} (left) and map ${d.reference}`,
      element("span", { class: "key" }, element("span", { class: "swatch good" }), "inliers"), element("span", { class: "key" }, element("span", { class: "swatch bad" }), "outliers")));
    const svg = d3.select(figure).append("svg").attr("class", "images").attr("viewBox", `0 0 ${width} ${height}`).attr("role", "img")
      .attr("aria-label", `Two density images with ${matches.length / 3} matched keypoints, ${c.inliers} of them inliers`);
    const at = (side, k) => [offset[side] + (keypoints[side][2 * k] - maps[side].low[0]) / maps[side].pixel, maps[side].height - (keypoints[side][2 * k + 1] - maps[side].low[1]) / maps[side].pixel];
    maps.forEach((m, side) => {
      svg.append("image").attr("href", m.picture).attr("x", offset[side]).attr("width", m.width).attr("height", m.height);
      for (let k = 0; 2 * k < keypoints[side].length; ++k) { const p = at(side, k); svg.append("circle").attr("class", "keypoint").attr("cx", p[0]).attr("cy", p[1]).attr("r", 2); }
    });
    for (const inlier of [0, 1]) {
      for (let k = 0; k < matches.length; k += 3) {
        if (matches[k + 2] !== inlier) continue;
        const q = at(0, matches[k]), r = at(1, matches[k + 1]);
        svg.append("line").attr("class", inlier ? "match good" : "match bad").attr("x1", q[0]).attr("y1", q[1]).attr("x2", r[0]).attr("y2", r[1]);
      }
    }
    if (matches.length === 0) figure.append(element("p", { class: "note" }, "Found from the solution, by overlap: there are no matches of keypoints."));
    this.detail.append(figure);
  }

  // From above and cut along a line, by the detector's pose and by the registered one.
  async cuts(d) {
    const read = async (reference) => {
      const planes = await arrayOf(reference), n = planes.length / 3;
      return Array.from({ length: n }, (_, i) => [0, 1, 2].map((k) => (planes[k * n + i] - 32768) / 100));
    };
    const [query, reference] = await Promise.all([read(d.query_points), read(d.reference_points)]);
    const by = (pose) => reference.map((p) => {
      const t = transform(pose, p.map((v, k) => v + d.reference_centre[k]));
      return t.map((v, k) => v - d.centre[k]);
    });
    const placed = [["before registration", by(d.initial)], ["after", by(d.refined)]];
    const radius = this.report.details.radius;
    const canvases = placed.flatMap(([name, points]) => ["from above", "cut, 2 m deep"].map((how) => ({ name: `${name}, ${how}`, points, cut: how !== "from above", canvas: element("canvas", { width: 480, height: 480, role: "img", "aria-label": `Both maps ${name}, ${how}` }) })));
    const style = getComputedStyle(document.documentElement);
    const draw = (degrees) => {
      const a = (degrees * Math.PI) / 180, across = [Math.cos(a), Math.sin(a)];
      for (const { canvas, points, cut } of canvases) {
        const ink = canvas.getContext("2d"), scale = canvas.width / (2 * radius);
        ink.clearRect(0, 0, canvas.width, canvas.height);
        for (const [cloud, colour] of [[points, "--before"], [query, "--after"]]) {
          ink.fillStyle = style.getPropertyValue(colour);
          ink.globalAlpha = 0.65;
          for (const [x, y, z] of cloud) {
            const u = x * across[0] + y * across[1], v = -x * across[1] + y * across[0];
            if (cut && Math.abs(v) > 1) continue;
            const right = cut ? u : x, up = cut ? 2 * z : y;
            ink.fillRect((right + radius) * scale - 1, canvas.height / 2 - up * scale - 1, 2, 2);
          }
        }
        if (!cut) {
          ink.strokeStyle = style.getPropertyValue("--soft");
          ink.beginPath();
          ink.moveTo((radius - radius * across[0]) * scale, (radius + radius * across[1]) * scale);
          ink.lineTo((radius + radius * across[0]) * scale, (radius - radius * across[1]) * scale);
          ink.stroke();
        }
      }
    };
    const angle = element("input", { type: "range", min: 0, max: 179, value: 0 });
    angle.addEventListener("input", () => draw(Number(angle.value)));
    const note = `Where the maps meet, ${2 * radius} m across, in the query's ground frame; heights are doubled in the cut, which runs along the line.`;
    this.detail.append(element("figure", {}, element("figcaption", {}, "Both maps in one frame",
      element("span", { class: "key" }, element("span", { class: "swatch after" }), "query"), element("span", { class: "key" }, element("span", { class: "swatch before" }), "reference")),
      element("p", { class: "note" }, note), element("label", {}, "turn the cut ", angle),
      element("div", { class: "cuts" }, ...canvases.map(({ name, canvas }) => element("figure", {}, canvas, element("figcaption", {}, name))))));
    draw(0);
  }
}

// Over the threshold on inliers: how many of the candidates kept are true, and how many of the true
// ones are kept.
function precisionAndRecall(report) {
  const known = report.closures.filter((c) => c.source === "detector" && c.error !== null);
  const good = known.filter((c) => c.error.m <= 3).length;
  if (good === 0) return null;
  const least = d3.range(3, d3.max(known, (c) => c.inliers) + 1);
  const kept = least.map((n) => known.filter((c) => c.inliers >= n));
  const right = kept.map((k) => k.filter((c) => c.error.m <= 3).length);
  return linePlot({ title: "Precision and recall of the candidates", zero: true, x: "least inliers", y: "share",
    note: "A candidate is true within 3 m of the ground truth. Recall is among the candidates that are true; places that were never a candidate are not counted." },
    [{ name: "precision", style: "after", x: least, y: kept.map((k, i) => (k.length > 0 ? right[i] / k.length : NaN)) },
      { name: "recall", style: "before", x: least, y: right.map((n) => n / good) }]);
}
