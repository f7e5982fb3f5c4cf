// Tables that sort by any column (d3 keeps rows and data together) and narrow down by a word.

// columns: [{name, value: (row) => number|string, text?: (row) => string, title?}]
function sortedTable(columns, rows, options = {}) {
  const table = element("table", { class: "sorted" });
  const head = table.createTHead().insertRow();
  const body = d3.select(table).append("tbody");
  let order = { column: -1, down: false };
  const sort = (k) => {
    order = { column: k, down: order.column === k ? !order.down : false };
    const value = columns[k].value;
    const missing = (v) => v === null || v === undefined || Number.isNaN(v);
    body.selectAll("tr").sort((a, b) => {
      const va = value(a), vb = value(b);
      if (missing(va) || missing(vb)) return missing(va) - missing(vb);
      return order.down ? d3.descending(va, vb) : d3.ascending(va, vb);
    });
    Array.from(head.cells).forEach((cell, i) => cell.setAttribute("aria-sort", i !== k ? "none" : order.down ? "descending" : "ascending"));
  };
  columns.forEach((column, k) => head.append(element("th", { scope: "col", "aria-sort": "none", title: column.title }, element("button", { type: "button", onclick: () => sort(k) }, column.name))));
  const lines = body.selectAll("tr").data(rows).enter().append("tr");
  columns.forEach((column) => {
    const cell = lines.append("td").attr("class", column.style || null);
    if (column.node) cell.each(function (row) { this.append(column.node(row)); });
    else cell.text((row) => { const v = column.text ? column.text(row) : column.value(row); return v === null || v === undefined ? "–" : v; });
  });
  if (options.rowClass) lines.attr("class", options.rowClass);
  const wide = element("div", { class: "wide tall", tabindex: 0, role: "region", "aria-label": options.label || "table" }, table);
  return { node: wide, filter: (keep) => lines.style("display", (row) => (keep(row) ? null : "none")), lines };
}

// Rows of text under a head, as they are.
function plainTable(columns, rows) {
  const head = columns.length > 0 ? element("thead", {}, element("tr", {}, ...columns.map((c) => element("th", { scope: "col" }, c)))) : null;
  const body = element("tbody", {}, ...rows.map((row) => element("tr", {}, ...row.map((cell, k) => element(k === 0 ? "th" : "td", k === 0 ? { scope: "row" } : {}, cell === null || cell === undefined ? "–" : String(cell))))));
  return element("div", { class: "wide" }, element("table", {}, head, body));
}
