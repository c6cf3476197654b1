// Elements, numbers as text, and plots. uPlot draws the axes; functions here draw what it has no picture for.

/// Makes an element: el("p", {class: "quiet"}, "text", child)
function el(tag, attributes, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes || {})) {
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else if (value !== null && value !== undefined && value !== false) element.setAttribute(name, value);
  }
  element.append(...children.filter(child => child !== null && child !== undefined));
  return element;
}

/// Returns a number with `digits` significant digits, never in scientific notation for usual sizes.
function number(x, digits = 2) {
  if (x === null || x === undefined || !isFinite(x)) return "–";
  if (x === 0) return "0";
  const decimals = digits - 1 - Math.floor(Math.log10(Math.abs(x)));
  if (decimals > 6) return x.toExponential(digits - 1);
  return x.toFixed(Math.max(0, Number(Math.abs(x).toPrecision(digits)) >= 10 ** (digits - decimals) ? decimals - 1 : decimals));
}
const plural = (count, noun) => count + " " + noun + (count === 1 ? "" : "s");
const css = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const paint = name => () => css(name);
const series_colours = ["--blue", "--orange", "--green", "--purple"];
const colourOf = index => series_colours[index % series_colours.length];

/// Makes a table. header: names of the columns; rows: texts or elements.
function table(caption, header, rows) {
  const head = el("tr", {}, ...header.map(name => el("th", {scope: "col"}, name)));
  const cell = value => value instanceof Node ? el("td", {}, value) : el("td", {}, String(value));
  const body = rows.map(row => el("tr", {}, ...row.map((value, i) =>
    i === 0 ? el("th", {scope: "row"}, String(value)) : cell(value))));
  return el("div", {class: "scroll", tabindex: "0", role: "region", "aria-label": caption},
    el("table", {}, el("caption", {}, caption), el("thead", {}, head), el("tbody", {}, ...body)));
}
const folded = (summary, ...content) => el("details", {}, el("summary", {}, summary), ...content);

// All drawings, to be drawn again when colours or widths change.
const drawings = [];
function redrawAll() { for (const drawing of drawings) drawing.redraw(); }
function resizeAll() { for (const drawing of drawings) drawing.resize(); }
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redrawAll);
addEventListener("resize", resizeAll);
addEventListener("beforeprint", () => { document.documentElement.dataset.paper = ""; resizeAll(); redrawAll(); });
addEventListener("afterprint", () => { delete document.documentElement.dataset.paper; resizeAll(); redrawAll(); });

const font = "12px system-ui, sans-serif";
function axis(label, more) {
  return {label, font, labelFont: font, labelSize: 18, labelGap: 0, stroke: paint("--quiet"), grid: {stroke: paint("--grid"), width: 1},
    ticks: {stroke: paint("--line"), width: 1, size: 4}, gap: 3, ...more};
}
const left_size = 46, bottom_size = 30, label_size = 18, top_padding = 8, right_padding = 14;

/// Puts a plot into `place`. `height(width)` in px of the page; `options` of uPlot besides size.
function plot(place, label, options, data, height) {
  place.setAttribute("role", "img");
  place.setAttribute("aria-label", label);
  const size = () => { const width = Math.max(200, place.clientWidth); return {width, height: height(width)}; };
  const drawn = new uPlot({...size(), legend: {show: false}, padding: [top_padding, right_padding, 0, 0],
    cursor: {show: false, drag: {x: false, y: false, setScale: false}}, ...options}, data, place);
  let last = place.clientWidth;
  drawings.push({redraw: () => drawn.redraw(), resize: () => { if (place.clientWidth !== last) { last = place.clientWidth; drawn.setSize(size()); } }});
  return drawn;
}

/// Plots over an image of a camera, with square pixels and v downwards. draw(pen, x, y, scale): x(u), y(v) in pixels
/// of the canvas; `scale`: canvas pixels in one pixel of the page. `probe(u, v)`: text about a place. `labels`: of
/// the axes, if this is not an image. `from`: numbers at the upper left corner, if they are not 0.
function imagePlot(place, label, camera, draw, probe, labels = ["u [px]", "v [px]"], from = null) {
  const ticks = axis => from ? {values: (_, numbers) => numbers.map(x => (x + from[axis]).toFixed(2))} : {};
  const hook = u => {
    const pen = u.ctx;
    pen.save();
    pen.beginPath();
    pen.rect(u.bbox.left, u.bbox.top, u.bbox.width, u.bbox.height);
    pen.clip();
    draw(pen, v => u.valToPos(v, "x", true), v => u.valToPos(v, "y", true), devicePixelRatio || 1);
    pen.restore();
  };
  const drawn = plot(place, label, {
    scales: {x: {time: false, range: () => [0, camera.width]}, y: {range: () => [0, camera.height], dir: -1}},
    axes: [axis(labels[0], {size: bottom_size, space: 60, ...ticks(0)}), axis(labels[1], {size: left_size, space: 40, ...ticks(1)})],
    series: [{}, {paths: () => null, points: {show: false}}],
    hooks: {draw: [hook]},
  }, [[0, camera.width], [0, camera.height]], width => {
    const inside = width - left_size - label_size - right_padding;
    return Math.round(Math.min(inside * camera.height / camera.width, 900) + bottom_size + label_size + top_padding);
  });
  if (!probe) return;
  const readout = el("div", {class: "readout", "aria-live": "off"}, "");
  place.after(readout);
  drawn.over.addEventListener("pointermove", event => {
    const box = drawn.over.getBoundingClientRect();
    readout.textContent = probe(drawn.posToVal(event.clientX - box.left, "x"), drawn.posToVal(event.clientY - box.top, "y"));
  });
  drawn.over.addEventListener("pointerleave", () => { readout.textContent = ""; });
}

