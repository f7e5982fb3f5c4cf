// Line plots, histograms and bars, by d3: drag to zoom, double click or Escape to see all, hover
// for the scan. A plot over the way links its points to the map.

// As wide as the page, so that letters keep their size on a telephone.
const kPlotWidth = Math.max(340, Math.min(900, window.innerWidth - 24));
const kPlotHeight = 240, kMargin = { left: 58, right: 14, top: 10, bottom: 38 };

function plotFrame(title, note, plotHeight = kPlotHeight) {
  const figure = element("figure", { class: "plot" }, element("figcaption", {}, title));
  if (note) figure.append(element("p", { class: "note" }, note));
  const svg = d3.select(figure).append("svg").attr("viewBox", `0 0 ${kPlotWidth} ${plotHeight}`)
    .attr("role", "img").attr("aria-label", title).attr("tabindex", 0);
  const inner = svg.append("g").attr("transform", `translate(${kMargin.left},${kMargin.top})`);
  const width = kPlotWidth - kMargin.left - kMargin.right, height = plotHeight - kMargin.top - kMargin.bottom;
  const clip = "clip-" + (plotFrame.count = (plotFrame.count || 0) + 1);
  inner.append("clipPath").attr("id", clip).append("rect").attr("width", width).attr("height", height);
  const axes = { x: inner.append("g").attr("class", "axis").attr("transform", `translate(0,${height})`), y: inner.append("g").attr("class", "axis") };
  const marks = inner.append("g").attr("clip-path", `url(#${clip})`);
  return { figure, svg, inner, marks, axes, width, height };
}

function axisLabels(frame, x, y) {
  frame.inner.append("text").attr("class", "label").attr("x", frame.width).attr("y", frame.height + 33).attr("text-anchor", "end").text(x);
  frame.inner.append("text").attr("class", "label").attr("transform", "rotate(-90)").attr("y", -44).attr("x", 0).attr("text-anchor", "end").text(y);
}

function legend(figure, series) {
  const keys = series.filter((s) => s.name).map((s) => element("span", { class: "key" }, element("span", { class: "swatch " + s.style }), s.name));
  if (keys.length > 0) figure.querySelector("figcaption").append(...keys);
}

// Points of a long line that its extremes are kept of, column by column of the picture.
function thinned(x, y, from, to, columns) {
  const points = [];
  const first = d3.bisector((i) => i);
  let a = 0, b = x.length;
  for (; a < b && x[a] < from; ++a);
  for (; b > a && x[b - 1] > to; --b);
  a = Math.max(0, a - 1);
  b = Math.min(x.length, b + 1);
  const step = Math.max(1, Math.floor((b - a) / columns));
  for (let i = a; i < b; i += step) {
    let low = i, high = i, any = false;
    for (let k = i; k < Math.min(b, i + step); ++k) {
      if (!isFinite(y[k])) continue;
      if (!any || y[k] < y[low]) low = k;
      if (!any || y[k] > y[high]) high = k;
      any = true;
    }
    if (!any) { points.push(null); continue; }
    points.push(Math.min(low, high));
    if (low !== high) points.push(Math.max(low, high));
  }
  return points;
}

// series: [{name, style, x, y, rows?}], x ascending. options: {title, note, x, y, zero, onRow, describe}
function linePlot(options, series) {
  const frame = plotFrame(options.title, options.note);
  axisLabels(frame, options.x, options.y);
  legend(frame.figure, series);
  const finite = (values) => Array.from(values).filter(isFinite);
  const all = [d3.min(series, (s) => d3.min(finite(s.x))), d3.max(series, (s) => d3.max(finite(s.x)))];
  const heights = [options.zero ? 0 : d3.min(series, (s) => d3.min(finite(s.y))), d3.max(series, (s) => d3.max(finite(s.y)))];
  if (!isFinite(all[0]) || !isFinite(heights[1])) return null;
  if (all[0] === all[1]) all[1] += 1;
  if (heights[0] === heights[1]) heights[1] += 1;
  const x = d3.scale.linear().domain(all).range([0, frame.width]);
  const y = d3.scale.linear().domain(heights).nice().range([frame.height, 0]);
  const axisX = d3.svg.axis().scale(x).orient("bottom").ticks(Math.min(10, frame.width / 70)), axisY = d3.svg.axis().scale(y).orient("left").ticks(5).tickSize(-frame.width);
  const lines = series.map((s) => frame.marks.append("path").attr("class", "line " + s.style));
  const draw = () => {
    frame.axes.x.call(axisX);
    frame.axes.y.call(axisY);
    const [from, to] = x.domain();
    series.forEach((s, k) => {
      const line = d3.svg.line().defined((i) => i !== null).x((i) => x(s.x[i])).y((i) => y(s.y[i]));
      lines[k].attr("d", line(thinned(s.x, s.y, from, to, 1200)));
    });
  };
  const zoom = (domain) => { x.domain(domain); draw(); };
  const brush = d3.svg.brush().x(x).on("brushend", () => {
    if (brush.empty()) return;
    zoom(brush.extent());
    frame.inner.select(".brush").call(brush.clear());
  });
  frame.inner.append("g").attr("class", "brush").call(brush).selectAll("rect").attr("height", frame.height);
  frame.svg.on("dblclick", () => zoom(all));
  frame.svg.on("keydown", () => {
    const [a, b] = x.domain(), span = b - a;
    const move = { ArrowLeft: -0.25, ArrowRight: 0.25 }[d3.event.key];
    if (d3.event.key === "Escape") zoom(all);
    else if (d3.event.key === "+") zoom([a + span / 4, b - span / 4]);
    else if (d3.event.key === "-") zoom([Math.max(all[0], a - span / 2), Math.min(all[1], b + span / 2)]);
    else if (move) zoom([a + move * span, b + move * span]);
    else return;
    d3.event.preventDefault();
  });
  hover(frame, options, series, x, y);
  draw();
  return frame.figure;
}

