// The section on IMUs in motion: pose and clock, what is left of the readings, noise at rest, path of the rig.

const axis_names = ["x", "y", "z"];
const small_numbers = {size: 64, values: (_, ticks) => ticks.map(x => x === null ? "" : String(Number(x.toPrecision(1))))};

/// Returns residuals of one kind as lists by axis: {t, of: [x, y, z]}.
function residualSeries(imu, kind) {
  return {t: imu.residuals.time, of: [0, 1, 2].map(axis => imu.residuals[kind][axis]), std: imu.residuals[kind + "_std"]};
}

function residualsOverTime(row, imu, kind, name, unit) {
  const series = residualSeries(imu, kind), most = Math.max(...series.of.flat().map(Math.abs));
  figure(row, name, "The fit absorbs a part of the noise, so residuals are smaller than the noise.", place => xyPlot(place, `Residuals of the ${name} of ${imu.name} over time`, "time [s]", `mean reading minus fit [${unit}]`,
    [...series.of.map((y, axis) => ({x: series.t, y, colour: colourOf(axis), kind: "points", size: 2})),
      {x: series.t, y: series.std.map(s => 2 * s), colour: "--ink", kind: "dashes"}, {x: series.t, y: series.std.map(s => -2 * s), colour: "--ink", kind: "dashes"}],
    {y_range: () => [-1.08 * most, 1.08 * most]}),
    legendOf(...axis_names.map((text, axis) => key(colourOf(axis), text)), key("--ink", "2 standard deviations of the noise", "dashes")));
}

/// Draws how many residuals have which size, in standard deviations of the noise, beside the normal distribution.
function residualHistogram(row, imu, kind, name) {
  const series = residualSeries(imu, kind), width = 0.25, reach = 6, bins = 2 * reach / width;
  const raw = series.of.flatMap(list => list.map((r, i) => r / series.std[i]));
  const rms = Math.sqrt(raw.reduce((sum, v) => sum + v * v, 0) / raw.length), scale = imu.ratio[kind] ? imu.ratio[kind] / rms : 1;
  const z = raw.map(v => v * scale), counts = new Array(bins).fill(0);
  for (const value of z) ++counts[Math.min(bins - 1, Math.max(0, Math.floor((value + reach) / width)))];
  const x = counts.map((_, i) => -reach + (i + 0.5) * width), normal = x.map(v => Math.exp(-v * v / 2) / Math.sqrt(2 * Math.PI));
  figure(row, name, "Both ends hold all residuals beyond. The noise is that part which the fit does not absorb.", place => xyPlot(place, `Histogram of the residuals of the ${name} of ${imu.name}`,
    "residual [standard deviations of the noise]", "density",
    [{x, y: counts.map(count => count / (z.length * width)), colour: "--blue", kind: "line"}, {x, y: normal, colour: "--green", kind: "dashes"}]),
    legendOf(key("--blue", "residuals", "line"), key("--green", "normal distribution", "dashes")));
}

/// Returns the spectral density of evenly spaced numbers, averaged over segments and octave parts: [{f, s}].
function spectrumOf(list, spacing) {
  const n = Math.min(1024, list.length), parts = Math.max(1, Math.floor(list.length / n)), bins = new Map();
  for (let part = 0; part < parts; ++part) {
    for (let k = 1; k <= n / 2; ++k) {
      let re = 0, im = 0;
      const step = 2 * Math.PI * k / n;
      for (let i = 0; i < n; ++i) {
        re += list[part * n + i] * Math.cos(step * i);
        im += list[part * n + i] * Math.sin(step * i);
      }
      const bin = Math.floor(6 * Math.log2(k)), had = bins.get(bin) || {f: 0, s: 0, count: 0};
      bins.set(bin, {f: had.f + k / (n * spacing), s: had.s + spacing / n * (re * re + im * im), count: had.count + 1});
    }
  }
  return [...bins.values()].map(bin => ({f: bin.f / bin.count, s: bin.s / bin.count}));
}

function residualSpectrum(row, imu, kind, name, unit, density) {
  const series = residualSeries(imu, kind), spacing = imu.residuals.spacing;
  if (series.t.length < 32) return;
  const spectra = series.of.map(list => spectrumOf(list, spacing));
  const all = spectra.flat().map(bin => Math.sqrt(bin.s)).concat(density), f = spectra[0].map(bin => bin.f);
  figure(row, name, "White noise gives a level line. Slow errors, such as a bias that drifts more than stated, rise to the left; vibration gives a peak. Spectra fall to the right, because the poses of the images follow quick noise.",
    place => xyPlot(place, `Spectrum of the residuals of the ${name} of ${imu.name}`, "frequency [Hz]", `density [${unit}/√Hz]`,
      [...spectra.map((bins, axis) => ({x: bins.map(bin => bin.f), y: bins.map(bin => Math.sqrt(bin.s)), colour: colourOf(axis), kind: "line"})),
        {x: [f[0], f[f.length - 1]], y: [density, density], colour: "--ink", kind: "dashes"}],
      {log_x: true, log_y: true, y_range: () => [Math.min(...all) / 1.5, Math.max(...all) * 1.5], y_axis: small_numbers}),
    legendOf(...axis_names.map((text, axis) => key(colourOf(axis), text, "line")), key("--ink", `noise of the fit, ${number(density)}`, "dashes")));
}

