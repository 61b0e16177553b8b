"use strict";
// Charts on canvas with zoom; what is drawn comes from the JSON above this script.

const COLOURS = ["#1f4e79", "#b35806", "#2ca02c", "#d62728", "#9467bd", "#17becf", "#8c564b", "#7f7f7f"];
const SOLIDS = "#e08214", CONTACT = "#d62728", GREY = "#999";
const VIRIDIS = ["440154", "482878", "3e4989", "31688e", "26828e", "1f9e89", "35b779", "6ece58", "b5de2b", "fde725"]
  .map(c => [0, 2, 4].map(k => parseInt(c.slice(k, k + 2), 16)));
const MARGIN = { left: 70, right: 14, top: 8, bottom: 40 };

function unpacked(text, Type = Float32Array) {
  const raw = atob(text), bytes = new Uint8Array(raw.length);
  for (let i = 0; i < raw.length; i++) bytes[i] = raw.charCodeAt(i);
  return new Type(bytes.buffer);
}

function element(parent, kind, className) {
  const made = document.createElement(kind);
  if (className) made.className = className;
  parent.appendChild(made);
  return made;
}

function ticks(low, high, most) {
  const rough = (high - low) / most, power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map(m => m * power).find(s => s >= rough);
  const found = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) found.push(k * step);
  return found;
}

function written(value, step = 0) {
  if (Math.abs(value) <= 1e-9 * step) return "0";
  const size = Math.abs(value);
  return size < 1e-4 || size >= 1e6 ? value.toExponential(1) : String(+value.toPrecision(6));
}

function extent(arrays) {
  let low = Infinity, high = -Infinity;
  for (const values of arrays) for (const v of values) {
    if (v < low) low = v;
    if (v > high) high = v;
  }
  return low < high ? [low, high] : [low - 1, low + 1];
}

class Chart {
  // options: xlabel, ylabel, height, x: [low, high], y: [low, high], linked: charts that share x
  constructor(parent, options) {
    this.options = options;
    const box = element(parent, "div", "chart");
    this.legend = element(box, "div", "legend");
    this.canvas = element(box, "canvas");
    this.canvas.style.height = (options.height || 230) + "px";
    this.x = options.x;
    this.y = options.y;
    this.series = [];
    this.linked = options.linked || [];
    this.linked.push(this);
    this.listen();
  }

  show(series) {
    this.series = series;
    this.legend.replaceChildren();
    for (const one of series.filter(s => s.name)) {
      const entry = element(this.legend, "span");
      element(entry, "i").style.background = one.colour;
      entry.append(one.name);
    }
    this.read = element(this.legend, "span", "read");
    this.draw();
  }

  zoom(x, y) {
    for (const chart of this.linked) {
      chart.x = x || chart.options.x;
      chart.draw();
    }
    this.y = y || this.options.y;
    this.draw();
  }

  place() {
    const box = this.canvas.getBoundingClientRect();
    this.width = box.width - MARGIN.left - MARGIN.right;
    this.height = box.height - MARGIN.top - MARGIN.bottom;
    return box;
  }

  toX(v) { return MARGIN.left + this.width * (v - this.x[0]) / (this.x[1] - this.x[0]); }
  toY(v) { return MARGIN.top + this.height * (1 - (v - this.y[0]) / (this.y[1] - this.y[0])); }
  fromX(p) { return this.x[0] + (p - MARGIN.left) / this.width * (this.x[1] - this.x[0]); }
  fromY(p) { return this.y[0] + (1 - (p - MARGIN.top) / this.height) * (this.y[1] - this.y[0]); }

  draw() {
    const box = this.place(), ratio = window.devicePixelRatio || 1, pen = this.canvas.getContext("2d");
    this.canvas.width = box.width * ratio;
    this.canvas.height = box.height * ratio;
    pen.scale(ratio, ratio);
    pen.font = "12px system-ui, sans-serif";
    pen.save();
    pen.beginPath();
    pen.rect(MARGIN.left, MARGIN.top, this.width, this.height);
    pen.clip();
    if (this.options.image) this.drawImage(pen);
    for (const one of this.series) this.drawSeries(pen, one);
    pen.restore();
    this.drawAxes(pen);
    if (this.drag && this.drag.moved) {
      pen.strokeStyle = "#000";
      pen.strokeRect(...this.drag.from, this.drag.to[0] - this.drag.from[0], this.drag.to[1] - this.drag.from[1]);
    }
  }

