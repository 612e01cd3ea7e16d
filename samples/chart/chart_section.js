// Charts (D3), sortable table and sliders. Runs as a function of (root, data, d3), see report.py.
"use strict";
const choice = {metric: "relMSE", truth: "own", time: data.time};
const tip = d3.select("body").append("div").attr("class", "tip");
const SIZE = {width: 760, height: 430, left: 64, right: 16, top: 12, bottom: 44};

function errorOf(point) {
  const judged = point.errors[choice.truth];
  const drawn = judged && (data.metrics[choice.metric].onAll ? judged.drawn : judged.pictureDrawn);
  if (!drawn || !point.ms || judged[choice.metric] === undefined) return null;
  const raw = judged[choice.metric];
  const value = choice.metric === "score" ? 10 - raw : Math.abs(raw);
  return value > 0 ? value : null;
}
const timeOf = point => point.ms[choice.time];
const short = value => value === null || value === undefined ? "" : Number(value).toPrecision(3);

function describe(point) {
  const own = point.errors.own || {};
  return `${point.technique}${point.label ? " (" + point.label + ")" : ""}\n${point.settings}\n` +
    `${short(point.ms.median)} ms, p99 ${short(point.ms.p99)} ms` +
    (point.ms.processor ? `, processor ${short(point.ms.processor)} ms` : "") + `\nrelMSE ${short(own.relMSE)}, nRMSE ${short(own.nrmse)}, ` +
    `score ${short(own.score)}, FLIP ${short(own.flip)}` +
    (own.views < data.sharedViews ? `\nmean of ${own.views} views of ${data.sharedViews}` : "");
}

// Axes that hold all points, a little wider; never empty, and never under half a decade, where small differences
// would look large.
function domainOf(values) {
  if (!values.length) return [0.1, 10];
  const [low, high] = d3.extent(values);
  const margin = Math.max(1.15, Math.pow(high / low, 0.06), Math.sqrt(Math.sqrt(10) * low / high));
  return [low / margin, high * margin];
}

// Plain numbers, readable also within one decade and not too many in several.
const ticksOf = scale => {
  const [low, high] = scale.domain();
  const digits = high / low < 8 ? [1, 1.5, 2, 3, 4, 5, 7] : high / low < 2e3 ? [1, 2, 5] : [1];
  const ticks = [];
  for (let decade = Math.floor(Math.log10(low)); decade <= Math.log10(high); ++decade)
    for (const digit of digits) ticks.push(Number(`${digit}e${decade}`));
  return ticks.filter(tick => tick >= low && tick <= high);
};
const plainTick = value => d3.format("~g")(value);

// Of names over each other the first stays; zooming in shows the others.
function hideOverlapping(names) {
  const taken = [];
  names.style("display", null).each(function () {
    const box = this.getBBox();
    const isFree = taken.every(other => box.x > other.x + other.width || other.x > box.x + box.width ||
      box.y > other.y + other.height || other.y > box.y + box.height);
    if (isFree) taken.push(box);
    else d3.select(this).style("display", "none");
  });
}

