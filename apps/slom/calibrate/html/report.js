// The sections of the report, from the data in the page.
const data = JSON.parse(document.getElementById("data").textContent);
const report = document.getElementById("report");
const several = data.cameras.length > 1;
const titleOf = camera => several ? "Camera " + camera.name : "";

/// Adds a section and returns it.
function section(id, title, ...content) {
  const made = el("section", {id, "aria-labelledby": id + "-title"}, el("h2", {id: id + "-title"}, title), ...content);
  report.append(made);
  document.getElementById("contents").append(el("a", {href: "#" + id}, title));
  return made;
}
/// Adds a figure to `place`: title, the plot's own place, legend, caption. fill(place) draws once the figure is in
/// the page.
function figure(place, title, caption, fill, ...legend) {
  const canvas = el("div", {class: "plot"});
  place.append(el("figure", {}, title ? el("h3", {}, title) : null, canvas, ...legend, caption ? el("figcaption", {}, caption) : null));
  fill(canvas);
}
const key = (colour, text, kind = "") => el("span", {}, el("i", {class: kind, style: (kind ? "border-color" : "background") + ":var(" + colour + ")"}), text);
const legendOf = (...keys) => el("div", {class: "legend"}, ...keys);
const sizeNote = camera => camera.size_is_assumed
  ? ` The image size, ${camera.width} x ${camera.height} px, is assumed; pass --image-size to state it.` : "";
const distanceText = distance => distance === null ? "at infinity" : "at " + number(distance) + " m";

function head() {
  const levels = {failed: ["✕", "Failed"], doubtful: ["!", "Look closer"], trustworthy: ["✓", "Trustworthy"]}, order = Object.keys(levels);
  const all = [{of: "Cameras", ...data.verdict}, ...(data.streams ? [{of: "IMU", ...data.streams.verdict}] : [])]
    .sort((a, b) => order.indexOf(a.level) - order.indexOf(b.level));  // the worst comes first
  const [mark, words] = levels[all[0].level], verdict = document.getElementById("verdict");
  verdict.className = all[0].level;
  verdict.append(el("span", {class: "mark", "aria-hidden": "true"}, mark));
  for (const one of all) {
    const text = levels[one.level][1] + ". " + one.sentence;
    verdict.append(el(one === all[0] ? "h1" : "p", {}, all.length > 1 ? one.of + ": " + text : text));
    const doubts = one.doubts.slice(one.level === "failed" ? 0 : 1);
    if (doubts.length) verdict.append(el("ul", {}, ...doubts.map(doubt => el("li", {}, doubt[0].toUpperCase() + doubt.slice(1) + "."))));
  }
  document.title = words + ": calibration of " + data.cameras.map(camera => camera.name).join(", ");

  const corners = data.cameras.reduce((sum, camera) => sum + camera.corners, 0);
  const tile = (name, value, unit) => el("div", {}, el("dt", {}, name), el("dd", {}, value, el("small", {}, unit ? " " + unit : "")));
  const largest = figure => Math.max(...data.cameras.map(camera => camera.projection[0][figure]));
  document.getElementById("figures").append(...[
    tile("Reprojection RMS", number(data.rms, 3), "px"),
    tile("Images", String(data.images.list.length), ""),
    tile("Corners", corners.toLocaleString("en"), ""),
    tile("χ² per d.o.f., expected 1", number(data.chi2_per_dof, 3), ""),
    data.is_assessed ? tile("Projection, middle", number(largest("middle")), "px") : null,
    data.is_assessed ? tile("Projection, worst place", number(largest("worst")), "px") : null,
  ].filter(made => made));
}

function parameters() {
  const header = ["", "value", "stated", "clustered", "unit"], row = el("div", {class: "row"});
  const reference = data.cameras[0].name;
  for (const camera of data.cameras) {
    const card = el("div", {}, el("h3", {}, `Camera ${camera.name}, ${camera.model}`),
      el("p", {class: "quiet"}, `${plural(camera.images, "image")}, ${plural(camera.corners, "corner")}, RMS ${number(camera.rms, 3)} px` +
        (camera.rms_alone ? ` (alone ${number(camera.rms_alone, 3)} px)` : "")),
      table("Lens of " + camera.name, header, camera.parameters));
    if (camera.placement) card.append(table(`From ${reference} to ${camera.name}: p_${camera.name} = R p_${reference} + t`, header, camera.placement));
    row.append(card);
  }
  if (data.imu) {
    row.append(el("div", {}, el("h3", {}, "IMU"), el("p", {class: "quiet"}, `${plural(data.imu.readings, "reading")}, RMS ${number(data.imu.rms, 3)} m/s²`),
      table(`Bias and gravity; rotation from ${reference} to the IMU`, header, data.imu.parameters)));
  }
  section("parameters", "Parameters",
    el("p", {class: "quiet"}, data.success ? `Stated standard deviations assume independent noise of corners, ${number(data.sigma_px)} px in u and in v` +
      (data.imu ? `, and of readings, ${number(data.sigma_acc)} m/s².` : ".") +
      " Clustered ones allow for errors shared within an image, by successive images, and at a corner of the board. If they are larger, trust them." : "The fit failed: these are its last values, not a calibration."),
    row, data.notes.length ? el("div", {}, el("h3", {}, "Notes"), el("ul", {}, ...data.notes.map(note => el("li", {}, note)))) : null);
}