  drawImage(pen) {
    const { image, place } = this.options;
    pen.imageSmoothingEnabled = false;
    const [left, right] = place.x.map(v => this.toX(v)), [bottom, top] = place.y.map(v => this.toY(v));
    pen.drawImage(image, left, top, right - left, bottom - top);
  }

  drawSeries(pen, one) {
    pen.strokeStyle = pen.fillStyle = one.colour;
    pen.lineWidth = one.thin ? 0.8 : 1.3;
    pen.setLineDash(one.dashed ? [5, 4] : []);
    if (one.marks) {
      for (let i = 0; i < one.x.length; i++) {
        if (!one.marks[i]) continue;
        const px = this.toX(one.x[i]), py = this.toY(one.y[i]);
        pen.beginPath();
        pen.moveTo(px, py);
        pen.lineTo(px - 4, py - 7);
        pen.lineTo(px + 4, py - 7);
        pen.fill();
      }
      return;
    }
    pen.beginPath();
    let open = false;
    for (let i = 0; i < one.x.length; i++) {
      if (!Number.isFinite(one.y[i])) { open = false; continue; }
      const px = this.toX(one.x[i]), py = this.toY(one.y[i]);
      open ? pen.lineTo(px, py) : pen.moveTo(px, py);
      open = true;
    }
    if (one.filled) {
      pen.lineTo(this.toX(one.x[one.x.length - 1]), this.toY(0));
      pen.lineTo(this.toX(one.x[0]), this.toY(0));
      pen.fill();
    } else pen.stroke();
  }

  drawAxes(pen) {
    const bottom = MARGIN.top + this.height;
    pen.setLineDash([]);
    pen.lineWidth = 1;
    pen.strokeStyle = "#555";
    pen.fillStyle = "#222";
    pen.strokeRect(MARGIN.left, MARGIN.top, this.width, this.height);
    pen.textAlign = "center";
    pen.textBaseline = "top";
    for (const v of ticks(...this.x, Math.max(2, this.width / 90))) {
      const px = this.toX(v);
      pen.beginPath(); pen.moveTo(px, bottom); pen.lineTo(px, bottom + 4); pen.stroke();
      pen.fillText(written(v, this.x[1] - this.x[0]), px, bottom + 6);
    }
    pen.fillText(this.options.xlabel, MARGIN.left + this.width / 2, bottom + 22);
    pen.textAlign = "right";
    pen.textBaseline = "middle";
    for (const v of ticks(...this.y, Math.max(3, this.height / 32))) {
      const py = this.toY(v);
      pen.beginPath(); pen.moveTo(MARGIN.left - 4, py); pen.lineTo(MARGIN.left, py); pen.stroke();
      pen.fillText(written(v, this.y[1] - this.y[0]), MARGIN.left - 6, py);
    }
    pen.save();
    pen.translate(12, MARGIN.top + this.height / 2);
    pen.rotate(-Math.PI / 2);
    pen.textAlign = "center";
    pen.fillText(this.options.ylabel, 0, 0);
    pen.restore();
  }

  at(event) {
    const box = this.canvas.getBoundingClientRect();
    const within = (p, low, size) => Math.min(Math.max(p, low), low + size);
    return [within(event.clientX - box.left, MARGIN.left, this.width),
            within(event.clientY - box.top, MARGIN.top, this.height)];
  }

