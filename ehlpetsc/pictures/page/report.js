"use strict";
// Charts by Plotly, which stands above this script; what is drawn comes from the JSON before it.

const BLUE = "#1f4e79", SOLIDS = "#e08214", CONTACT = "#d62728", GREY = "#999";
const FILMS = [[0, "#f7fbff"], [0.25, "#c8dcf0"], [0.5, "#73b2d8"], [0.75, "#2979b9"], [1, "#08306b"]];
const CONFIG = { displaylogo: false, responsive: true, modeBarButtonsToRemove: ["select2d", "lasso2d"] };
const MARGIN = { l: 70, r: 20, t: 30, b: 45 };
const LETTERS = 60;  // of a line above a small chart

function unpacked(text, Type = Float32Array) {
  const raw = atob(text), bytes = new Uint8Array(raw.length);
  for (let i = 0; i < raw.length; i++) bytes[i] = raw.charCodeAt(i);
  return new Type(bytes.buffer);
}

function chart(id, height, traces, layout) {
  const box = document.createElement("div");
  box.style.height = height + "px";
  document.getElementById(id).appendChild(box);
  Plotly.newPlot(box, traces, { margin: MARGIN, hovermode: "closest", legend: { orientation: "h", y: 1.02, yanchor: "bottom" }, ...layout }, CONFIG);
  return box;
}

function folded(text) {
  const lines = [""];
  for (const word of text.split(" ")) {
    if (lines.at(-1).length + word.length > LETTERS) lines.push("");
    lines.push(`${lines.pop()} ${word}`);
  }
  return lines.map(line => line.trim()).join("<br>");
}

const largest = values => values.reduce((most, v) => (v > most ? v : most), 0);
const data = JSON.parse(document.getElementById("data").textContent);
instantAndMap(data.frames, data.maps ? planeMaps(data.maps, data.frames) : () => {}, data.maps ? "x/a along y = 0" : "x/a");
overTime(data.steps);
damage(data.damage);

// maps of a point contact or strip; returns the function that shows frame k
function planeMaps(maps, frames) {
  const { hertz, label, is_film: isFilm } = frames;
  const x = unpacked(maps.x), y = unpacked(maps.y), n = x.length, contact = unpacked(maps.contact, Uint8Array);
  const [pressure, values] = [maps.pressure, maps.values].map(field => { const levels = unpacked(field.levels, Uint16Array); return i => field.low + levels[i] * field.unit; });
  const rows = (of, k) => Array.from(y, (_, j) => Array.from(x, (_, i) => of((k * y.length + j) * n + i)));
  const about = { type: "heatmap", x, y, zmin: 0, hoverongaps: false }, [low, high] = maps.ends;
  const bar = (text, at) => ({ title: { text, side: "right" }, x: at, thickness: 14 });
  const traces = [
    { ...about, zmax: maps.highest, colorscale: "Viridis", colorbar: bar("pressure [GPa]", 0.43), hovertemplate: "%{x:.3f}, %{y:.3f} a: %{z:.3f} GPa<extra></extra>" },
    { ...about, zmin: low, zmax: high, colorscale: isFilm ? FILMS : "Cividis", colorbar: bar(label, 1), xaxis: "x2", yaxis: "y2", hovertemplate: "%{x:.3f}, %{y:.3f} a: %{z:.5~g}<extra></extra>" },
    { ...about, zmax: 1, colorscale: [[0, CONTACT], [1, CONTACT]], showscale: false, xaxis: "x2", yaxis: "y2", hovertemplate: `%{x:.3f}, %{y:.3f} a: ${frames.contact_word}<extra></extra>` },
  ];
  const edge = (k, end, color) => {
    const a = hertz[k][0], about = { xref: "x" + end, yref: "y" + end, line: { color, width: 1 } };
    if (maps.aspect) return [{ ...about, type: "circle", x0: -a, x1: a, y0: -a * maps.aspect, y1: a * maps.aspect }];
    return [-a, a].map(at => ({ ...about, type: "line", x0: at, x1: at, y0: y[0], y1: y[y.length - 1] }));
  };
  const ratio = (y[y.length - 1] - y[0]) / (x[n - 1] - x[0]), compact = ratio > 0.4 && ratio < 2.5;
  const across = end => ({ title: { text: "y/a" }, zeroline: false, anchor: "x" + end, ...(compact ? { scaleanchor: "x" + end, constrain: "domain" } : {}), ...(end ? { matches: "y" } : {}) });
  const along = { title: { text: ["x/a", data.flow, "line: dry contact"].filter(Boolean).join(", ") }, zeroline: false, constrain: "domain" };
  const box = chart("instant", Math.min(Math.max(420 * ratio, 240), 700) + 80, traces, {
    xaxis: { ...along, domain: [0, 0.42] }, xaxis2: { ...along, domain: [0.57, 0.99], anchor: "y2", matches: "x" }, yaxis: across(""), yaxis2: across("2"),
  });
  return k => Plotly.update(box, { z: [rows(pressure, k), rows(values, k), rows(i => (isFilm && contact[i] ? 1 : null), k)] }, { shapes: [...edge(k, "", "#fff"), ...edge(k, "2", "#000")] });
}