function hover(frame, options, series, x, y) {
  const cursor = frame.inner.append("line").attr("class", "cursor").attr("y1", 0).attr("y2", frame.height).style("display", "none");
  const read = element("output", { class: "readout" }, "\u00a0");
  frame.figure.append(read);
  const nearest = () => {
    const at = x.invert(d3.mouse(frame.inner.node())[0]);
    const s = series[0];
    const i = Math.min(s.x.length - 1, Math.max(0, d3.bisectLeft(s.x, at)));
    return i > 0 && at - s.x[i - 1] < s.x[i] - at ? i - 1 : i;
  };
  frame.svg.on("mousemove", () => {
    const i = nearest();
    cursor.style("display", null).attr("x1", x(series[0].x[i])).attr("x2", x(series[0].x[i]));
    const values = series.filter((s) => i < s.y.length).map((s) => `${s.name || options.y} ${number(s.y[i], 3)}`).join(", ");
    read.textContent = (options.describe ? options.describe(i) + ": " : "") + values;
  });
  frame.svg.on("mouseleave", () => cursor.style("display", "none"));
  if (options.onRow) frame.svg.on("click", () => { if (!d3.event.defaultPrevented) options.onRow(nearest()); });
}

// Ways from above, both axes alike; wheel with Ctrl, or after a click into it, zooms; dragging moves.
function planPlot(options, series) {
  const frame = plotFrame(options.title, options.note, 520);
  axisLabels(frame, options.x, options.y);
  legend(frame.figure, series);
  const xs = d3.merge(series.map((s) => s.x)).filter(isFinite), ys = d3.merge(series.map((s) => s.y)).filter(isFinite);
  if (xs.length === 0) return null;
  const [left, right] = d3.extent(xs), [low, high] = d3.extent(ys);
  const unit = 1.05 * Math.max((right - left) / frame.width, (high - low) / frame.height, 1e-6);
  const about = (middle, size) => [middle - (unit * size) / 2, middle + (unit * size) / 2];
  const x = d3.scale.linear().domain(about((left + right) / 2, frame.width)).range([0, frame.width]);
  const y = d3.scale.linear().domain(about((low + high) / 2, frame.height)).range([frame.height, 0]);
  const axisX = d3.svg.axis().scale(x).orient("bottom").ticks(Math.min(8, frame.width / 70)), axisY = d3.svg.axis().scale(y).orient("left").ticks(6);
  const lines = series.map((s) => frame.marks.append("path").attr("class", "line " + s.style));
  const draw = () => {
    frame.axes.x.call(axisX);
    frame.axes.y.call(axisY);
    series.forEach((s, k) => lines[k].attr("d", d3.svg.line().x((_, i) => x(s.x[i])).y((_, i) => y(s.y[i]))(s.x)));
  };
  keepScrolling(frame.svg.node());
  frame.svg.call(d3.behavior.zoom().x(x).y(y).on("zoom", draw));
  draw();
  return frame.figure;
}

// series: [{name, style, values}]
function histogram(options, series) {
  const values = series.map((s) => Array.from(s.values).filter(isFinite));
  const most = d3.max(values, (v) => (v.length > 0 ? d3.quantile(v.slice().sort(d3.ascending), 0.995) : 0));
  if (!(most > 0)) return null;
  const frame = plotFrame(options.title, options.note);
  axisLabels(frame, options.x, "share of scans [%]");
  legend(frame.figure, series);
  const x = d3.scale.linear().domain([0, most]).range([0, frame.width]);
  const bins = values.map((v) => d3.layout.histogram().range([0, most]).bins(x.ticks(40)).frequency(true)(v.map((e) => Math.min(e, most * 0.9999))));
  const y = d3.scale.linear().range([frame.height, 0]).domain([0, d3.max(bins, (b, k) => d3.max(b, (bin) => (100 * bin.length) / Math.max(1, values[k].length)))]).nice();
  frame.axes.x.call(d3.svg.axis().scale(x).orient("bottom").ticks(Math.min(10, frame.width / 70)));
  frame.axes.y.call(d3.svg.axis().scale(y).orient("left").ticks(5).tickSize(-frame.width));
  bins.forEach((bin, k) => {
    frame.marks.append("g").selectAll("rect").data(bin).enter().append("rect").attr("class", "bar " + series[k].style)
      .attr("x", (b) => x(b.x)).attr("width", (b) => Math.max(1, x(b.x + b.dx) - x(b.x) - 1))
      .attr("y", (b) => y((100 * b.length) / Math.max(1, values[k].length))).attr("height", (b) => frame.height - y((100 * b.length) / Math.max(1, values[k].length)))
      .append("title").text((b) => `${number(b.x, 3)} to ${number(b.x + b.dx, 3)}: ${b.length} scans`);
  });
  return frame.figure;
}

// A bar each of [[name, value]].
function bars(title, unit, entries) {
  const most = d3.max(entries, (e) => e[1]);
  const rows = entries.map(([name, value]) => {
    const bar = element("span", { class: "measure" });
    bar.style.width = `${Math.max(0.5, (100 * value) / most)}%`;
    return element("tr", {}, element("th", { scope: "row" }, name), element("td", {}, `${number(value, 2)} ${unit}`), element("td", { class: "bars" }, bar));
  });
  return element("figure", {}, element("figcaption", {}, title), element("table", {}, element("tbody", {}, ...rows)));
}
