"use strict";
// A visitor of the report: slides, clicks into the map, zooms; leaves what was seen as JSON in an output element.
const errors = [];
addEventListener("error", event => errors.push(event.message));
addEventListener("unhandledrejection", event => errors.push(String(event.reason)));

addEventListener("load", async () => {
  const found = {}, slider = document.getElementById("slider");
  const wait = ms => new Promise(done => setTimeout(done, ms));
  const drawn = id => document.querySelector(`#${id} .js-plotly-plot`);
  const shown = () => ({
    pressure: Math.max(...drawn("instant").data.find(trace => /pressure/.test(trace.name)).y),
    when: document.getElementById("when").textContent,
    line: drawn("over-time").layout.shapes[0].y0,
  });
  const fire = (kind, x, y, target) => (target || document.elementFromPoint(x, y)).dispatchEvent(
    new MouseEvent(kind, { bubbles: true, cancelable: true, clientX: x, clientY: y, buttons: 1, view: window }));

  async function pull(id, from, to) {  // parts of the width of its first panel
    const box = drawn(id).querySelector(".nsewdrag").getBoundingClientRect(), y = box.top + 0.5 * box.height;
    const [start, end] = [from, to].map(part => box.left + part * box.width), panel = document.elementFromPoint(start, y);
    fire("mousemove", start, y);
    await wait(200);
    fire("mousedown", start, y);
    for (const part of from === to ? [] : [0.3, 0.7, 1]) {
      fire("mousemove", start + part * (end - start), y, document);
      await wait(50);
    }
    fire("mouseup", end, y, document);
    fire("click", end, y, panel);
    await wait(800);
  }

  await wait(1500);
  found.first = shown();
  slider.value = 1;
  slider.dispatchEvent(new Event("input"));
  await wait(500);
  found.second = shown();
  await pull("over-time", 0.5, 0.5);
  found.clicked = shown();
  await pull("instant", 0.25, 0.75);
  found.zoomed = drawn("instant").layout.xaxis.range;
  await pull("steps", 0.25, 0.75);
  found.linked = [drawn("steps").layout.xaxis.range, drawn("steps").layout.xaxis2.range];
  found.errors = errors;
  document.body.appendChild(document.createElement("output")).textContent = JSON.stringify(found);
});
