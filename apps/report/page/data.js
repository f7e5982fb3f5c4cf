// The arrays of the page: base64, deflated, byte planes side by side (blobs.cpp makes them).

async function inflate(base64, format) {
  const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream(format));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

const kArrays = { f32: Float32Array, f64: Float64Array, u32: Uint32Array, u16: Uint16Array, u8: Uint8Array };

// A reference {blob, type, length} as the array it names.
async function arrayOf(reference) {
  if (!reference) return null;
  const planes = await inflate(document.getElementById("blob-" + reference.blob).textContent, "deflate");
  const Type = kArrays[reference.type];
  const width = Type.BYTES_PER_ELEMENT;
  const n = reference.length;
  const bytes = new Uint8Array(n * width);
  for (let k = 0; k < width; ++k) {
    for (let i = 0; i < n; ++i) bytes[i * width + k] = planes[k * n + i];
  }
  return new Type(bytes.buffer);
}

// A library that the page carries packed: run once, when it is first asked for.
const loadedLibraries = new Map();
function loadLibrary(name) {
  if (!loadedLibraries.has(name)) {
    loadedLibraries.set(name, (async () => {
      const packed = document.getElementById("library-" + name).textContent;
      const script = document.createElement("script");
      script.textContent = new TextDecoder().decode(await inflate(packed, "gzip"));
      document.head.append(script);
    })());
  }
  return loadedLibraries.get(name);
}

// The page's document, and its per-scan arrays in place of their references.
async function loadDocument() {
  const report = JSON.parse(new TextDecoder().decode(await arrayOf(JSON.parse(document.getElementById("document").textContent))));
  const scans = report.scans || {};
  for (const key of Object.keys(scans)) {
    if (scans[key] && scans[key].blob !== undefined) scans[key] = await arrayOf(scans[key]);
  }
  return report;
}

// Rows of the table of scans.
class Scans {
  constructor(report) {
    this.report = report;
    Object.assign(this, report.scans);
    this.strandOfRow = new Uint16Array(this.rows);
    report.strands.forEach((strand, s) => this.strandOfRow.fill(s, strand.first_row, strand.first_row + strand.rows));
    this.way = this.ways();
  }
  strand(row) { return this.report.strands[this.strandOfRow[row]]; }
  scan(row) {
    const strand = this.strand(row);
    return strand.first_scan + (row - strand.first_row) * strand.stride;
  }
  // Nanoseconds since the epoch, to the digit.
  stampText(row) {
    const ns = BigInt(this.stamp0) + BigInt(Math.round(this.stamp[row] * 1e9));
    const text = ns.toString().padStart(10, "0");
    return text.slice(0, -9) + "." + text.slice(-9, -3) + " s";
  }
  position(which, row) {
    const width = which === "truth" ? 3 : 7;
    const values = this[which];
    return [values[width * row], values[width * row + 1], values[width * row + 2]];
  }
  // Metres from the first row of a strand, along the solution.
  ways() {
    const way = new Float64Array(this.rows);
    for (let row = 1; row < this.rows; ++row) {
      if (this.strandOfRow[row] !== this.strandOfRow[row - 1]) continue;
      const a = this.position("optimised", row - 1), b = this.position("optimised", row);
      way[row] = way[row - 1] + Math.hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]);
    }
    return way;
  }
  // Length of the position error, NaN where nothing is known; which: odometry or optimised.
  error(which, row) {
    const e = this[which + "_error"];
    return e ? Math.hypot(e[4 * row], e[4 * row + 1], e[4 * row + 2]) : NaN;
  }
  hasTruth() { return Boolean(this.truth); }
  describe(row) {
    const several = this.report.strands.length > 1 ? this.strand(row).name + ", " : "";
    let text = `${several}scan ${this.scan(row)}, ${this.stampText(row)}, ${number(this.way[row], 1)} m along the way`;
    if (this.hasTruth() && isFinite(this.error("optimised", row)))
      text += `, error ${number(this.error("optimised", row), 2)} m (odometry ${number(this.error("odometry", row), 2)} m)`;
    return text;
  }
}

function number(value, decimals) {
  return value === null || value === undefined || !isFinite(value) ? "–" : value.toFixed(decimals);
}

// A rotation q = [x, y, z, w] of v.
function rotate(x, y, z, w, v) {
  const tx = 2 * (y * v[2] - z * v[1]), ty = 2 * (z * v[0] - x * v[2]), tz = 2 * (x * v[1] - y * v[0]);
  return [v[0] + w * tx + y * tz - z * ty, v[1] + w * ty + z * tx - x * tz, v[2] + w * tz + x * ty - y * tx];
}
// A pose [tx, ty, tz, qx, qy, qz, qw] of v.
function transform(pose, v) {
  const r = rotate(pose[3], pose[4], pose[5], pose[6], v);
  return [r[0] + pose[0], r[1] + pose[1], r[2] + pose[2]];
}

// element("div", {class: "x"}, child, "text")
function element(tag, attributes, ...children) {
  const node = document.createElement(tag);
  for (const [key, value] of Object.entries(attributes || {})) {
    if (key.startsWith("on")) node.addEventListener(key.slice(2), value);
    else if (value === true) node.setAttribute(key, "");
    else if (value !== false && value !== null && value !== undefined) node.setAttribute(key, value);
  }
  node.append(...children.filter((c) => c !== null && c !== undefined));
  return node;
}

function section(title, note) {
  const id = title.toLowerCase().replace(/[^a-z]+/g, "-");
  const node = element("section", { id, "aria-labelledby": id + "-title" }, element("h2", { id: id + "-title" }, title));
  if (note) node.append(element("p", { class: "note" }, note));
  return node;
}

// A switch with its label.
function toggle(label, on, change, swatch) {
  const box = element("input", { type: "checkbox" });
  box.checked = on;
  box.addEventListener("change", () => change(box.checked));
  return element("label", { class: "toggle" }, box, swatch ? element("span", { class: "swatch " + swatch }) : null, label);
}

function choice(label, options, change) {
  const select = element("select", {}, ...options.map(([value, text]) => element("option", { value }, text)));
  select.addEventListener("change", () => change(select.value));
  return element("label", {}, label + " ", select);
}