function allanPlot(row, imu, kind, name, unit, density, walk) {
  const t = imu.at_rest.map(one => one.time), y = imu.at_rest.map(one => one[kind]);
  const white = t.map(time => density / Math.sqrt(time)), slow = t.map(time => walk * Math.sqrt(time / 3));
  const all = [...y, ...white];
  figure(row, name, "", place => xyPlot(place, `Allan deviation of the ${name} of ${imu.name} at rest`, "time of averaging [s]", `Allan deviation [${unit}]`,
    [{x: t, y, colour: "--blue", kind: "line"}, {x: t, y: white, colour: "--ink", kind: "dashes"}, {x: t, y: slow, colour: "--orange", kind: "dashes"}],
    {log_x: true, log_y: true, y_range: () => [Math.min(...all) / 1.5, Math.max(...all) * 1.5], y_axis: small_numbers}),
    legendOf(key("--blue", "readings at rest, mean of three axes", "line"), key("--ink", "white noise of the fit", "dashes"), key("--orange", "random walk of the fit", "dashes")));
}

/// Draws the path in two planes of the board's frame.
function pathPlot(row, path, across, down, title) {
  const values = index => path.map(p => p[index]), low = index => Math.min(...values(index)), high = index => Math.max(...values(index));
  const side = Math.max(high(across) - low(across), high(down) - low(down), 0.01) * 1.1;
  const left = (high(across) + low(across) - side) / 2, top = (high(down) + low(down) - side) / 2;
  figure(row, title, "", place => imagePlot(place, `Path of the rig, ${title}`, {width: side, height: side}, (pen, x, y, scale) => {
    pen.strokeStyle = css("--blue");
    pen.lineWidth = 1.2 * scale;
    pen.beginPath();
    path.forEach((p, i) => pen[i === 0 ? "moveTo" : "lineTo"](x(p[across] - left), y(p[down] - top)));
    pen.stroke();
    for (const [p, colour] of [[path[0], "--green"], [path[path.length - 1], "--orange"]]) {
      pen.fillStyle = css(colour);
      pen.beginPath();
      pen.arc(x(p[across] - left), y(p[down] - top), 4 * scale, 0, 2 * Math.PI);
      pen.fill();
    }
  }, null, [`${axis_names[across - 1]} of the board [m]`, `${axis_names[down - 1]} of the board [m]`], [left, top]),
  legendOf(key("--green", "start"), key("--orange", "end")));
}

function imuInMotion(imu) {
  const rows = ["over", "histogram", "spectrum", "rest"].map(() => el("div", {class: "row"}));
  const has_residuals = imu.residuals.time.length > 1;
  const header = ["", "value", "stated", "clustered", "unit"];
  const made = section("imu-" + imu.name, "IMU " + imu.name,
    imu.undetermined ? el("p", {}, "The fit of the IMU failed: " + imu.undetermined + ".") : null,
    el("p", {class: "quiet"}, `${plural(imu.samples, "reading")} between ${plural(imu.intervals, "pair")} of images. Noise ${imu.noise_is_given ? "as given" : "from the residuals"}: ` +
      `gyroscope ${number(imu.density.gyro)} rad/s/√Hz, accelerometer ${number(imu.density.force)} m/s²/√Hz; residuals are ${number(imu.ratio.gyro)} and ${number(imu.ratio.force)} times that.`),
    table(`Pose and clock: p_${imu.name} = R p_${data.cameras[0].name} + t, t_${imu.name} = t_${data.cameras[0].name} + offset`, header, imu.parameters),
    el("h3", {}, "Motion of the rig"),
    el("p", {}, `Turns about x, y, z of ${imu.name}: ${imu.excitation.gyro.map(v => number(v)).join(", ")} rad/s (RMS). Forces along them, without their means: ${imu.excitation.acc.map(v => number(v)).join(", ")} m/s².`),
    imu.notes.length ? el("ul", {}, ...imu.notes.map(note => el("li", {}, note))) : el("p", {}, "The motion determines all directions of the pose about equally well."),
    el("h3", {}, "Residuals over time"), rows[0], el("h3", {}, "Histograms"), rows[1], el("h3", {}, "Spectra"), rows[2]);
  for (const [kind, name, unit] of has_residuals ? [["gyro", "gyroscope", "rad/s"], ["force", "accelerometer", "m/s²"]] : []) {
    residualsOverTime(rows[0], imu, kind, name, unit);
    residualHistogram(rows[1], imu, kind, name);
    residualSpectrum(rows[2], imu, kind, name, unit, imu.density[kind]);
  }
  if (imu.at_rest.length > 1) {
    made.append(el("h3", {}, `Noise at rest, from ${number(imu.rest[0], 3)} s to ${number(imu.rest[1], 3)} s`), rows[3]);
    for (const [kind, name, unit] of [["gyro", "gyroscope", "rad/s"], ["force", "accelerometer", "m/s²"]])
      allanPlot(rows[3], imu, kind, name, unit, imu.density[kind], imu.walk[kind]);
  } else {
    made.append(el("p", {class: "quiet"}, "The recording has no rest of 5 s or more, so there is no Allan deviation."));
  }
}

function motion() {
  if (!data.streams || !data.streams.imus.length) return;
  if (data.streams.timings.length)
    section("timings", "Clocks and shutters", table(`t_camera = t_${data.cameras[0].name} + offset; line delay: from one row to the next`,
      ["", "value", "stated", "clustered", "unit"], data.streams.timings));
  for (const imu of data.streams.imus) imuInMotion(imu);
  const row = el("div", {class: "row"});
  section("path", "Path of the rig", el("p", {class: "quiet"}, `Camera ${data.cameras[0].name} in the frame of the board, from first to last image.`), row);
  pathPlot(row, data.streams.path, 1, 2, "across the board");
  pathPlot(row, data.streams.path, 1, 3, "towards the board");
}