function instantAndMap(frames, maps, along) {
  const x = unpacked(frames.x), time = unpacked(frames.time), n = x.length, many = time.length > 1;
  const fields = {}, contact = unpacked(frames.contact, Uint8Array);
  for (const name of ["pressure", "solids", "values"]) if (frames[name]) fields[name] = unpacked(frames[name]);
  const row = (values, k) => values.subarray(k * n, (k + 1) * n);
  const touching = k => row(fields.values, k).map((h, i) => (contact[k * n + i] ? h : NaN));
  const fine = Array.from({ length: 401 }, (_, i) => -1 + i / 200);
  const line = (name, colour, more) => ({ name, x, mode: "lines", line: { color: colour, width: 1.4 }, ...more });
  const hertz = k => fine.map(v => frames.hertz[k][1] * Math.sqrt(Math.max(0, 1 - (v / frames.hertz[k][0]) ** 2)));
  const traces = [], moving = [];  // each trace, and its values at an instant
  const add = (trace, values) => { moving.push(values); traces.push(trace); };
  const { pressure, solids, values } = fields;
  add({ ...line("Hertz", GREY), x: fine, line: { color: GREY, dash: "dot" } }, hertz);
  if (solids) add(line("of the solids", SOLIDS, { fill: "tozeroy", line: { color: SOLIDS, width: 0 } }), k => row(solids, k));
  if (pressure) add(line(solids ? "total pressure" : "pressure", BLUE), k => row(pressure, k));
  add(line(frames.word, BLUE, { yaxis: "y2", showlegend: false }), k => row(values, k));
  if (frames.is_film) {
    add({ name: frames.contact_word, x, mode: "markers", yaxis: "y2", marker: { color: CONTACT, symbol: "triangle-down", size: 8 } }, touching);
  }
  const highest = Math.max(largest(frames.hertz.map(([, p0]) => p0)), pressure ? largest(pressure) : 0);
  const box = chart("instant", 520, traces, {
    xaxis: { title: { text: along }, range: [x[0], x[n - 1]], anchor: "y2", zeroline: false },
    yaxis: { title: { text: "pressure [GPa]" }, range: [0, 1.05 * highest], domain: [0.54, 1] },
    yaxis2: { title: { text: frames.label }, range: frames.ends, domain: [0, 0.46] },
  });
  const map = many && pressure && pressureMap(x, time, frames.is_film ? pressure : values, contact, along, frames);
  const slider = document.getElementById("slider"), play = document.getElementById("play");

  function show(k) {
    Plotly.restyle(box, { y: moving.map(values => values(k)) }, moving.map((_, i) => i));
    document.getElementById("when").textContent = many ? `step ${frames.step[k]}, ${Number(time[k].toPrecision(4))} µs, travel ${frames.travel[k].toFixed(2)} a` : "";
    slider.value = k;
    maps(k);
    if (map) Plotly.relayout(map, { "shapes[0].y0": time[k], "shapes[0].y1": time[k] });
  }

  slider.max = time.length - 1;
  slider.addEventListener("input", () => show(+slider.value));
  let running = null;
  play.addEventListener("click", () => {
    running = running ? clearInterval(running) : setInterval(() => show((+slider.value + 1) % time.length), 120);
    play.textContent = running ? "stop" : "play";
  });
  if (map) map.on("plotly_click", event => show(time.indexOf(event.points[0].y)));
  else document.getElementById("over-time").remove();
  if (!many) document.getElementById("frame-controls").remove();
  show(frames.first);
}