  listen() {
    const canvas = this.canvas;
    canvas.addEventListener("wheel", event => {
      event.preventDefault();
      const middle = this.fromX(this.at(event)[0]), factor = event.deltaY > 0 ? 1.25 : 0.8;
      const [low, high] = this.options.x;
      const x = this.x.map(v => Math.min(Math.max(middle + (v - middle) * factor, low), high));
      if (x[1] - x[0] > 1e-6 * (high - low)) this.zoom(x, this.y);
    }, { passive: false });
    canvas.addEventListener("mousedown", event => { this.drag = { from: this.at(event), moved: false }; });
    canvas.addEventListener("mousemove", event => this.tell(event));
    window.addEventListener("mousemove", event => {
      if (!this.drag) return;
      this.drag.to = this.at(event);
      this.drag.moved = Math.hypot(this.drag.to[0] - this.drag.from[0], this.drag.to[1] - this.drag.from[1]) > 5;
      this.draw();
    });
    window.addEventListener("mouseup", event => {
      const drag = this.drag;
      this.drag = null;
      if (!drag) return;
      if (!drag.moved) { this.draw(); if (this.options.clicked) this.options.clicked(this.fromY(this.at(event)[1])); return; }
      const sorted = (a, b) => a < b ? [a, b] : [b, a];
      const flat = Math.abs(drag.to[1] - drag.from[1]) < 12;
      const x = sorted(this.fromX(drag.from[0]), this.fromX(drag.to[0]));
      const y = flat ? this.y : sorted(this.fromY(drag.from[1]), this.fromY(drag.to[1]));
      x[1] > x[0] ? this.zoom(x, y) : this.draw();
    });
    canvas.addEventListener("dblclick", () => this.zoom(null, null));
    window.addEventListener("resize", () => this.draw());
  }

  tell(event) {
    const [px, py] = this.at(event);
    if (this.read) this.read.textContent = `${written(+this.fromX(px).toPrecision(4))}, ${written(+this.fromY(py).toPrecision(4))}`;
  }
}

const data = JSON.parse(document.getElementById("data").textContent);
instantAndMap(data.frames);
stepFigures(data.steps);
damage(data.damage);

function instantAndMap(frames) {
  const x = unpacked(frames.x), time = unpacked(frames.time), n = x.length;
  const field = name => frames[name] && unpacked(frames[name]);
  const pressure = field("pressure"), film = field("film_thickness"), solids = field("contact_pressure");
  const contact = unpacked(frames.contact, Uint8Array);
  const row = (values, k) => values.subarray(k * n, (k + 1) * n);
  const parent = document.getElementById("instant"), linked = [], across = [x[0], x[n - 1]];
  let highest = frames.p0, thickest = 0;
  if (pressure) highest = Math.max(highest, extent([pressure])[1]);
  if (film) film.forEach((h, i) => { if (Math.abs(x[i % n]) <= 1) thickest = Math.max(thickest, h); });
  const options = { xlabel: "x/a", x: across, linked };
  const upper = pressure && new Chart(parent, { ...options, ylabel: "pressure [GPa]", y: [0, 1.05 * highest] });
  const lower = film && new Chart(parent, { ...options, ylabel: "film [µm]", y: [0, 1.15 * thickest || 1] });
  const fine = Float32Array.from({ length: 401 }, (_, i) => -1 + i / 200);
  const hertz = { name: "Hertz", colour: GREY, dashed: true, x: fine, y: fine.map(v => frames.p0 * Math.sqrt(1 - v * v)) };
  let map = null;

  function show(k) {
    if (upper) {
      const series = [hertz, { name: solids ? "total pressure" : "pressure", colour: COLOURS[0], x, y: row(pressure, k) }];
      if (solids) series.unshift({ name: "of the solids", colour: SOLIDS, filled: true, x, y: row(solids, k) });
      upper.show(series);
    }
    if (lower) lower.show([{ name: "film", colour: COLOURS[0], x, y: row(film, k) },
                           { name: "in contact", colour: CONTACT, marks: row(contact, k), x, y: row(film, k) }]);
    document.getElementById("when").textContent = time.length > 1 ? `step ${frames.step[k]}, ${time[k].toFixed(3)} µs` : "";
    slider.value = k;
    if (map) map.show([{ colour: "#fff", thin: true, x: across, y: [time[k], time[k]] }]);
  }

  const slider = document.getElementById("slider"), play = document.getElementById("play");
  slider.max = time.length - 1;
  slider.addEventListener("input", () => show(+slider.value));
  let running = null;
  play.addEventListener("click", () => {
    running = running ? clearInterval(running) : setInterval(() => show((+slider.value + 1) % time.length), 80);
    play.textContent = running ? "stop" : "play";
  });
  if (time.length < 2) document.getElementById("frame-controls").remove();
  if (time.length < 2 || !pressure) document.getElementById("over-time").remove();
  else map = overTime(x, time, pressure, contact, k => show(k));
  show(frames.first);
}

