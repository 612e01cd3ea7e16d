// One figure as technique x failure, and the table that sorts. Runs as a function of (root, data, d3), see report.py.
"use strict";
const box = d3.select(root).select("#stability-matrix"), select = d3.select(root).select("#stability-figure");

function drawMatrix() {
  const figure = select.property("value");
  box.selectAll("*").remove();
  const table = box.append("table");
  table.append("thead").append("tr").selectAll("th").data(["failure", "", ...data.techniques]).enter().append("th").text(name => name);
  const rows = table.append("tbody").selectAll("tr").data(data.sequences).enter().append("tr");
  rows.append("td").append("a").attr("href", sequence => "#stability-" + sequence.id).text(sequence => sequence.id);
  rows.append("td").text(sequence => sequence.failure);
  const cells = rows.selectAll(".number").data(sequence => sequence.cells[figure]).enter().append("td")
    .attr("class", cell => "number stability-" + cell.level).text(cell => cell.text);
  cells.filter(cell => cell.floor).append("small").text(cell => cell.floor);
}

// By the number where there is one, else by the text; what has no figure comes last.
function sortBy(column, up) {
  const read = row => {
    const cell = row.cells[column], text = cell.textContent;
    return cell.dataset.value !== undefined ? Number(cell.dataset.value) : cell.classList.contains("number") ? null : text;
  };
  const body = root.querySelector("#stability-figures tbody");
  [...body.rows].sort((a, b) => {
    const x = read(a), y = read(b);
    if (x === null || y === null) return (x === null) - (y === null);
    return (up ? 1 : -1) * (x < y ? -1 : x > y ? 1 : 0);
  }).forEach(row => body.appendChild(row));
}

let sorted = {column: -1, up: false};
root.querySelectorAll("#stability-figures th").forEach((head, column) => {
  head.addEventListener("click", () => {
    sorted = {column, up: sorted.column === column && !sorted.up};
    sortBy(column, sorted.up);
  });
});
select.on("change", drawMatrix);
drawMatrix();