function drawChart(section, group) {
  const points = group.points.filter(point => errorOf(point) !== null);
  const hidden = group.points.length - points.length;
  const x0 = d3.scaleLog().domain(domainOf(points.map(timeOf))).range([SIZE.left, SIZE.width - SIZE.right]);
  const y0 = d3.scaleLog().domain(domainOf(points.map(errorOf))).range([SIZE.height - SIZE.bottom, SIZE.top]);
  section.selectAll("svg, .note").remove();
  const svg = section.insert("svg", ".after").attr("viewBox", `0 0 ${SIZE.width} ${SIZE.height}`).attr("width", SIZE.width);
  const clip = "clip" + group.id.replace(/\W/g, "_");
  svg.append("clipPath").attr("id", clip).append("rect").attr("x", SIZE.left).attr("y", SIZE.top)
    .attr("width", SIZE.width - SIZE.left - SIZE.right).attr("height", SIZE.height - SIZE.top - SIZE.bottom);
  const xAxis = svg.append("g").attr("class", "axis").attr("transform", `translate(0,${SIZE.height - SIZE.bottom})`);
  const yAxis = svg.append("g").attr("class", "axis").attr("transform", `translate(${SIZE.left},0)`);
  svg.append("text").attr("x", SIZE.width / 2).attr("y", SIZE.height - 8).attr("text-anchor", "middle").text(data.times[choice.time]);
  svg.append("text").attr("transform", `translate(14,${SIZE.height / 2}) rotate(-90)`).attr("text-anchor", "middle")
    .text(data.metrics[choice.metric].title);
  const plot = svg.append("g").attr("clip-path", `url(#${clip})`);
  const front = plot.append("path").attr("class", "front");
  const onFront = (group.fronts[`${choice.metric}|${choice.truth}|${choice.time}`] || [])
    .map(id => points.find(point => point.id === id)).filter(point => point);
  const symbol = point => d3.symbol().size(point.label ? 90 : 55)
    .type(point.bounces === 1 ? d3.symbolCircle : point.bounces === 2 ? d3.symbolSquare : d3.symbolDiamond)();
  const marks = plot.selectAll(".point").data(points).enter().append("path").attr("class", "point").attr("d", symbol)
    .attr("fill", point => data.colours[point.technique]).attr("fill-opacity", 0.8)
    .attr("stroke", point => point.label ? "#000" : "none").attr("stroke-width", 1.5)
    .on("mousemove", point => tip.style("display", "block").style("left", d3.event.clientX + 14 + "px")
      .style("top", d3.event.clientY + 10 + "px").text(describe(point)))
    .on("mouseout", () => tip.style("display", "none"))
    .on("click", point => showPicture(section, group, point.id));
  const names = plot.selectAll(".name").data(points.filter(point => point.label)).enter().append("text").attr("class", "name")
    .text(point => point.label);
  const place = (x, y) => {
    xAxis.call(d3.axisBottom(x).tickValues(ticksOf(x)).tickFormat(plainTick));
    yAxis.call(d3.axisLeft(y).tickValues(ticksOf(y)).tickFormat(plainTick));
    marks.attr("transform", point => `translate(${x(timeOf(point))},${y(errorOf(point))})`);
    names.attr("x", point => x(timeOf(point)) + 8).attr("y", point => y(errorOf(point)) - 6);
    hideOverlapping(names);
    const steps = onFront.map(point => [x(timeOf(point)), y(errorOf(point))]);
    if (steps.length) {  // from the upper edge down, and to the right edge
      steps.unshift([steps[0][0], SIZE.top]);
      steps.push([SIZE.width - SIZE.right, steps[steps.length - 1][1]]);
    }
    front.attr("d", d3.line().curve(d3.curveStepAfter)(steps));
  };
  place(x0, y0);
  const zoom = d3.zoom().scaleExtent([1, 200]).on("zoom", () => {
    const move = d3.event.transform;
    place(move.rescaleX(x0), move.rescaleY(y0));
  });
  svg.call(zoom).on("dblclick.zoom", () => svg.transition().duration(200).call(zoom.transform, d3.zoomIdentity));
  if (hidden) section.insert("p", ".after").attr("class", "note")
    .text(`${hidden} of ${group.points.length} points not drawn: the truth is too noisy for them, or does not judge them.`);
}

// Ours, truth and error map behind two handles.
function showPicture(section, group, id) {
  const images = group.images && group.images[id];
  if (!images) return;
  const point = group.points.find(each => each.id === id);
  section.select("select.pictures").property("value", id);
  const box = section.select(".slider");
  box.selectAll("*").remove();
  const sources = [images.error, group.truths[images.truth], images.picture];
  const layers = sources.map(source => box.append("img").attr("src", source).attr("draggable", "false").node());
  const at = [0.38, 0.75];
  const handles = at.map(() => box.append("div").attr("class", "handle"));
  const tags = [`${point.technique} ${point.settings}`, "truth", "relative error, white: 1 and more"].map(
    text => box.append("b").text(text));
  const place = () => {
    layers[2].style.clipPath = `inset(0 ${100 - 100 * at[0]}% 0 0)`;
    layers[1].style.clipPath = `inset(0 ${100 - 100 * at[1]}% 0 ${100 * at[0]}%)`;
    handles.forEach((handle, i) => handle.style("left", 100 * at[i] + "%"));
    [0, at[0], at[1]].forEach((share, i) => tags[i].style("left", `calc(${100 * share}% + .5em)`));
  };
  place();
  let held = -1;
  const move = event => {
    if (held < 0) return;
    const frame = box.node().getBoundingClientRect();
    const share = Math.min(1, Math.max(0, (event.clientX - frame.left) / frame.width));
    at[held] = held ? Math.max(share, at[0]) : Math.min(share, at[1]);
    place();
  };
  box.node().onpointerdown = event => {
    const frame = box.node().getBoundingClientRect(), share = (event.clientX - frame.left) / frame.width;
    held = Math.abs(share - at[0]) <= Math.abs(share - at[1]) ? 0 : 1;
    box.node().setPointerCapture(event.pointerId);
    move(event);
  };
  box.node().onpointermove = move;
  box.node().onpointerup = () => { held = -1; };
}