function fit() {
  const images = data.images.list;
  const made = section("fit", "Fit by image",
    el("p", {}, `RMS distance between found and predicted corners. If an image lies far above the others, its corners were found badly, it was blurred, or its number is wrong.`));
  const series = data.cameras.map((camera, c) => {
    const seen = images.filter(image => image.rms[c] !== null);
    return {x: seen.map(image => image.image), y: seen.map(image => image.rms[c]), colour: colourOf(c), kind: "points", hollow: c % 2 === 1, size: images.length > 100 ? 4 : 8};
  });
  const first = images[0].image, last = images[images.length - 1].image;
  figure(made, "", "", place => xyPlot(place, "RMS of each image by its number", "image", "RMS [px]", series,
    {x_range: () => [first - Math.max(0.5, (last - first) * 0.02), last + Math.max(0.5, (last - first) * 0.02)], x_axis: {incrs: [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000]}}),
    legendOf(...data.cameras.map((camera, c) => key(colourOf(c), `${camera.name}: RMS of all ${number(camera.rms, 3)} px`))));
  const shown = [...images].sort((a, b) => b.chi2 - a.chi2).slice(0, data.images.rows);
  made.append(folded("Table of images, the worst first" + (shown.length < images.length ? ` (${shown.length} of ${images.length})` : ""),
    table("RMS [px], and chi-square per measurement (expected: 1)", ["image", ...data.cameras.map(camera => camera.name), "χ² per measurement"],
      shown.map(image => [image.image, ...image.rms.map(rms => number(rms, 3)), number(image.chi2, 3)]))));
}

// ---- residuals

function residualsOf(camera) {
  const list = [], n = camera.residuals.numbers;
  for (let i = 0; i < n.length; i += 4) list.push({u: n[i], v: n[i + 1], du: n[i + 2], dv: n[i + 3], size: Math.hypot(n[i + 2], n[i + 3])});
  return list;
}
const niceNumber = x => { const power = 10 ** Math.floor(Math.log10(x)); return [5, 2, 1].find(digit => digit * power <= x * 1.0001) * power; };

function residualVectors(row, camera, list) {
  const far_off = 4 * camera.rms, magnified = niceNumber(Math.min(1000, Math.max(1, 0.035 * camera.width / (camera.rms || 1))));
  const every = camera.residuals.every;
  figure(row, titleOf(camera), `Lines from the found corner, away from the predicted one, magnified ${magnified} times.` +
    (every > 1 ? ` One corner in ${every} is drawn.` : "") + sizeNote(camera),
    place => imagePlot(place, `Residual vectors over the image of ${camera.name}, ${magnified} times magnified`, camera, (pen, x, y, scale) => {
      for (const is_far of [false, true]) {
        pen.strokeStyle = pen.fillStyle = css(is_far ? "--orange" : "--blue");
        pen.globalAlpha = is_far || list.length < 1500 ? 0.9 : 0.55;
        pen.lineWidth = (is_far ? 2.4 : 1.1) * scale;
        pen.beginPath();
        for (const r of list) {
          if ((r.size > far_off) !== is_far) continue;
          pen.moveTo(x(r.u), y(r.v));
          pen.lineTo(x(r.u + magnified * r.du), y(r.v + magnified * r.dv));
        }
        pen.stroke();
        for (const r of list) {
          if ((r.size > far_off) === is_far) pen.fillRect(x(r.u) - 1.2 * scale, y(r.v) - 1.2 * scale, 2.4 * scale, 2.4 * scale);
        }
      }
      pen.globalAlpha = 1;
    }), legendOf(key("--blue", "residual", "line"), key("--orange", `longer than 4 times the RMS, ${number(far_off)} px: ${list.filter(r => r.size > far_off).length}`, "line")));
}

