// The parts of the page below the map: odometry along the way, errors, map quality, time, input and
// configuration.

const kStates = ["good", "weak", "lost", "predicted", "unknown"];

function odometrySection(report, scans, links) {
  const node = section("Odometry along the way");
  if (scans.state) node.append(stateBand(report, scans, links));
  else node.append(element("p", { class: "note" }, "This session has no record of how well each registration went."));
  const rows = d3.range(scans.rows);
  const along = accumulated(report, scans);
  const describe = (i) => scans.describe(i);
  const add = (title, unit, style, values, note) => {
    const plot = linePlot({ title, note, x: "way [m]", y: unit, zero: true, describe, onRow: links.show }, [{ name: "", style, x: along, y: values }]);
    if (plot) node.append(plot);
  };
  if (scans.quality) {
    add("Residual of registration", "[m]", "after", rows.map((r) => scans.quality[5 * r + 2]));
    add("Share of points that fit", "[share]", "after", rows.map((r) => scans.quality[5 * r + 1]));
    add("Standard deviation of the registration's position", "[m]", "after", rows.map((r) => scans.quality[5 * r + 3]));
  }
  if (scans.sigma) add("Uncertainty of the solution's position", "[m]", "after", rows.map((r) => scans.sigma[2 * r]), "Standard deviation against the first local map, by local map.");
  const gaps = rows.map((r) => (r > 0 && scans.strandOfRow[r] === scans.strandOfRow[r - 1] ? scans.stamp[r] - scans.stamp[r - 1] : NaN));
  add("Time between scans", "[s]", "after", gaps, "A peak is a gap in the recording.");
  add("Speed", "[m/s]", "after", rows.map((r) => (gaps[r] > 0 ? (scans.way[r] - scans.way[r - 1]) / gaps[r] : NaN)));
  if (report.pieces.length > 1)
    node.append(element("h3", {}, "Pieces"), plainTable(["piece", "scans", "frame of piece", "joined by", "why it ended"], report.pieces.map((p) => [p.piece, `${p.first_scan} to ${p.last_scan}`, p.frame, p.joined_by || "–", p.reason])));
  return node;
}

// Metres over all recordings, one after another.
function accumulated(report, scans) {
  const along = new Float64Array(scans.rows);
  let before = 0;
  for (const strand of report.strands) {
    for (let row = strand.first_row; row < strand.first_row + strand.rows; ++row) along[row] = before + scans.way[row];
    if (strand.rows > 0) before = along[strand.first_row + strand.rows - 1];
  }
  return along;
}

function stateBand(report, scans, links) {
  const counts = d3.nest().key((s) => s).rollup((v) => v.length).map(Array.from(scans.state));
  const frame = plotFrame("How registration went, scan by scan");
  legend(frame.figure, kStates.map((name, k) => ({ name: counts[k] ? `${name} (${counts[k]})` : "", style: "state-" + name })));
  frame.svg.attr("viewBox", `0 0 ${kPlotWidth} 90`);
  const x = d3.scale.linear().domain([0, scans.rows]).range([0, frame.width]);
  frame.axes.x.attr("transform", "translate(0,40)").call(d3.svg.axis().scale(x).orient("bottom").ticks(Math.min(10, frame.width / 70)));
  let from = 0;
  for (let row = 1; row <= scans.rows; ++row) {
    if (row < scans.rows && scans.state[row] === scans.state[from]) continue;
    const start = from;
    frame.marks.append("rect").attr("class", "state-" + kStates[scans.state[from]]).attr("x", x(from)).attr("width", Math.max(1, x(row) - x(from))).attr("height", 36)
      .on("click", () => links.show(start)).append("title").text(`${kStates[scans.state[from]]}: ${scans.describe(from)}`);
    from = row;
  }
  return frame.figure;
}

