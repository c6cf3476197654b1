// The sections on the expected accuracy of the calibration: projection uncertainty, cross-validation, next best
// views, correlations.

function mapFigure(row, camera, title, caption, name, values, levels) {
  figure(row, title, caption, place => imagePlot(place, name, camera, (pen, x, y, scale) => drawMap(pen, x, y, scale, camera, values, levels),
    (u, v) => {
      const value = interpolated(camera.grid, camera, values, u, v);
      return `u ${u.toFixed(0)}, v ${v.toFixed(0)}: ${value === null ? "no ray known" : number(value) + " px"}`;
    }), mapLegend(levels, "px"));
}
const mapTableRow = (name, grid, values) => {
  const [columns, rows] = grid, at = (i, j) => number(values[Math.round(j * (rows - 1)) * columns + Math.round(i * (columns - 1))]);
  return [name, at(0.5, 0.5), at(0, 0.5), at(1, 0.5), at(0.5, 0), at(0.5, 1), at(0, 0), at(1, 0), at(0, 1), at(1, 1)];
};
const map_places = ["", "middle", "left", "right", "top", "bottom", "top left", "top right", "bottom left", "bottom right"];

function projection() {
  const maps = el("div", {class: "row"}), curves = el("div", {class: "row"}), rows = [];
  const made = section("projection", "Projection uncertainty", el("p", {},
    "A point at rest relative to the rig has a pixel. A calibration with other noise would give another pixel. The maps show the standard deviation of this change, in the direction in which it is largest. " +
    "The motion of the rig's own frame between two calibrations is not counted, because it is invisible."), maps, curves);
  const levels = levelsFor(data.cameras.flatMap(camera => camera.projection.flatMap(map => map.std)));
  for (const camera of data.cameras) {
    for (const map of camera.projection) {
      const where = distanceText(map.distance) + (map.distance === null ? "" : ", the distance of the boards");
      mapFigure(maps, camera, [titleOf(camera), where].filter(x => x).join(", "),
        `Middle ${number(map.middle)} px, below ${number(map.median)} px in half of the image, worst place ${number(map.worst)} px.` + (map.std.includes(null) ? " Hatched: the model has no ray for these pixels." : ""),
        `Projection uncertainty over the image of ${camera.name} ${where}`, map.std, levels);
      rows.push(mapTableRow([several ? camera.name : "", where].filter(x => x).join(", "), camera.grid, map.std));
    }
  }
  for (const camera of data.cameras) {
    figure(curves, titleOf(camera), `The boards stood ${number(data.board_distance)} m away. At other distances, the position of the camera's centre also matters.`,
      place => xyPlot(place, `Projection uncertainty of ${camera.name} by distance`, "distance [m]", "std. dev. [px]", [
        {x: camera.distances, y: camera.middle, colour: "--blue", kind: "line"},
        {x: camera.distances, y: camera.worst, colour: "--orange", kind: "line"},
      ], {log_x: true, log_y: true, height: 240, y_range: (u, low, high) => [10 ** Math.floor(Math.log10(low)), 10 ** Math.ceil(Math.log10(high))],
        x_axis: {values: (u, splits) => splits.map(x => x === null ? "" : String(Number(x.toPrecision(2))))},
        y_axis: {values: (u, splits) => splits.map(x => x === null ? "" : String(Number(x.toPrecision(2))))}}),
      legendOf(key("--blue", "middle of the image", "line"), key("--orange", "worst place", "line")));
  }
  made.append(folded("Table", table("Projection uncertainty [px] at places of the image", map_places, rows)));
}

function crossValidation() {
  const made = section("halves", "Cross-validation",
    el("p", {}, "Compares calibrations from every second image and from the others: the pixels to which the two project the same rays, after fitting the rotation between their frames. " +
      "Residuals cannot show a model that adapts to its own images. Halves that disagree by more than noise do show it."));
  if (data.split_why_not) {
    made.append(el("p", {}, `There is no comparison: ${data.split_why_not}.`));
    return;
  }
  const maps = el("div", {class: "row"}), levels = levelsFor(data.cameras.flatMap(camera => camera.split.difference));
  made.append(maps);
  for (const camera of data.cameras) {
    const split = camera.split, as_expected = split.probability > 0.001;
    mapFigure(maps, camera, titleOf(camera), `RMS ${number(split.rms)} px, largest ${number(split.largest)} px; noise alone gives an RMS of ${number(split.expected)} px.` +
      (as_expected ? " The halves agree as well as they should." : " The lens parameters differ by more than their standard deviations allow."),
      `Difference of the two halves over the image of ${camera.name}`, split.difference, levels);
  }
  made.append(folded("Table", table("Difference of the halves; chi-square: of the lens parameters", ["camera", "RMS [px]", "expected [px]", "largest [px]", "χ²", "parameters", "probability"],
    data.cameras.map(({name, split}) => [name, number(split.rms), number(split.expected), number(split.largest), number(split.chi2, 3), split.dof, number(split.probability)]))));
}

