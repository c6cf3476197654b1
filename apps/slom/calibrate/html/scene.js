// Boards and cameras in space, drawn on a canvas, far objects first. The user can turn the view.

class Scene {
  /// data: the data of the page.
  constructor(place, data) {
    this.data = data;
    this.canvas = el("canvas", {class: "scene", tabindex: "0", role: "img",
      "aria-label": "Boards and cameras in space. Arrow keys turn, plus and minus zoom, 0 starts again."});
    this.modes = [el("button", {type: "button", onclick: () => this.show("camera")}, "Cameras stand still"),
      el("button", {type: "button", onclick: () => this.show("board")}, "Board stands still")];
    const tool = (label, text, act) => el("button", {type: "button", "aria-label": label, title: label, onclick: () => { act(); this.redraw(); }}, text);
    place.append(el("div", {class: "tools"}, ...this.modes, tool("Zoom in", "+", () => this.zoom(1.2)), tool("Zoom out", "−", () => this.zoom(1 / 1.2)),
      tool("Start again", "Reset", () => this.home())), this.canvas);
    this.pen = this.canvas.getContext("2d");
    this.fingers = new Map();
    this.listen();
    this.show("camera");
    drawings.push({redraw: () => this.redraw(), resize: () => this.redraw()});
  }

  /// Shows everything, seen from the side and above.
  home() { Object.assign(this, {turn: this.mode === "camera" ? 0.75 : 0.5, tilt: this.mode === "camera" ? 0.42 : 0.5, closer: 1, x: 0, y: 0, is_home: true}); }
  fit() {
    Object.assign(this, {closer: 1, x: 0, y: 0});
    for (let step = 0; step < 2; ++step) {
      const seen = this.points.map(p => this.project(p)), range = i => [Math.min(...seen.map(p => p[i])), Math.max(...seen.map(p => p[i]))];
      const [left, right] = range(0), [top, bottom] = range(1);
      const factor = step === 0 ? 0.88 * Math.min(this.canvas.width / (right - left), this.canvas.height / (bottom - top)) : 1;
      this.closer *= factor;
      this.x += this.canvas.width / 2 - (left + right) / 2;
      this.y += this.canvas.height / 2 - (top + bottom) / 2;
      if (step === 0) { this.x *= factor; this.y *= factor; }
    }
  }
  zoom(factor) {
    const closer = Math.max(0.1, Math.min(50, this.closer * factor));
    this.x *= closer / this.closer;
    this.y *= closer / this.closer;
    this.closer = closer;
    this.is_home = false;
  }
  show(mode) {
    this.mode = mode;
    this.modes.forEach((button, i) => button.setAttribute("aria-pressed", String((i === 0) === (mode === "camera"))));
    this.build();
    this.home();
    this.redraw();
  }

  // ---- the objects, in axes with y up
  build() {
    const data = this.data, boards = data.images.list.filter(image => image.pose);
    const corners = [0, 3, 6, 9].map(i => data.board.slice(i, i + 3));
    const quads = boards.map(image => corners.map(p => backward(image.pose, p)));
    const depth = 0.28 * median(quads.map(q => Math.hypot(...mean(q))));
    const usual = median(data.images.list.map(image => image.chi2));
    this.shapes = [];
    this.points = [];
    const is_above = median(boards.map(image => image.pose[11])) > 0;
    const axes = this.mode === "camera" ? p => [p[0], -p[1], -p[2]] : is_above ? p => [p[0], p[2], -p[1]] : p => [p[0], -p[2], p[1]];
    const add = shape => { shape.points = shape.points.map(axes); this.shapes.push(shape); this.points.push(...shape.points); };
    const is_bad = image => image.chi2 > 3 * usual;
    if (this.mode === "camera") {
      boards.forEach((image, k) => add({points: quads[k], closed: true, colour: is_bad(image) ? "--orange" : "--blue", label: boards.length <= 40 || is_bad(image) ? String(image.image) : "", bold: is_bad(image)}));
      data.cameras.forEach(camera => this.addCamera(add, camera, depth, p => backward(camera.pose, p), camera.name));
    } else {
      add({points: corners, closed: true, colour: "--blue", label: "board", bold: true});
      boards.forEach(image => data.cameras.forEach((camera, c) => {
        if (image.rms[c] === null) return;
        this.addCamera(add, camera, depth * 0.5, p => forward(image.pose, backward(camera.pose, p)), c === 0 && boards.length <= 40 ? String(image.image) : "", is_bad(image));
      }));
    }
    this.centre = mean(this.points);
    const distances = this.points.map(p => Math.hypot(...p.map((x, i) => x - this.centre[i]))).sort((a, b) => a - b);
    this.size = distances[Math.floor(0.97 * (distances.length - 1))] || 1;
  }
  /// Adds a pyramid from the centre of projection to the image, `depth` before it.
  addCamera(add, camera, depth, place, label, is_bad) {
    const [fx, fy, cx, cy] = camera.pinhole;
    const corner = (u, v) => place([(u - cx) / fx * depth, (v - cy) / fy * depth, depth]);
    const frame = [corner(0, 0), corner(camera.width, 0), corner(camera.width, camera.height), corner(0, camera.height)];
    const top = place([0, 0, 0]), colour = is_bad ? "--orange" : this.mode === "camera" ? "--green" : "--purple";
    add({points: frame.map(p => [...p]), closed: true, colour, label: ""});
    frame.forEach(p => add({points: [[...top], [...p]], colour, label: ""}));
    add({points: [[...top]], colour, label, bold: this.mode === "camera"});
  }

