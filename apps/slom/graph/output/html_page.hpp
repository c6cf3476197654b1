// The page around the data of toHtml: style, canvas, and the program that draws.
#pragma once

namespace slom::app::graph {

inline constexpr const char* page_before_data = R"page(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>Pose graph</title>
<style>
  :root { color-scheme: light dark; --page: #fff; --ink: #444; --path: #1f5fa8; --edge: #d9822b; --mark: #3a8f4d; --fixed: #b3261e }
  @media (prefers-color-scheme: dark) {
    :root { --page: #16181c; --ink: #bbb; --path: #7ab4f5; --edge: #e0a05a; --mark: #79c98b; --fixed: #ff8a80 }
  }
  html, body { margin: 0; height: 100%; background: var(--page); color: var(--ink); font: 14px sans-serif }
  canvas { display: block; width: 100%; height: 100%; touch-action: none; outline-offset: -2px }
  #legend { position: fixed; top: 12px; left: 14px; pointer-events: none }
  #legend label { display: block; margin-top: 4px; pointer-events: auto }
  #legend i { display: inline-block; width: 18px; border-top: 3px solid; margin: 0 4px 4px 0 }
  #help { position: fixed; bottom: 10px; left: 14px; right: 14px; pointer-events: none }
  #time { position: fixed; bottom: 52px; left: 14px; right: 14px; display: flex; gap: 10px; align-items: center }
  #time[hidden] { display: none }
  #time input { flex: 1; min-width: 0; accent-color: var(--path) }
  #time button { width: 34px; height: 26px; font-size: 14px; color: inherit; background: var(--page); border: 1px solid; border-radius: 4px }
  #time output { min-width: 7em; text-align: right; font-variant-numeric: tabular-nums }
</style>
</head>
<body>
<canvas id="view" tabindex="0" aria-label="Pose graph; arrow keys turn it, plus and minus zoom, 0 starts again"></canvas>
<div id="legend"><b id="name"></b></div>
<div id="time" hidden><button id="play" aria-label="play">&#9654;</button><input id="at" type="range" min="0" value="0" aria-label="how far the map has grown"><output id="pose"></output></div>
<div id="help">drag or arrow keys: turn &middot; wheel, pinch or + and -: zoom &middot; shift or two fingers: move &middot; 0: start again</div>
<script>
const data = )page";

inline constexpr const char* page_after_data = R"page(;
const canvas = document.getElementById("view"), pen = canvas.getContext("2d");
const home = { turn: data.flat ? 0 : -0.6, tilt: data.flat ? 0 : 1.05, zoom: 1, x: 0, y: 0 };
let view = { ...home }, waiting = false;

// The layers from back to front, each with a box in the legend.
const layers = [
  { kind: "edge", label: "loop closures", count: data.closures.length / 2, draw: () => lines(data.closures, 0.7) },
  { kind: "path", label: "path", count: data.path.length / 2, draw: () => lines(data.path, 1.6) },
  { kind: "mark", label: "landmarks", count: data.landmarks.length / 3, draw: () => dots(places.landmarks.subarray(0, now.landmarks.length / 3 * 2), 2) },
  { kind: "fixed", label: "fixed", count: data.fixed.length, draw: rings },
].filter(layer => layer.count > 0);

document.title = data.name;
document.getElementById("name").textContent = data.name + ", " + data.poses.length / 3 + " poses";
for (const layer of layers) {
  const label = document.createElement("label"), box = document.createElement("input"), stroke = document.createElement("i");
  box.type = "checkbox";
  box.checked = layer.shown = true;
  box.onchange = () => { layer.shown = box.checked; redraw(); };
  stroke.style.color = "var(--" + layer.kind + ")";
  label.append(box, stroke, layer.label + " (" + layer.count + ")");
  document.getElementById("legend").append(label);
}

// What is shown: the whole map, or how far it has grown.
let now = data;
// Places on the screen: x, y of one point after the other.
const places = { poses: new Float32Array(data.poses.length / 3 * 2), landmarks: new Float32Array(data.landmarks.length / 3 * 2) };
function project(from, to) {
  const scale = view.zoom * Math.min(canvas.width, canvas.height) * 0.46 / 1e5;
  const c = Math.cos(view.turn), s = Math.sin(view.turn), ct = Math.cos(view.tilt), st = Math.sin(view.tilt);
  const x0 = canvas.width / 2 + view.x, y0 = canvas.height / 2 + view.y;
  for (let i = 0, k = 0; i < from.length; i += 3, k += 2) {
    const x = c * from[i] - s * from[i + 1], y = s * from[i] + c * from[i + 1];
    to[k] = x0 + scale * x;
    to[k + 1] = y0 - scale * (ct * y + st * from[i + 2]);
  }
}
function lines(pairs, width) {
  const p = places.poses, poses = now.poses.length / 3;
  pen.lineWidth = width * devicePixelRatio;
  for (let first = 0; first < pairs.length; first += 20000) {  // long paths are slow to stroke
    pen.beginPath();
    for (let i = first; i < Math.min(first + 20000, pairs.length); i += 2) {
      if (pairs[i + 1] >= poses) continue;  // the second one is the later one
      pen.moveTo(p[2 * pairs[i]], p[2 * pairs[i] + 1]);
      pen.lineTo(p[2 * pairs[i + 1]], p[2 * pairs[i + 1] + 1]);
    }
    pen.stroke();
  }
}
function dots(p, radius) {
  const r = radius * devicePixelRatio;
  for (let i = 0; i < p.length; i += 2) pen.fillRect(p[i] - r, p[i + 1] - r, 2 * r, 2 * r);
}
function rings() {
  pen.lineWidth = 2 * devicePixelRatio;
  for (const pose of data.fixed) {
    if (pose >= now.poses.length / 3) continue;
    pen.beginPath();
    pen.arc(places.poses[2 * pose], places.poses[2 * pose + 1], 5 * devicePixelRatio, 0, 7);
    pen.stroke();
  }
}
function draw() {
  waiting = false;
  const width = Math.round(canvas.clientWidth * devicePixelRatio), height = Math.round(canvas.clientHeight * devicePixelRatio);
  if (canvas.width !== width || canvas.height !== height) { canvas.width = width; canvas.height = height; }
  pen.clearRect(0, 0, width, height);
  project(now.poses, places.poses);
  project(now.landmarks, places.landmarks);
  const style = getComputedStyle(document.documentElement);
  for (const layer of layers) {
    if (!layer.shown) continue;
    pen.strokeStyle = pen.fillStyle = style.getPropertyValue("--" + layer.kind);
    pen.globalAlpha = layer.kind === "edge" ? 0.6 : 1;
    layer.draw();
  }
}
function redraw() {
  if (!waiting) requestAnimationFrame(draw);
  waiting = true;
}

function turn(dx, dy) {
  view.turn += dx;
  view.tilt = Math.max(0, Math.min(Math.PI, view.tilt + dy));
  redraw();
}
function move(dx, dy) {
  view.x += dx * devicePixelRatio;
  view.y += dy * devicePixelRatio;
  redraw();
}
/// About the place (x, y) of the window.
function zoom(factor, x, y) {
  const f = Math.max(0.1, Math.min(1000, view.zoom * factor)) / view.zoom;
  const px = x * devicePixelRatio - canvas.width / 2, py = y * devicePixelRatio - canvas.height / 2;
  view.zoom *= f;
  view.x = px + f * (view.x - px);
  view.y = py + f * (view.y - py);
  redraw();
}

// Mouse, pen and fingers: one turns, two move and zoom.
const fingers = new Map();
canvas.addEventListener("pointerdown", e => {
  canvas.setPointerCapture(e.pointerId);
  fingers.set(e.pointerId, { x: e.clientX, y: e.clientY });
});
for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, e => fingers.delete(e.pointerId));
canvas.addEventListener("pointermove", e => {
  const finger = fingers.get(e.pointerId);
  if (!finger) return;
  const dx = e.clientX - finger.x, dy = e.clientY - finger.y;
  if (fingers.size === 2) {
    const other = [...fingers].find(([id]) => id !== e.pointerId)[1];
    const before = Math.hypot(finger.x - other.x, finger.y - other.y), after = Math.hypot(e.clientX - other.x, e.clientY - other.y);
    if (before > 0) zoom(after / before, (e.clientX + other.x) / 2, (e.clientY + other.y) / 2);
    move(dx / 2, dy / 2);
  } else if (e.shiftKey || e.buttons & 6) {
    move(dx, dy);
  } else {
    turn(dx * 0.008, -dy * 0.008);
  }
  finger.x = e.clientX;
  finger.y = e.clientY;
});
canvas.addEventListener("wheel", e => {
  e.preventDefault();
  zoom(Math.exp(-e.deltaY * (e.deltaMode === 1 ? 0.05 : 0.0015)), e.clientX, e.clientY);
}, { passive: false });
canvas.addEventListener("contextmenu", e => e.preventDefault());

// Time, where the map was fed pose by pose.
const slider = document.getElementById("at"), play = document.getElementById("play");
let timer = 0;
function show(frame) {
  now = data.frames[frame];
  slider.value = frame;
  document.getElementById("pose").textContent = "pose " + now.pose;
  redraw();
}
function stop() {
  clearInterval(timer);
  timer = 0;
  play.textContent = "\u25b6";
  play.setAttribute("aria-label", "play");
}
function start() {
  let frame = +slider.value < data.frames.length - 1 ? +slider.value : -1;
  timer = setInterval(() => {
    show(++frame);
    if (frame === data.frames.length - 1) stop();
  }, Math.max(40, 6000 / data.frames.length));
  play.textContent = "\u23f8";
  play.setAttribute("aria-label", "pause");
}
if (data.frames.length > 0) {
  document.getElementById("time").hidden = false;
  slider.max = data.frames.length - 1;
  slider.oninput = () => { stop(); show(+slider.value); };
  play.onclick = () => timer ? stop() : start();
  show(data.frames.length - 1);
}

addEventListener("keydown", e => {
  if (e.target === slider || e.target === play) return;
  const step = 0.06, middle = [canvas.clientWidth / 2, canvas.clientHeight / 2];
  const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
  if (arrows[e.key]) {
    const [x, y] = arrows[e.key];
    e.shiftKey ? move(20 * x, 20 * y) : turn(step * x, -step * y);
  } else if (e.key === "+" || e.key === "=") {
    zoom(1.15, ...middle);
  } else if (e.key === "-") {
    zoom(1 / 1.15, ...middle);
  } else if (e.key === "0") {
    view = { ...home };
    redraw();
  } else {
    return;
  }
  e.preventDefault();
});
addEventListener("resize", redraw);
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
redraw();
</script>
</body>
</html>
)page";

}  // namespace slom::app::graph