function pressureMap(x, time, values, contact, along, { is_film: isPressure, label, ends, contact_word: word }) {
  const n = x.length, sorted = Float32Array.from(values).sort(), text = isPressure ? "pressure [GPa]" : label;
  const rows = of => Array.from(time, (_, k) => Array.from({ length: n }, (_, i) => of(k * n + i)));
  const about = { type: "heatmap", x, y: time, hovertemplate: "x/a %{x:.3f}, %{y:.2f} µs" };
  const field = {
    ...about, z: rows(i => values[i]), colorscale: "Viridis", zmin: isPressure ? 0 : ends[0], zmax: sorted[Math.floor(0.999 * (sorted.length - 1))] || 1,
    hovertemplate: about.hovertemplate + ": %{z:.4~g}<extra></extra>", colorbar: { title: { text, side: "right" } },
  };
  const contacts = {
    ...about, z: rows(i => (contact[i] ? 1 : null)), colorscale: [[0, CONTACT], [1, CONTACT]], showscale: false,
    hovertemplate: about.hovertemplate + `: ${word}<extra></extra>`, hoverongaps: false, opacity: 0.35,
  };
  return chart("over-time", 440, [field, contacts], {
    xaxis: { title: { text: along } }, yaxis: { title: { text: "time [µs]" } },
    shapes: [{ type: "line", xref: "paper", x0: 0, x1: 1, y0: time[0], y1: time[0], line: { color: "#fff", width: 1 } }],
  });
}

function overTime(steps) {
  if (!steps.figures.length) return document.getElementById("steps").remove();
  const x = unpacked(steps.time), columns = 2, rows = Math.ceil(steps.figures.length / columns);
  const layout = { grid: { rows, columns, pattern: "independent", xgap: 0.12, ygap: 0.4 }, showlegend: false, annotations: [] };
  const traces = steps.figures.map((figure, k) => {
    const end = k ? k + 1 : "";
    layout[`xaxis${end}`] = { zeroline: false, ...(k ? { matches: "x" } : {}) };
    layout[`yaxis${end}`] = { zeroline: false, exponentformat: "power" };
    layout.annotations.push({ text: folded(figure.name), align: "left", xref: `x${end} domain`, yref: `y${end} domain`, x: 0, y: 1.03, xanchor: "left", yanchor: "bottom", showarrow: false });
    return { name: figure.name, x, y: unpacked(figure.y), xaxis: `x${end}`, yaxis: `y${end}`, mode: "lines", line: { color: BLUE, width: 1 } };
  });
  for (let k = Math.max(0, traces.length - columns); k < traces.length; k++) layout[`xaxis${k ? k + 1 : ""}`].title = { text: "time [µs]" };
  chart("steps", 190 * rows + 60, traces, { ...layout, margin: { ...MARGIN, t: 50 } });
}

function damage(found) {
  if (!found) return document.getElementById("damage").remove();
  const s = unpacked(found.s);
  for (const [side, rows] of Object.entries(found.surfaces)) {
    const traces = rows.map((row, k) => ({ name: `z = ${found.depths[k]} a`, x: s, y: unpacked(row), mode: "lines", line: { width: 1 } }));
    const known = traces.flatMap(trace => Array.from(trace.y).filter(Number.isFinite)), high = known.reduce((a, b) => Math.max(a, b), -300);
    const low = Math.max(known.reduce((a, b) => Math.min(a, b), high), high - 12);
    chart("damage", 320, traces, { xaxis: { title: { text: `s/a, surface ${side}` } }, yaxis: { title: { text: "log10 of damage" }, range: [low, high + 0.5] } });
  }
}