function addLegend(section) {
  const legend = section.append("p").attr("class", "legend");
  for (const [technique, colour] of Object.entries(data.colours)) {
    const item = legend.append("span");
    item.append("i").style("background", colour);
    item.append("span").text(technique);
  }
  legend.append("span").attr("class", "note").text("circle: one bounce; square: two; diamond: all");
}

const groups = [];
function addGroup(parent, group) {
  const section = d3.select(parent).append("section");
  section.append("h2").text(group.title);
  if (group.id === "mean") addLegend(section);
  section.append("div").attr("class", "after");
  const pictured = group.points.filter(point => point.picture);
  if (pictured.length) {
    const select = section.append("p").append("label").text("picture ").append("select").attr("class", "pictures");
    for (const point of pictured)
      select.append("option").attr("value", point.id)
        .text(`${point.technique}: ${point.settings}${point.label ? " (" + point.label + ")" : ""}`);
    section.append("div").attr("class", "slider");
    select.on("change", function () { showPicture(section, group, this.value); });
    showPicture(section, group, (pictured.find(point => point.label.includes("default")) || pictured[0]).id);
  }
  groups.push({section, group});
}

const COLUMNS = [
  ["scene", p => p.scene], ["camera", p => p.camera], ["technique", p => p.technique], ["settings", p => p.settings],
  ["name", p => p.label], ["bounces", p => p.bounces || "all"], ["frames", p => p.frames], ["ms", p => p.ms && p.ms.median],
  ["p99 ms", p => p.ms && p.ms.p99], ["processor ms", p => p.ms && p.ms.processor],
  ...["relMSE", "nrmse", "bias", "p99", "score", "flip"].map(key =>
    [key, p => p.errors.own && p.errors.own[key], "own", data.metrics[key].onAll ? "drawn" : "pictureDrawn"]),
  ["noise", p => p.errors.own && p.errors.own.noise],
  ["relMSE, all bounces", p => p.errors.all && p.errors.all.relMSE, "all", "drawn"],
  ["bias, all bounces", p => p.errors.all && p.errors.all.bias, "all", "drawn"],
  ["relMSE, on screen", p => p.errors.screen && p.errors.screen.relMSE, "screen", "drawn"],
  ["bias, on screen", p => p.errors.screen && p.errors.screen.bias, "screen", "drawn"]];
let sorted = {column: -1, up: true};

function fillTable() {
  const words = document.getElementById("filter").value.toLowerCase().split(/\s+/).filter(word => word);
  let rows = [].concat(...data.views.map(view => view.points));
  rows = rows.filter(p => words.every(word => `${p.scene} ${p.camera} ${p.technique} ${p.settings} ${p.label}`.toLowerCase().includes(word)));
  if (sorted.column >= 0) {
    const read = COLUMNS[sorted.column][1], sign = sorted.up ? 1 : -1;
    rows.sort((p, q) => {
      const a = read(p), b = read(q);
      const missing = (a === null || a === undefined) - (b === null || b === undefined);  // always last
      return missing || sign * (typeof a === typeof b ? d3.ascending(a, b) : typeof a === "string" ? 1 : -1) || 0;
    });
  }
  const lines = d3.select("#figures tbody").selectAll("tr").data(rows).join("tr");
  lines.selectAll("td").data(p => COLUMNS.map(([, read, truth, drawn]) => ({value: read(p), hidden: truth && p.errors[truth] && !p.errors[truth][drawn]})))
    .join("td").attr("class", cell => cell.hidden ? "hidden-figure" : null)
    .text(cell => typeof cell.value === "number" && !Number.isInteger(cell.value) ? short(cell.value) : cell.value);
}

function setUpTable() {
  d3.select("#figures thead").append("tr").selectAll("th").data(COLUMNS).enter().append("th").text(column => column[0])
    .on("click", function (column, index) {
      sorted = {column: index, up: sorted.column === index ? !sorted.up : true};
      d3.selectAll("#figures th").attr("class", (_, i) => i === index ? "sorted" + (sorted.up ? " up" : "") : null);
      fillTable();
    });
  document.getElementById("filter").oninput = fillTable;
  fillTable();
}

function drawAll() {
  // What judges the composite knows no truth of all bounces.
  if (!data.metrics[choice.metric].onAll) choice.truth = "own";
  d3.select("#truth").property("value", choice.truth);
  for (const {section, group} of groups) drawChart(section, group);
}

for (const [id, names] of [["metric", data.metrics], ["truth", data.truths], ["time", data.times]]) {
  const select = d3.select("#" + id);
  for (const [key, name] of Object.entries(names)) select.append("option").attr("value", key).text(name.title || name);
  select.property("value", choice[id]).on("change", function () { choice[id] = this.value; drawAll(); });
}
addGroup("#summary", data.mean);
for (const view of data.views) addGroup("#views", view);
drawAll();
setUpTable();
