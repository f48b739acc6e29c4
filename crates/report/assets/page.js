"use strict";

// ---- fields: bodies over the speed of the fluid ----

// Speeds from pale to deep blue.
const WATER = [
  [247, 251, 255], [219, 233, 246], [173, 208, 230], [107, 174, 214], [49, 130, 189], [12, 86, 160], [8, 40, 92],
];
const SOLID = "rgb(236, 170, 92)";
const TOUCHING = "rgb(214, 96, 77)";
const INK = "rgb(40, 44, 52)";
const OUTSIDE = 255;
// Colour of places outside the domain; bodies are drawn over those that they cover.
const WALL = [205, 205, 210];
const FRAMES_PER_SECOND = 25;
const BAR = 64;

function water(t) {
  const at = Math.min(Math.max(t, 0), 1) * (WATER.length - 1);
  const k = Math.min(Math.floor(at), WATER.length - 2);
  return WATER[k].map((a, i) => Math.round(a + (at - k) * (WATER[k + 1][i] - a)));
}

function bytes(text) {
  return Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
}

// Points of an outline from pairs of 16-bit numbers.
function outline(text, data) {
  const view = new DataView(bytes(text).buffer);
  const points = [];
  for (let k = 0; k + 3 < view.byteLength; k += 4) {
    points.push([0, 1].map((a) => data.low[a] + data.unit * view.getInt16(k + 2 * a, true)));
  }
  return points;
}

// Points outside the fluid take the mean of their neighbours in it, a few times. Bodies cover them; without this, the
// colours next to a body would be mixed with those of points inside it.
function extended(field, columns, rows) {
  let values = Float32Array.from(field, (value) => (value === OUTSIDE ? NaN : value));
  for (let pass = 0; pass < 3; pass++) {
    const next = values.slice();
    for (let k = 0; k < values.length; k++) {
      if (!Number.isNaN(values[k])) continue;
      const column = k % columns;
      let [sum, count] = [0, 0];
      for (const row of [-1, 0, 1]) {
        for (const across of [-1, 0, 1]) {
          const value = values[k + row * columns + across];
          if (column + across >= 0 && column + across < columns && value >= 0) {
            sum += value;
            count += 1;
          }
        }
      }
      if (count > 0) next[k] = sum / count;
    }
    values = next;
  }
  return values;
}

// The speed as a picture, one pixel per point of the raster.
function raster(frame, largest) {
  const [columns, rows] = frame.n;
  const field = extended(bytes(frame.speed), columns, rows);
  const picture = document.createElement("canvas");
  picture.width = columns;
  picture.height = rows;
  const context = picture.getContext("2d");
  const image = context.createImageData(columns, rows);
  for (let row = 0; row < rows; row++) {
    for (let column = 0; column < columns; column++) {
      const value = field[row * columns + column];
      const at = 4 * ((rows - 1 - row) * columns + column);
      const colour = Number.isNaN(value) ? WALL : water(((value / 254) * frame.largest) / largest);
      image.data.set([...colour, 255], at);
    }
  }
  context.putImageData(image, 0, 0);
  return picture;
}

// Draws a frame into a canvas as wide as its place on the page; `largest` is the speed of the darkest colour.
function drawFrame(canvas, data, frame, largest) {
  const whole = data.mirror === null ? data.low[0] : 2 * data.mirror - data.high[0];
  const left = Math.min(whole, data.low[0]);
  const right = data.mirror === null ? data.high[0] : Math.max(data.high[0], 2 * data.mirror - data.low[0]);
  const density = window.devicePixelRatio || 1;
  const width = canvas.clientWidth || 640;
  const scale = (width - BAR) / (right - left);
  const height = (data.high[1] - data.low[1]) * scale;
  canvas.width = Math.round(width * density);
  canvas.height = Math.round(height * density);
  canvas.style.height = `${height}px`;
  const context = canvas.getContext("2d");
  context.scale(density, density);
  context.imageSmoothingQuality = "high";
  const place = ([x, y]) => [(x - left) * scale, (data.high[1] - y) * scale];
  const picture = raster(frame, largest);
  for (const sign of data.mirror === null ? [1] : [1, -1]) {
    context.save();
    if (sign < 0) {
      context.translate(2 * place([data.mirror, 0])[0], 0);
      context.scale(-1, 1);
    }
    context.beginPath();
    // One pixel wider, so that no seam shows between a half and its mirror image.
    const box = [place(data.low)[0] - 0.5, 0, (data.high[0] - data.low[0]) * scale + 1, height];
    context.rect(...box);
    context.clip();
    context.drawImage(picture, ...box);
    for (const text of frame.outlines) {
      const path = new Path2D();
      outline(text, data).map(place).forEach(([x, y], k) => (k === 0 ? path.moveTo(x, y) : path.lineTo(x, y)));
      context.fillStyle = frame.touches ? TOUCHING : SOLID;
      context.fill(path);
      // Covers the seam between a half and its mirror image.
      const closed = new Path2D(path);
      closed.closePath();
      context.strokeStyle = context.fillStyle;
      context.lineWidth = 1;
      context.stroke(closed);
      context.strokeStyle = INK;
      context.lineWidth = 1.2;
      context.stroke(path);
    }
    context.restore();
  }
  const ink = getComputedStyle(document.body).color;
  const [x, top, bottom] = [width - BAR + 14, 26, height - 10];
  for (let y = top; y < bottom; y++) {
    context.fillStyle = `rgb(${water((bottom - y) / (bottom - top)).join()})`;
    context.fillRect(x, y, 10, 1.5);
  }
  context.fillStyle = ink;
  context.font = "11px system-ui, sans-serif";
  context.textBaseline = "middle";
  context.fillText(data.units.velocity, x - 4, 12);
  for (const part of [0, 0.5, 1]) {
    context.fillText(Number((part * largest).toPrecision(2)), x + 14, bottom + part * (top - bottom));
  }
}