function statisticsRows(name, errors) {
  const row = (what, s) => [`${name}: ${what}`, ...["rmse", "mean", "median", "std", "min", "max"].map((k) => number(s[k], 3))];
  return [row("position [m]", errors.ape.translation_m), row("along x [m]", errors.ape.x_m), row("along y [m]", errors.ape.y_m), row("along z [m]", errors.ape.z_m),
    row("rotation [°]", errors.ape.rotation_deg), row("relative, 1 scan [m]", errors.rpe.translation_m), row("relative, 1 scan [°]", errors.rpe.rotation_deg),
    row(`relative, ${number(errors.rpe.by_distance.delta_m, 0)} m [m]`, errors.rpe.by_distance.translation_m)];
}

function errorSection(report, scans, links) {
  if (!scans.hasTruth()) return null;
  const node = section("Errors against ground truth", "Position: distance of paired positions after an SE(3) alignment without scale (Umeyama 1991), one for odometry and one for the solution; poses are paired by the nearest stamp within 0.01 s. " +
    "Relative: of the motion to the next pair, or over a distance; no alignment enters. In the plots, errors of the solution are by the alignment of everything in its frame.");
  for (const strand of report.strands) {
    const { odometry, optimised, joint } = strand.errors;
    if (!optimised) continue;
    const rows = [...(odometry ? statisticsRows("odometry", odometry) : []), ...statisticsRows("optimised", optimised), ...(report.strands.length > 1 && joint ? statisticsRows("one alignment for all", joint).slice(0, 5) : [])];
    if (report.strands.length > 1) node.append(element("h3", {}, strand.name));
    node.append(plainTable(["", "rmse", "mean", "median", "std", "min", "max"], rows));
    const kitti = (e) => (e.kitti.segments > 0 ? `${number(e.kitti.translation_percent, 3)} % and ${number(e.kitti.rotation_deg_per_m, 5)} °/m` : "the way is too short");
    node.append(element("p", { class: "note" }, `${optimised.pairs} pairs over ${number(optimised.path_length_m, 0)} m. KITTI's segments of 100 to 800 m: ` + (odometry ? `odometry ${kitti(odometry)}, ` : "") + `optimised ${kitti(optimised)}.`));
  }
  const rows = d3.range(scans.rows), along = accumulated(report, scans), describe = (i) => scans.describe(i);
  const level = (which) => rows.map((r) => Math.hypot(scans[which + "_error"][4 * r], scans[which + "_error"][4 * r + 1]));
  const upright = (which) => rows.map((r) => scans[which + "_error"][4 * r + 2]);
  const angle = (which) => rows.map((r) => scans[which + "_error"][4 * r + 3]);
  const both = (title, unit, f, zero, xs, xName) => {
    const plot = linePlot({ title, x: xName || "way [m]", y: unit, zero, describe, onRow: links.show }, [{ name: "optimised", style: "after", x: xs || along, y: f("optimised") }, { name: "odometry", style: "before", x: xs || along, y: f("odometry") }]);
    if (plot) node.append(plot);
  };
  both("Horizontal error over the way", "[m]", level, true);
  both("Vertical error over the way (up is positive)", "[m]", upright, false);
  both("Rotation error over the way", "[°]", angle, true);
  if (report.strands.length === 1) both("Position error over time", "[m]", (w) => rows.map((r) => scans.error(w, r)), true, scans.stamp, "time [s]");
  const histograms = histogram({ title: "Position errors", x: "error [m]" }, [{ name: "odometry", style: "before", values: rows.map((r) => scans.error("odometry", r)) }, { name: "optimised", style: "after", values: rows.map((r) => scans.error("optimised", r)) }]);
  if (histograms) node.append(histograms);
  return node;
}

function mapSection(report) {
  const q = report.metrics && report.metrics.map_quality;
  if (!q || !q.pairs) return null;
  const node = section("Map at revisits", `Mean over ${q.pairs} pairs of local maps of the same places: distance of one map's points to the other's surfaces (lower is sharper), and map entropy.`);
  const row = (name, f) => [name, number(f.plane_thickness_m, 3), number(f.entropy, 3)];
  node.append(plainTable(["poses", "surfaces apart [m]", "entropy"], [row("before closing", q.before), row("after closing", q.after)]));
  return node;
}

