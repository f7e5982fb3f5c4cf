// Builds the page from its document.

async function buildPage() {
  const app = document.getElementById("app");
  if (typeof DecompressionStream === "undefined") {
    app.append(element("p", { class: "note" }, "Plots and the view in three dimensions need a browser of 2023 or later."));
    return;
  }
  await loadLibrary("d3");
  const report = await loadDocument();
  for (const plot of report.plots || []) app.append((plot.plan ? planPlot(plot, plot.series) : linePlot(plot, plot.series)) || "");
  if (!report.scans) {
    document.body.dataset.state = "ready";
    return;
  }
  const scans = new Scans(report);
  const links = {};
  const map = new TopMap(report, scans, links), view = new View(report, scans, links), closures = new Closures(report, scans, links);
  links.point = (row) => map.point(row);
  links.show = (row) => { map.point(row); view.goTo(row); (view.renderer ? view : map).node.scrollIntoView({ block: "nearest" }); };
  links.closure = (id) => closures.open(id);
  document.getElementById("pictures").hidden = true;
  const recall = precisionAndRecall(report);
  if (recall) closures.node.append(recall);
  const sections = [map.node, view.node, closures.node, errorSection(report, scans, links), odometrySection(report, scans, links), mapSection(report), mergeSection(report), solutionSection(report), timeSection(report), inputSection(report), configurationSection(report)].filter(Boolean);
  app.append(...sections);
  document.getElementById("contents").append(...sections.map((s) => element("a", { href: "#" + s.id }, s.querySelector("h2").textContent)));
  document.body.dataset.state = "shown";
  await view.start();
  document.body.dataset.state = "ready";
}

buildPage().catch((error) => {
  document.body.dataset.state = "failed";
  console.error(error);
  document.getElementById("app").prepend(element("p", { class: "remark untrusted" }, "The page could not be built in full: " + error.message));
});