function overTime(x, time, pressure, contact, chosen) {
  const n = x.length, image = document.createElement("canvas");
  image.width = n;
  image.height = time.length;
  const sorted = Float32Array.from(pressure).sort(), limit = sorted[Math.floor(0.999 * (sorted.length - 1))] || 1;
  const pen = image.getContext("2d"), pixels = pen.createImageData(n, time.length);
  for (let k = 0; k < time.length; k++) for (let i = 0; i < n; i++) {
    const from = k * n + i, to = 4 * ((time.length - 1 - k) * n + i);  // time runs upwards
    const level = Math.min(1, Math.max(0, pressure[from] / limit)) * (VIRIDIS.length - 1), low = Math.min(Math.floor(level), VIRIDIS.length - 2);
    for (let c = 0; c < 3; c++) {
      const red = parseInt(CONTACT.slice(1 + 2 * c, 3 + 2 * c), 16);
      pixels.data[to + c] = contact[from] ? red : VIRIDIS[low][c] + (level - low) * (VIRIDIS[low + 1][c] - VIRIDIS[low][c]);
    }
    pixels.data[to + 3] = 255;
  }
  pen.putImageData(pixels, 0, 0);
  const place = { x: [x[0], x[n - 1]], y: [time[0], time[time.length - 1]] };
  const parent = document.getElementById("over-time");
  const note = element(parent, "p", "help");
  note.textContent = `Colours from 0 to ${written(+limit.toPrecision(3))} GPa, contacts red. Click to see the instant above.`;
  const clicked = v => {
    let best = 0;
    time.forEach((t, k) => { if (Math.abs(t - v) < Math.abs(time[best] - v)) best = k; });
    chosen(best);
  };
  return new Chart(parent, { xlabel: "x/a", ylabel: "time [µs]", height: 380, ...place, image, place, clicked });
}

function stepFigures(steps) {
  const parent = document.getElementById("steps");
  if (!steps.figures.length) return parent.remove();
  const time = unpacked(steps.time), grid = element(parent, "div", "pair"), linked = [], all = [time[0], time[time.length - 1]];
  for (const figure of steps.figures) {
    const y = unpacked(figure.y).map(v => v), finite = extent([y]), room = 0.05 * (finite[1] - finite[0]);
    const chart = new Chart(grid, { xlabel: "time [µs]", ylabel: "", height: 180, linked, x: all, y: [finite[0] - room, finite[1] + room] });
    chart.show([{ name: figure.name, colour: COLOURS[0], thin: true, x: time, y }]);
  }
}

function damage(found) {
  const parent = document.getElementById("damage");
  if (!found) return parent.remove();
  const s = unpacked(found.s);
  for (const [side, rows] of Object.entries(found.surfaces)) {
    const values = rows.map(row => unpacked(row)), [low, high] = extent(values);
    const passed = s.filter((_, i) => values.some(row => Number.isFinite(row[i])));  // wholly through the contact
    const across = extent([passed.length ? passed : s]);
    const chart = new Chart(parent, { xlabel: `s/a, ${side} surface`, ylabel: "log10 of damage", x: across, y: [Math.max(low, high - 12), high + 0.5] });
    chart.show(values.map((y, k) => ({ name: `z = ${found.depths[k]} a`, colour: COLOURS[k % COLOURS.length], thin: true, x: s, y })));
  }
}