function solutionSection(report) {
  const graph = report.metrics && report.metrics.pose_graph;
  if (!graph) return null;
  const node = section("Pose graph", "cost = 1/2 sum of r' information r, r the SE(3) logarithm of the residual pose.");
  const row = (name, s) => [name, number(s.cost_before, 3), number(s.cost_after, 3), s.iterations, s.termination];
  node.append(plainTable(["graph", "cost before", "cost after", "iterations", "termination"], [row("key poses", graph.key_poses), row("all scans", graph.all_scans)]));
  node.append(element("p", { class: "note" }, `As far as the closures tell, odometry errs ${number(graph.odometry_scale, 2)} times as much as it states.`));
  const levelling = report.metrics.levelling;
  if (levelling && levelling.applied) {
    const sagitta = (bend) => (bend * 500 * 500) / 2;
    node.append(element("p", { class: "note" }, `Odometry was levelled by the walls in ${levelling.maps} local maps: bent by ${number(sagitta(levelling.bend_rad_per_m), 2)} ± ${number(sagitta(levelling.bend_deviation_rad_per_m), 2)} m at 500 m from the middle.`));
  }
  return node;
}

function mergeSection(report) {
  if (!report.metrics || !report.metrics.pairs || report.kind !== "merge") return null;
  const node = section("Between recordings", "Overlap: share of the later recording's local maps that lie on ground of the earlier one.");
  node.append(plainTable(["reference", "query", "candidates", "verified", "accepted", "overlap", "one frame"], report.metrics.pairs.map((p) => [p.reference, p.query, p.candidates, p.verified, p.accepted, number(p.overlap, 2), p.merged_before ? "merged before" : p.one_frame ? "yes" : "not connected"])));
  const parts = Object.entries(report.metrics.sessions || {});
  const rmse = (a) => (a ? number(a.translation_m.rmse, 3) : "–");
  if (parts.length > 0)
    node.append(plainTable(["recording", "scans", "frame of", "odometry's errors over the stated", "APE odometry [m]", "optimised", "by the reference's alignment"], parts.map(([name, p]) => [name, p.scans, p.frame, number(p.odometry_scale, 2), rmse(p.ape.odometry), rmse(p.ape.optimised), rmse(p.ape.by_reference)])));
  return node;
}

function timeSection(report) {
  const times = report.metrics && report.metrics.timing_s;
  if (!times) return null;
  const node = section("Time and memory", "Stages in busy seconds (several may run at once); the total is the clock.");
  const stages = Object.entries(times).filter(([name, v]) => name !== "total" && v > 0);
  if (stages.length > 0) node.append(bars("Seconds by stage", "s", stages.map(([n, v]) => [n.replace(/_/g, " "), v])));
  const m = report.metrics;
  node.append(plainTable([], [["total, without this page", `${number(times.total, 1)} s`], ["scans a second", m.scans_per_second ? number(m.scans_per_second, 1) : null], ["peak memory", m.peak_memory_mb ? `${number(m.peak_memory_mb, 0)} MB` : null]].filter((r) => r[1])));
  return node;
}

function inputSection(report) {
  if (report.facts.length === 0) return null;
  const node = section("Input");
  node.append(plainTable([], report.facts));
  return node;
}

function configurationSection(report) {
  if (report.configuration.length === 0) return null;
  const changed = report.configuration.filter((e) => e.value !== e.default);
  const node = section("Configuration", changed.length > 0 ? "What differs from the defaults comes first." : "Nothing differs from the defaults.");
  const table = (entries) => {
    const t = plainTable(["option", "value", "default", "unit", "what it is"], entries.map((e) => [e.key, e.value, e.default, e.unit, e.reason + (e.allowed ? ` [${e.allowed}]` : "")]));
    t.classList.add("configuration");
    return t;
  };
  if (changed.length > 0) node.append(table(changed));
  node.append(element("details", {}, element("summary", {}, "the whole configuration"), table(report.configuration)));
  return node;
}
