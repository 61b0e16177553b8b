addEventListener("load", async () => {
  const wait = ms => new Promise(done => setTimeout(done, ms)), slider = document.getElementById("slider");
  const shown = () => document.querySelector("#instant .js-plotly-plot");
  await wait(1500);
  slider.value = 2;
  slider.dispatchEvent(new Event("input"));
  await wait(500);
  const found = { pressure: shown().data[0].z, edge: shown().layout.shapes[0].y1 };
  document.body.appendChild(document.createElement("output")).textContent = JSON.stringify(found);
});