function residualsByRadius(row, camera, list) {
  const [, , cx, cy] = camera.pinhole;
  const points = list.map(r => [Math.hypot(r.u - cx, r.v - cy), r.size]).sort((a, b) => a[0] - b[0]);
  const bins = Math.max(3, Math.min(12, Math.floor(points.length / 20))), middle = {x: [], y: []};
  for (let b = 0; b < bins; ++b) {  // the same number of corners in each
    const part = points.slice(Math.floor(b * points.length / bins), Math.floor((b + 1) * points.length / bins));
    if (part.length === 0) continue;
    middle.x.push(part[Math.floor(part.length / 2)][0]);
    middle.y.push(Math.sqrt(part.reduce((sum, p) => sum + p[1] * p[1], 0) / part.length));
  }
  const end = points.length ? points[points.length - 1][0] : 1, stated = Math.SQRT2 * data.sigma_px;
  figure(row, titleOf(camera), "If the orange line rises outwards, the model does not match the lens.",
    place => xyPlot(place, `Size of residuals of ${camera.name} by distance from the optical axis`, "distance from the optical axis [px]", "residual [px]", [
      {x: points.map(p => p[0]), y: points.map(p => p[1]), colour: "--blue", kind: "points", size: 3},
      {...middle, colour: "--orange", kind: "line"},
      {x: [0, end], y: [stated, stated], colour: "--green", kind: "dashes"},
    ], {x_range: () => [0, end * 1.02]}),
    legendOf(key("--blue", "corner"), key("--orange", "RMS at this distance", "line"), key("--green", `expected from the stated noise, ${number(stated)} px`, "dashes")));
}

function coverage(row, camera) {
  const {columns, rows, counts} = camera.coverage, most = Math.max(1, ...counts), empty = counts.filter(n => n === 0).length;
  figure(row, titleOf(camera), `${empty} of ${counts.length} cells hold no corner.` + sizeNote(camera),
    place => imagePlot(place, `Number of corners in each part of the image of ${camera.name}`, camera, (pen, x, y, scale) => {
      hatch(pen, x(0), y(0), x(camera.width), y(camera.height), scale);
      const w = camera.width / columns, h = camera.height / rows;
      pen.textAlign = "center";
      pen.textBaseline = "middle";
      pen.font = 11 * scale + "px system-ui, sans-serif";
      counts.forEach((count, i) => {
        if (count === 0) return;
        const u = i % columns * w, v = Math.floor(i / columns) * h, t = Math.sqrt(count / most);
        pen.fillStyle = rgb(viridisAt(t));
        pen.fillRect(x(u), y(v), x(u + w) - x(u) + 0.5, y(v + h) - y(v) + 0.5);
        pen.fillStyle = t > 0.62 ? "#111" : "#fff";
        if (x(w) - x(0) > 24 * scale) pen.fillText(String(count), x(u + w / 2), y(v + h / 2));
      });
    }));
}

function residuals() {
  const lists = data.cameras.map(residualsOf);
  const row = draw => { const made = el("div", {class: "row"}); return {made, fill: () => data.cameras.forEach((camera, c) => draw(made, camera, lists[c]))}; };
  const vectors = row(residualVectors), radius = row(residualsByRadius), cover = row(coverage);
  const made = section("residuals", "Residuals over the image",
    el("p", {}, "Good residuals have no pattern: neighbours point in any direction. If neighbours point the same way in many images, the model does not fit the lens, or the board is not flat."),
    vectors.made, radius.made);
  vectors.fill();
  radius.fill();
  made.append(folded("Table", table("Corners and their residuals", ["camera", "corners", "RMS [px]", "RMS in u [px]", "RMS in v [px]"], data.cameras.map((camera, c) => {
    const rms = name => Math.sqrt(lists[c].reduce((sum, r) => sum + r[name] ** 2, 0) / lists[c].length);
    return [camera.name, camera.corners, number(camera.rms, 3), number(rms("du"), 3), number(rms("dv"), 3)];
  }))));
  section("coverage", "Coverage of the image by corners", el("p", {}, "Hatched: no image has a corner there, so the lens is extrapolated."), cover.made);
  cover.fill();
}

function space() {
  const every = data.images.boards_every;
  const made = section("space", "Boards and cameras in space", el("p", {class: "quiet"},
    "Drag or use the arrow keys to turn. Use the wheel, two fingers, + or − to zoom. Hold shift to move. The numbers are image numbers. Orange images have more than three times the usual chi-square." +
    (every > 1 ? ` One image in ${every} is drawn.` : "")));
  const holder = el("figure", {});
  made.append(holder);
  new Scene(holder, data);
  const placed = data.images.list.filter(image => image.pose);
  made.append(folded("Table of places", table(`Where camera ${data.cameras[0].name} stood before the board [m]`, ["image", "x", "y", "z"],
    placed.map(image => [image.image, ...image.pose.slice(9).map(x => x.toFixed(3))]))));
}

// ---- board