  // ---- the projection
  project(p) {
    const q = p.map((x, i) => x - this.centre[i]);
    const c = Math.cos(this.turn), s = Math.sin(this.turn), ct = Math.cos(this.tilt), st = Math.sin(this.tilt);
    const x = c * q[0] - s * q[2], z = s * q[0] + c * q[2];
    const y = ct * q[1] - st * z, towards = st * q[1] + ct * z;
    const eye = 3.2 * this.size, scale = this.closer * 1.25 * Math.min(this.canvas.width, this.canvas.height) / (eye - Math.min(towards, 0.9 * eye));
    return [this.canvas.width / 2 + this.x + scale * x, this.canvas.height / 2 + this.y - scale * y, towards];
  }
  redraw() {
    if (this.is_waiting) return;
    this.is_waiting = true;
    requestAnimationFrame(() => { this.is_waiting = false; this.draw(); });
  }
  draw() {
    const ratio = devicePixelRatio || 1, width = Math.round(this.canvas.clientWidth * ratio), height = Math.round(this.canvas.clientHeight * ratio);
    if (this.canvas.width !== width || this.canvas.height !== height) { this.canvas.width = width; this.canvas.height = height; }
    if (this.is_home) this.fit();
    const pen = this.pen;
    pen.clearRect(0, 0, width, height);
    const seen = this.shapes.map(shape => ({shape, at: shape.points.map(p => this.project(p))}));
    for (const item of seen) item.depth = item.at.reduce((sum, p) => sum + p[2], 0) / item.at.length;
    seen.sort((a, b) => a.depth - b.depth);
    for (const {shape, at} of seen) {
      pen.beginPath();
      at.forEach(([x, y], i) => i === 0 ? pen.moveTo(x, y) : pen.lineTo(x, y));
      if (shape.closed) pen.closePath();
      pen.strokeStyle = pen.fillStyle = css(shape.colour);
      if (shape.closed) { pen.globalAlpha = 0.1; pen.fill(); }
      pen.globalAlpha = 0.9;
      pen.lineWidth = (shape.bold ? 2.2 : 1.2) * ratio;
      pen.stroke();
      pen.globalAlpha = 1;
    }
    pen.textAlign = "center";
    for (const {shape, at} of seen) {
      if (!shape.label) continue;
      const [x, y] = mean(at);
      pen.font = (shape.bold ? "600 " : "") + 12 * ratio + "px system-ui, sans-serif";
      pen.lineWidth = 3 * ratio;
      pen.strokeStyle = css("--card");
      pen.fillStyle = css("--ink");
      const below = shape.points.length === 1 ? -8 * ratio : 4 * ratio;
      pen.strokeText(shape.label, x, y + below);
      pen.fillText(shape.label, x, y + below);
    }
  }

  // ---- mouse, pen, fingers (two zoom and move) and keys
  listen() {
    const canvas = this.canvas;
    canvas.addEventListener("pointerdown", e => {
      canvas.setPointerCapture(e.pointerId);
      this.fingers.set(e.pointerId, [e.clientX, e.clientY]);
    });
    for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, e => this.fingers.delete(e.pointerId));
    canvas.addEventListener("pointermove", e => this.drag(e));
    canvas.addEventListener("wheel", e => {
      if (!e.ctrlKey && document.activeElement !== canvas) return;  // the page scrolls until the picture is clicked
      e.preventDefault();
      this.zoom(Math.exp(-e.deltaY * (e.deltaMode === 1 ? 0.05 : 0.0015)));
      this.redraw();
    }, {passive: false});
    canvas.addEventListener("keydown", e => this.press(e));
  }
  rotate(dx, dy) {
    this.is_home = false;
    this.turn += dx;
    this.tilt = Math.max(-1.57, Math.min(1.57, this.tilt + dy));
  }
  drag(e) {
    const finger = this.fingers.get(e.pointerId);
    if (!finger) return;
    const dx = e.clientX - finger[0], dy = e.clientY - finger[1], ratio = devicePixelRatio || 1;
    if (this.fingers.size === 2) {
      const other = [...this.fingers].find(([id]) => id !== e.pointerId)[1];
      const before = Math.hypot(finger[0] - other[0], finger[1] - other[1]), after = Math.hypot(e.clientX - other[0], e.clientY - other[1]);
      if (before > 0) this.zoom(after / before);
    }
    if (this.fingers.size === 2 || e.shiftKey) { this.x += dx * ratio; this.y += dy * ratio; this.is_home = false; }
    else this.rotate(dx * 0.008, dy * 0.008);
    finger[0] = e.clientX;
    finger[1] = e.clientY;
    this.redraw();
  }
  press(e) {
    const arrows = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1]};
    if (arrows[e.key]) {
      const [x, y] = arrows[e.key];
      if (e.shiftKey) { this.x += 20 * x; this.y += 20 * y; this.is_home = false; } else this.rotate(0.07 * x, 0.07 * y);
    } else if (e.key === "+" || e.key === "=") this.zoom(1.15);
    else if (e.key === "-") this.zoom(1 / 1.15);
    else if (e.key === "0") this.home();
    else return;
    e.preventDefault();
    this.redraw();
  }
}

// A pose is 9 numbers of the rotation row by row, then the translation.
function forward(T, p) { return [0, 1, 2].map(i => T[3 * i] * p[0] + T[3 * i + 1] * p[1] + T[3 * i + 2] * p[2] + T[9 + i]); }
function backward(T, p) {
  const d = p.map((x, i) => x - T[9 + i]);
  return [0, 1, 2].map(i => T[i] * d[0] + T[3 + i] * d[1] + T[6 + i] * d[2]);
}
function mean(points) { return points[0].map((_, i) => points.reduce((sum, p) => sum + p[i], 0) / points.length); }
function median(values) { const sorted = [...values].sort((a, b) => a - b); return sorted[Math.floor(sorted.length / 2)]; }