/// Plots points and lines over x. series: {x, y, colour, kind: "points" | "line" | "dashes", hollow}.
function xyPlot(place, label, x_label, y_label, series, more = {}) {
  const joined = uPlot.join(series.map(s => [s.x, s.y]));
  const one = s => ({stroke: paint(s.colour), width: 2, spanGaps: true, dash: s.kind === "dashes" ? [6, 5] : undefined,
    paths: s.kind === "points" ? () => null : undefined,
    points: {show: s.kind === "points", size: s.size || 5, width: 1.4, stroke: paint(s.colour), fill: paint(s.hollow ? "--card" : s.colour)}});
  plot(place, label, {
    scales: {x: {time: false, distr: more.log_x ? 3 : 1, range: more.x_range}, y: {distr: more.log_y ? 3 : 1, range: more.y_range || ((u, low, high) => [0, (high || 1) * 1.08])}},
    axes: [axis(x_label, {size: bottom_size, ...more.x_axis}), axis(y_label, {size: left_size, ...more.y_axis})],
    series: [{}, ...series.map(one)],
  }, joined, () => more.height || 260);
}

// ---- maps

// Viridis (Nathaniel Smith, Stefan van der Walt, CC0): equally spaced stops.
const viridis = [[68, 1, 84], [72, 40, 120], [62, 74, 137], [49, 104, 142], [38, 130, 142], [31, 158, 137], [53, 183, 121], [110, 206, 88], [181, 222, 43], [253, 231, 37]];
function viridisAt(t) {
  const at = Math.min(1, Math.max(0, t)) * (viridis.length - 1), i = Math.min(viridis.length - 2, Math.floor(at));
  return viridis[i].map((c, k) => Math.round(c + (at - i) * (viridis[i + 1][k] - c)));
}
const rgb = colour => "rgb(" + colour.join(",") + ")";

/// Returns round levels around all values, as many as can be distinguished.
function levelsFor(values) {
  const all = values.filter(v => v !== null && v > 0);
  if (all.length === 0) return [0.1, 1];
  const low = Math.min(...all), high = Math.max(...all);
  for (const digits of [[1, 1.5, 2, 3, 5, 7], [1, 2, 5], [1, 3], [1]]) {
    const levels = [];
    for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high) + 1; ++power) levels.push(...digits.map(digit => Number((digit * 10 ** power).toPrecision(3))));
    const first = Math.max(0, levels.findLastIndex(level => level <= low)), last = levels.findIndex(level => level >= high);
    if (last - first <= 9 || digits.length === 1) return levels.slice(first, last + 1);
  }
}
const bandColour = (levels, band) => viridisAt((band + 0.5) / Math.max(1, levels.length - 1));

/// Returns the value between the nodes of a grid over the image; null if a node has none.
function interpolated(grid, camera, values, u, v) {
  const [columns, rows] = grid;
  const x = Math.min(columns - 1.001, Math.max(0, u / (camera.width - 1) * (columns - 1)));
  const y = Math.min(rows - 1.001, Math.max(0, v / (camera.height - 1) * (rows - 1)));
  const i = Math.floor(x), j = Math.floor(y), at = j * columns + i;
  const corners = [values[at], values[at + 1], values[at + columns], values[at + columns + 1]];
  if (corners.includes(null)) return null;
  const [a, b, c, d] = corners, s = x - i, t = y - j;
  return (a * (1 - s) + b * s) * (1 - t) + (c * (1 - s) + d * s) * t;
}

/// Draws bands of colour between levels, hatched if there is no value.
function drawMap(pen, x, y, scale, camera, values, levels) {
  const width = 320, height = Math.max(2, Math.round(width * camera.height / camera.width));
  const picture = document.createElement("canvas");
  picture.width = width;
  picture.height = height;
  const brush = picture.getContext("2d"), pixels = brush.createImageData(width, height);
  for (let j = 0, k = 0; j < height; ++j) {
    for (let i = 0; i < width; ++i, k += 4) {
      const value = interpolated(camera.grid, camera, values, (i + 0.5) / width * camera.width, (j + 0.5) / height * camera.height);
      if (value === null) continue;
      let band = 0;
      while (band < levels.length - 2 && value >= levels[band + 1]) ++band;
      const colour = bandColour(levels, band);
      for (let c = 0; c < 3; ++c) pixels.data[k + c] = colour[c];
      pixels.data[k + 3] = 255;
    }
  }
  brush.putImageData(pixels, 0, 0);
  hatch(pen, x(0), y(0), x(camera.width), y(camera.height), scale);
  pen.imageSmoothingEnabled = false;
  pen.drawImage(picture, x(0), y(0), x(camera.width) - x(0), y(camera.height) - y(0));
}
function hatch(pen, x0, y0, x1, y1, scale) {
  pen.strokeStyle = css("--line");
  pen.lineWidth = scale;
  pen.beginPath();
  for (let d = x0 - (y1 - y0); d < x1; d += 8 * scale) { pen.moveTo(d, y1); pen.lineTo(d + (y1 - y0), y0); }
  pen.stroke();
}
function mapLegend(levels, unit) {
  const bands = levels.slice(0, -1).map((level, band) =>
    el("span", {}, el("i", {style: "background:" + rgb(bandColour(levels, band))}), number(level, 2) + "–" + number(levels[band + 1], 2)));
  return el("div", {class: "legend"}, ...bands, el("span", {}, unit));
}
