"use strict";

// Speeds from pale to deep blue.
const WATER = [
  [247, 251, 255], [219, 233, 246], [173, 208, 230], [107, 174, 214], [49, 130, 189], [12, 86, 160], [8, 40, 92],
];
const SOLID = "rgb(236, 170, 92)";
const TOUCHING = "rgb(214, 96, 77)";
const INK = "rgb(40, 44, 52)";
const FRAMES_PER_SECOND = 25;
const BAR = 64;

function water(t) {
  const at = Math.min(Math.max(t, 0), 1) * (WATER.length - 1);
  const k = Math.min(Math.floor(at), WATER.length - 2);
  return WATER[k].map((a, i) => Math.round(a + (at - k) * (WATER[k + 1][i] - a)));
}

function bytes(text) {
  const raw = atob(text);
  return Uint8Array.from(raw, (letter) => letter.charCodeAt(0));
}

// Points of an outline from pairs of 16-bit numbers.
function outline(text, data) {
  const raw = bytes(text);
  const view = new DataView(raw.buffer);
  const points = [];
  for (let k = 0; k + 3 < raw.length; k += 4) {
    points.push([
      data.low[0] + data.unit * view.getInt16(k, true),
      data.low[1] + data.unit * view.getInt16(k + 2, true),
    ]);
  }
  return points;
}

// Points outside of the fluid take the mean of their neighbours in it, a few times: bodies cover them, and the colours
// next to a body are those of the fluid.
function extended(field, columns, rows) {
  let values = Float32Array.from(field, (value) => (value === 255 ? NaN : value));
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

// A picture of the speed, one pixel per point of the raster.
function raster(frame, data, largest) {
  const [columns, rows] = data.n;
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
      const colour = water(Number.isNaN(value) ? 0 : ((value / 254) * frame.largest) / largest);
      image.data.set([...colour, 255], at);
    }
  }
  context.putImageData(image, 0, 0);
  return picture;
}

function animate(figure) {
  const data = JSON.parse(figure.querySelector("script").textContent);
  const canvas = figure.querySelector("canvas");
  const button = figure.querySelector("button");
  const slider = figure.querySelector("input");
  const output = figure.querySelector("output");
  const frames = data.frames;
  if (frames.length === 0) {
    figure.hidden = true;
    return;
  }
  // The fastest frames, with jets out of the gap, would leave no colours for the others.
  const speeds = frames.map((frame) => frame.largest).sort((a, b) => a - b);
  const largest = Math.max(speeds[Math.floor(0.7 * (speeds.length - 1))], 1e-9);
  const whole = data.mirror === null ? data.low[0] : 2 * data.mirror - data.high[0];
  const extent = [data.high[0] - Math.min(whole, data.low[0]), data.high[1] - data.low[1]];
  const left = Math.min(whole, data.low[0]);
  slider.max = frames.length - 1;

  function draw(index) {
    const frame = frames[index];
    const density = window.devicePixelRatio || 1;
    const width = canvas.clientWidth || 640;
    const scale = (width - BAR) / extent[0];
    const height = extent[1] * scale;
    canvas.width = Math.round(width * density);
    canvas.height = Math.round(height * density);
    canvas.style.height = `${height}px`;
    const context = canvas.getContext("2d");
    context.scale(density, density);
    context.imageSmoothingEnabled = true;
    context.imageSmoothingQuality = "high";
    const place = ([x, y]) => [(x - left) * scale, (data.high[1] - y) * scale];
    const picture = raster(frame, data, largest);
    const half = [(data.high[0] - data.low[0]) * scale, height];
    const sides = data.mirror === null ? [1] : [1, -1];
    for (const sign of sides) {
      context.save();
      if (sign < 0) {
        context.translate(2 * place([data.mirror, 0])[0], 0);
        context.scale(-1, 1);
      }
      context.drawImage(picture, place(data.low)[0], 0, half[0], half[1]);
      for (const text of frame.outlines) {
        const points = outline(text, data).map(place);
        const path = new Path2D();
        points.forEach(([x, y], k) => (k === 0 ? path.moveTo(x, y) : path.lineTo(x, y)));
        context.fillStyle = frame.touches ? TOUCHING : SOLID;
        context.fill(path);
        // Over the seam between a half and its mirror image.
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
    bar(context, width, height);
    const distance = frame.distance === null ? "" : `, distance ${frame.distance.toFixed(3)} cm`;
    output.textContent = `t = ${frame.time.toFixed(4)} s${distance}${frame.touches ? ", contact" : ""}`;
    canvas.dataset.frame = index;
  }

  function bar(context, width, height) {
    const [x, top, bottom] = [width - BAR + 14, 26, height - 10];
    for (let y = top; y < bottom; y++) {
      context.fillStyle = `rgb(${water((bottom - y) / (bottom - top)).join()})`;
      context.fillRect(x, y, 10, 1.5);
    }
    context.fillStyle = INK;
    context.font = "11px system-ui, sans-serif";
    context.textBaseline = "middle";
    context.fillText("cm/s", x - 4, 12);
    for (const part of [0, 0.5, 1]) {
      context.fillText((part * largest).toFixed(largest < 10 ? 1 : 0), x + 14, bottom + part * (top - bottom));
    }
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
    if (Number(slider.value) === frames.length - 1) {
      slider.value = 0;
    }
    button.textContent = "Pause";
    playing = setInterval(() => {
      slider.value = Number(slider.value) + 1;
      draw(Number(slider.value));
      if (Number(slider.value) === frames.length - 1) {
        stop();
      }
    }, 1000 / FRAMES_PER_SECOND);
  });
  slider.addEventListener("input", () => {
    stop();
    draw(Number(slider.value));
  });
  window.addEventListener("resize", () => draw(Number(slider.value)));
  window.addEventListener("beforeprint", () => draw(Number(slider.value)));
  // The first picture is that of the first contact, if there is one.
  const contact = frames.findIndex((frame) => frame.touches);
  slider.value = contact < 0 ? frames.length - 1 : contact;
  draw(Number(slider.value));
}

document.querySelectorAll(".animation").forEach(animate);