function furtherViews() {
  const made = section("views", "What more images would help",
    el("p", {}, "Boards all over the images, facing the camera or tilted, were added by calculation. These views reduce the worst projection uncertainty " +
      (data.views.length > 0 && data.views[0].far ? "at infinity" : "at the distance of the boards") + " most:"));
  if (data.views.length === 0) { made.append(el("p", {}, data.cut_short ? `The search was cut short: ${data.cut_short}.` : "No view helps.")); return; }
  made.append(el("ol", {class: "views"}, ...data.views.map((view, i) => el("li", {}, (i === 0 ? "" : "then ") + view.sentence + "."))));
  const most = data.views[0].before;
  const bar = value => { const made = el("span", {class: "bar"}); made.style.width = Math.max(1, 240 * value / most).toFixed(0) + "px"; return made; };
  made.append(table("Worst projection uncertainty", ["after", "px", ""], [["these images", number(most), bar(most)],
    ...data.views.map((view, i) => ["view " + (i + 1), number(view.after), bar(view.after)])]));
}

// ---- correlations

function correlationPicture(place, names, matrix) {
  const cell = Math.max(11, Math.min(22, Math.floor(620 / names.length))), label = 8.2 * Math.max(...names.map(name => name.length)) * cell / 22 + 20;
  const canvas = el("canvas", {role: "img", "aria-label": "Correlations of all pairs of parameters"});
  const readout = el("div", {class: "readout"});
  place.append(el("div", {class: "scroll", tabindex: "0", role: "region", "aria-label": "Correlations"}, canvas), readout);
  const side = names.length * cell, at = (i, j) => matrix[Math.max(i, j) * (Math.max(i, j) + 1) / 2 + Math.min(i, j)];
  const redraw = () => {
    const ratio = devicePixelRatio || 1, pen = canvas.getContext("2d");
    canvas.width = (side + label) * ratio;
    canvas.height = (side + 2) * ratio;
    canvas.style.width = side + label + "px";
    pen.scale(ratio, ratio);
    pen.font = Math.min(12, cell - 1) + "px system-ui, sans-serif";
    pen.textAlign = "right";
    pen.textBaseline = "middle";
    names.forEach((name, i) => {
      pen.fillStyle = css("--quiet");
      pen.fillText(name, label - 6, (i + 0.5) * cell);
      for (let j = 0; j <= i; ++j) {
        const value = at(i, j);
        pen.fillStyle = css("--grid");
        pen.fillRect(label + j * cell, i * cell, cell - 1, cell - 1);
        pen.fillStyle = css(value < 0 ? "--orange" : "--blue");
        pen.globalAlpha = Math.abs(value);
        pen.fillRect(label + j * cell, i * cell, cell - 1, cell - 1);
        pen.globalAlpha = 1;
      }
    });
  };
  canvas.addEventListener("pointermove", event => {
    const j = Math.floor((event.offsetX - label) / cell), i = Math.floor(event.offsetY / cell);
    if (i < 0 || j < 0 || i >= names.length || j >= names.length) { readout.textContent = ""; return; }
    readout.textContent = `${names[i]}, ${names[j]}: ${at(i, j).toFixed(3)}`;
  });
  drawings.push({redraw, resize: () => {}});
  redraw();
}

function correlations() {
  const {names, matrix, strong, strong_count, count} = data.correlations;
  const made = section("correlations", "Correlations", el("p", {},
    "Correlated parameters trade off against each other: one compensates errors of the other. Strong correlations are usual between focal length and distance, and among the distortion coefficients. They do not harm the projection, but the values must be used together."));
  const holder = el("figure", {});
  if (names.length) {
    made.append(holder);
    correlationPicture(holder, names, matrix);
    holder.append(legendOf(key("--blue", "+1"), key("--grid", "0"), key("--orange", "−1")));
  } else made.append(el("p", {class: "quiet"}, `There are ${count} parameters, too many for a picture.`));
  if (strong.length === 0) made.append(el("p", {}, "No correlation has magnitude 0.9 or more."));
  else made.append(table(`Magnitude 0.9 or more: ${strong_count}` + (strong.length < strong_count ? `, the strongest ${strong.length}` : ""), ["", "and", "correlation"], strong.map(([a, b, c]) => [a, b, c.toFixed(3)])));
}