function describe(frame, units) {
  const distance = frame.distance === null ? "" : `, distance ${Number(frame.distance.toPrecision(4))} ${units.length}`;
  return `t = ${frame.time.toFixed(4)} ${units.time}${distance}${frame.touches ? ", contact" : ""}`;
}

// Draws now, and again when the place or its colours change.
function keepDrawn(draw) {
  draw();
  window.addEventListener("resize", draw);
  window.addEventListener("beforeprint", draw);
  window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);
}

function still(figure) {
  const data = JSON.parse(figure.querySelector("script").textContent);
  const frame = data.frames[0];
  figure.querySelector("output").textContent = describe(frame, data.units);
  keepDrawn(() => drawFrame(figure.querySelector("canvas"), data, frame, frame.largest || 1));
}

function animate(figure) {
  const data = JSON.parse(figure.querySelector("script").textContent);
  const [canvas, button, slider, output] =
    ["canvas", "button", "input", "output"].map((name) => figure.querySelector(name));
  const frames = data.frames;
  // The few fastest frames would leave no colours for the others.
  const speeds = frames.map((frame) => frame.largest).sort((a, b) => a - b);
  const largest = speeds[Math.floor(0.7 * (speeds.length - 1))] || 1;
  slider.max = frames.length - 1;
  function draw() {
    const index = Number(slider.value);
    drawFrame(canvas, data, frames[index], largest);
    output.textContent = describe(frames[index], data.units);
    canvas.dataset.frame = index;
  }
  let playing = null;
  function stop() {
    clearInterval(playing);
    playing = null;
    button.textContent = "Play";
  }
  button.addEventListener("click", () => {
    if (playing !== null) {
      stop();
      return;
    }
    if (Number(slider.value) === frames.length - 1) slider.value = 0;
    button.textContent = "Pause";
    playing = setInterval(() => {
      slider.value = Number(slider.value) + 1;
      draw();
      if (Number(slider.value) === frames.length - 1) stop();
    }, 1000 / FRAMES_PER_SECOND);
  });
  slider.addEventListener("input", () => {
    stop();
    draw();
  });
  // The first picture is that of the first contact, if there is one.
  const contact = frames.findIndex((frame) => frame.touches);
  slider.value = contact < 0 ? frames.length - 1 : contact;
  keepDrawn(draw);
}

// ---- charts: uPlot ----

const CURVES = 6;

// Vertical lines at marked positions with their names, horizontal lines at levels.
function marksOf(data, colour) {
  return (chart) => {
    const { ctx, bbox } = chart;
    const pixels = window.devicePixelRatio || 1;
    ctx.save();
    ctx.setLineDash([5 * pixels, 4 * pixels]);
    ctx.lineWidth = pixels;
    ctx.strokeStyle = ctx.fillStyle = colour("--muted");
    ctx.font = `${11 * pixels}px system-ui, sans-serif`;
    const line = (from, to) => {
      ctx.beginPath();
      ctx.moveTo(...from);
      ctx.lineTo(...to);
      ctx.stroke();
    };
    data.marks.forEach(([name, at], k) => {
      const x = chart.valToPos(at, "x", true);
      if (x < bbox.left || x > bbox.left + bbox.width) return;
      line([x, bbox.top], [x, bbox.top + bbox.height]);
      ctx.fillText(name, x + 4 * pixels, bbox.top + (12 + 13 * k) * pixels);
    });
    for (const level of data.levels) {
      const y = chart.valToPos(level, "y", true);
      if (y >= bbox.top && y <= bbox.top + bbox.height) line([bbox.left, y], [bbox.left + bbox.width, y]);
    }
    ctx.restore();
  };
}

function plot(figure) {
  const data = JSON.parse(figure.querySelector("script").textContent);
  const place = figure.querySelector("div");
  let shared = [];
  const tables = data.curves.map((curve) => [(shared = curve.x ?? shared), curve.y]);
  const table = uPlot.join(tables);
  let chart = null;
  keepDrawn(() => {
    const style = getComputedStyle(document.documentElement);
    const colour = (name) => style.getPropertyValue(name).trim();
    const axis = { stroke: colour("--ink"), grid: { stroke: colour("--grid"), width: 1 }, ticks: { stroke: colour("--grid") } };
    const text = (value) => (value === null || value === undefined ? "–" : String(Number(value.toPrecision(5))));
    const labels = (_, values) => values.map((value) => (value === null ? "" : text(value)));
    chart?.destroy();
    chart = new uPlot(
      {
        width: place.clientWidth || 480,
        height: 230,
        cursor: { sync: { key: data.x_label, setSeries: false } },
        scales: { x: { time: false, distr: data.x_is_log ? 3 : 1 } },
        axes: [
          { ...axis, label: data.x_label, labelSize: 22, labelFont: "12px system-ui", size: 34, values: labels },
          { ...axis, size: 66, values: labels },
        ],
        legend: { markers: { width: 3 } },
        series: [
          { label: data.x_label, value: (_, value) => text(value) },
          ...data.curves.map((curve, k) => ({
            label: curve.label,
            stroke: colour(`--c${k % CURVES}`),
            width: 1.6,
            spanGaps: true,
            points: { show: curve.y.length < 30 },
            value: (_, value) => text(value),
          })),
        ],
        hooks: { draw: [marksOf(data, colour)] },
      },
      table,
      place,
    );
    if (data.window !== null) chart.setScale("x", { min: data.window[0], max: data.window[1] });
  });
}

document.querySelectorAll(".animation").forEach(animate);
document.querySelectorAll(".moment").forEach(still);
document.querySelectorAll(".chart").forEach(plot);
