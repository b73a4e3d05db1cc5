// What a picture and a map share: the numbers of a suite on one lane, unpacked when they are first looked at.
page.scene = entry => {
  if (!entry || !entry.cells) return null;
  if (entry.ready) return entry.ready;
  const cells = page.bytes(entry.cells), [across, up] = entry.axes, size = across.count * up.count;
  const code = k => k === 0 ? 0 : k === 255 ? Infinity : 2 ** ((k - 1) / 4 - 16);
  const scene = {
    across, up, size, frames: entry.frames, surface: entry.surface, output: entry.output, lines: entry.lines, worst: entry.worst,
    state: k => cells[3 * k], ulp: k => code(cells[3 * k + 1]),
    // No bound: there is nothing to divide by.
    ratio: k => cells[3 * k + 2] === 254 ? NaN : code(cells[3 * k + 2]),
    fails: k => cells[3 * k] === 1 || cells[3 * k] === 2,
    nothing: k => cells[3 * k] === 3,
    open: k => cells[3 * k] > 3,
  };
  const position = entry.position === null ? null : page.data.positions[entry.position];
  if (position) {
    const at = page.words(position.at), off = page.words(entry.off), half = position.half, step = entry.step;
    scene.half = half;
    scene.center = position.center;
    const has = (list, k) => list[3 * k] !== -32768;
    scene.expected = k => has(at, k) ? [0, 1, 2].map(c => at[3 * k + c] / 32767 * half) : null;
    scene.actual = (k, times) => has(at, k) && has(off, k)
      ? [0, 1, 2].map(c => at[3 * k + c] / 32767 * half + off[3 * k + c] / 32767 * step * times) : null;
    scene.largest = step;
  }
  // The largest error of what deviates.
  scene.most = () => {
    if (scene.worstUlp === undefined) {
      scene.worstUlp = 0;
      for (let k = 0; k < cells.length / 3; k++) if (scene.fails(k) && isFinite(scene.ulp(k))) scene.worstUlp = Math.max(scene.worstUlp, scene.ulp(k));
    }
    return scene.worstUlp || 1;
  };
  scene.said = k => {
    const s = cells[3 * k], r = scene.ratio(k), u = scene.ulp(k);
    const word = s === 0 ? "agrees" : s === 1 ? "the shader deviates" : s === 2 ? "the lane deviates" : s === 3 ? "no vertex"
      : "undetermined: " + page.data.reasons[s - 4];
    if (s === 3) return word;
    const error = u === Infinity ? "no number" : u === 0 ? "no error" : `error ≈ ${page.short(u)} ULP`;
    return `${word}, ${error}` + (isNaN(r) ? ", no bound" : r === Infinity ? "" : `, ${page.short(r)} of its bound`);
  };
  scene.place = k => {
    const column = k % across.count, row = Math.floor(k / across.count) % up.count;
    const on = (axis, n) => `${axis.name} ${page.short(axis.range[0] + (axis.range[1] - axis.range[0]) * n / Math.max(1, axis.count - 1))}`;
    return `${on(across, column)}, ${on(up, row)}`;
  };
  // Colour of a place by one of its numbers.
  scene.color = (k, by, tint) => {
    if (scene.fails(k)) return tint.bads[Math.round(16 * Math.max(0, 1 + Math.log2(Math.max(scene.ulp(k), 1e-9) / scene.most()) / 6))] || tint.bad;
    if (scene.open(k)) return tint.open;
    if (scene.nothing(k)) return tint.paper;
    const v = by === "ulp" ? scene.ulp(k) / 16 : scene.ratio(k);
    if (isNaN(v)) return tint.open;
    return tint.ramp[v > 0 ? Math.round(Math.min(1, Math.max(0, 1 + Math.log2(v) / 10)) * 32) : 0];
  };
  return entry.ready = scene;
};

page.short = x => x === 0 ? "0" : Math.abs(x) >= 1e-3 && Math.abs(x) < 1e5 ? String(+x.toPrecision(3))
  : x.toExponential(1).replace(".0e", "e").replace("e+", "e");

// The colours of the page, with a ramp from cold to hot.
page.tint = () => {
  const rgb = name => { const v = page.color(name).slice(1), f = v.length === 3 ? 1 : 2; return [0, 1, 2].map(k => parseInt(v.substr(k * f, f).repeat(3 - f), 16)); };
  const between = (from, to, steps) => Array.from({ length: steps + 1 }, (_, k) =>
    `rgb(${rgb(from).map((c, n) => Math.round(c + (rgb(to)[n] - c) * k / steps)).join(",")})`);
  return { ramp: between("cold", "hot", 32), bads: between("bad-cold", "bad", 16), bad: page.color("bad"), open: page.color("open"), ink: page.color("ink"), quiet: page.color("quiet"),
           line: page.color("line"), paper: page.color("paper"), bone: page.color("bone") };
};

// A canvas as sharp as the screen; null while it is not shown.
page.surface = canvas => {
  const box = canvas.getBoundingClientRect(), many = Math.max(devicePixelRatio || 1, 1.5);
  if (box.width < 10) return null;
  const [w, h] = [Math.round(box.width * many), Math.round(box.height * many)];
  if (canvas.width !== w || canvas.height !== h) { canvas.width = w; canvas.height = h; }
  const pen = canvas.getContext("2d");
  pen.setTransform(many, 0, 0, many, 0, 0);
  pen.clearRect(0, 0, box.width, box.height);
  pen.font = "12px system-ui, sans-serif";
  return { pen, w: box.width, h: box.height };
};