function board() {
  const fitted = data.fitted_board;
  if (!fitted) return;
  const corners = fitted.corners.map(([id, x, y, dx, dy, dz, std]) => ({id, x, y, dx, dy, dz, std}));
  const side = Math.sqrt(fitted.width * fitted.height / corners.length), margin = side;
  const frame = {width: fitted.width + 2 * margin, height: fitted.height + 2 * margin};
  const largest = Math.max(1e-9, ...corners.map(c => Math.hypot(c.dx, c.dy))), highest = Math.max(1e-9, ...corners.map(c => Math.abs(c.dz)));
  const magnified = niceNumber(Math.max(1, 0.8 * side / largest));
  const made = section("board", "Shape of the board", el("p", {},
    fitted.shape === "bent" ? `The board was fitted with a bend. Its corners are ${number(fitted.off_plane)} mm off the plane (RMS).` :
      `Each corner was fitted. The RMS distance from the stated positions is ${number(fitted.off_plane)} mm off the plane and ${number(fitted.within_plane)} mm within it along each axis.`));
  figure(made, "", `Discs: height over the plane, up to ${number(highest)} mm for the largest disc. Lines: from the stated to the fitted corner, magnified ${magnified} times.`,
    place => imagePlot(place, `Corners of the board, and their distances from the stated positions`, frame, (pen, x, y, scale) => {
      const disc = 0.42 * Math.abs(x(side) - x(0));
      for (const c of corners) {
        pen.beginPath();
        pen.fillStyle = css(c.dz > 0 ? "--orange" : "--blue");
        pen.globalAlpha = 0.75;
        pen.arc(x(c.x + margin), y(c.y + margin), Math.max(1.2 * scale, disc * Math.sqrt(Math.abs(c.dz) / highest)), 0, 2 * Math.PI);
        pen.fill();
      }
      pen.globalAlpha = 1;
      pen.strokeStyle = css("--ink");
      pen.lineWidth = 1.6 * scale;
      pen.beginPath();
      for (const c of corners) {
        pen.moveTo(x(c.x + margin), y(c.y + margin));
        pen.lineTo(x(c.x + margin + magnified * c.dx), y(c.y + margin + magnified * c.dy));
      }
      pen.stroke();
    }, null, ["along one side [mm]", "along the other [mm]"]),
    legendOf(key("--orange", "towards the camera"), key("--blue", "away from it"), key("--ink", `displacement within the plane, ${magnified} times`, "line")));
  made.append(folded("Table of corners", table("Displacements of the corners [mm]", ["corner", "along one side", "along the other", "towards the camera", "known to"],
    corners.map(c => [c.id, number(c.dx, 2), number(c.dy, 2), number(c.dz, 2), number(c.std, 2)]))));
}

// ---- corners

function worstCorners() {
  const has_photos = data.worst.some(corner => corner.photo), has_lines = data.worst.every(corner => corner.line);
  section("corners", "The worst corners", table("Largest residuals of all cameras" + (has_lines ? "; line: in the corner file" : ""), [...(several ? ["camera"] : []), "image", "corner", "residual [px]", "times RMS", "u [px]", "v [px]", ...(has_lines ? ["line"] : []), ...(has_photos ? ["picture"] : [])],
    data.worst.map(corner => {
      const camera = data.cameras[corner.camera];
      const picture = corner.photo ? el("img", {class: "patch", src: corner.photo, alt: `Image ${corner.image} about corner ${corner.corner}`}) : "";
      return [...(several ? [camera.name] : []), corner.image, corner.corner, number(corner.error, 3), number(corner.error / camera.rms), corner.u.toFixed(1), corner.v.toFixed(1), ...(has_lines ? [corner.line] : []), ...(has_photos ? [picture] : [])];
    })));
}

function method() {
  const total = data.times.reduce((sum, [, seconds]) => sum + seconds, 0);
  section("method", "How this was found", el("p", {},
    `${data.measurements} measurements, ${data.unknowns} unknowns, redundancy ${data.redundancy}; the fit ended after ${plural(data.iterations, "iteration")}: ${data.stop_reason}. ` +
    `The statistics of this page took ${total < 0.01 ? "less than 0.01" : number(total)} s.`),
  el("p", {}, "Projection uncertainty is defined as in ", el("a", {href: "https://mrcal.secretsauce.net/uncertainty.html"}, "mrcal"),
    ", with the motion between two calibrations from cross-reprojection of the boards. The uncertainty and the gain of further views hold to first order and for " + (data.is_clustered ? "errors that images share, like clustered standard deviations" : "the stated noise") + ". They do not cover a model that does not fit; residuals and cross-validation show that."));
}

head();
parameters();
fit();
residuals();
space();
motion();
board();
if (data.is_assessed) {
  projection();
  crossValidation();
  furtherViews();
  correlations();
}
worstCorners();
method();
resizeAll();  // the first figure of a row was alone when it was drawn
