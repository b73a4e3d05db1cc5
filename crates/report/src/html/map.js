// The error over the two things that change: a colour for each place.
page.map = (figure, shared) => {
  const canvas = figure.querySelector("canvas"), said = figure.querySelector(".said"), by = figure.querySelector("select");
  const left = 56, bottom = 40, top = 8, right = 10;
  let cursor = null;
  const inside = () => [canvas.clientWidth - left - right, canvas.clientHeight - top - bottom];
  const draw = () => {
    const scene = shared.scene();
    figure.hidden = !scene;
    if (!scene) return;
    const on = page.surface(canvas);
    if (!on) return;
    const { pen, h } = on, tint = page.tint(), [w, high] = inside();
    const columns = scene.across.count, rows = scene.up.count, base = shared.frame * scene.size;
    for (let r = 0; r < rows; r++) for (let c = 0; c < columns; c++) {
      pen.fillStyle = scene.color(base + r * columns + c, shared.by, tint);
      const [x, y] = [left + w * c / columns, top + high * (rows - 1 - r) / rows];
      pen.fillRect(x, y, w / columns + 0.5, high / rows + 0.5);
    }
    pen.strokeStyle = tint.line;
    pen.strokeRect(left, top, w, high);
    pen.fillStyle = tint.quiet;
    pen.textBaseline = "top";
    const ticks = axis => {
      const whole = axis.range.every(Number.isInteger) && axis.range[1] - axis.range[0] >= 3;
      return [0, 0.25, 0.5, 0.75, 1].map(p => [p, axis.range[0] + (axis.range[1] - axis.range[0]) * p])
        .filter(([p, v]) => !whole || p === 0 || p === 1 || Number.isInteger(v));
    };
    for (const [p, v] of ticks(scene.across)) {
      pen.textAlign = p === 0 ? "left" : p === 1 ? "right" : "center";
      pen.fillText(page.short(v), left + w * p, top + high + 5);
    }
    pen.textAlign = "right";
    pen.textBaseline = "middle";
    for (const [p, v] of ticks(scene.up)) pen.fillText(page.short(v), left - 6, top + 5 + (high - 10) * (1 - p));
    pen.fillStyle = tint.ink;
    pen.textAlign = "center";
    pen.textBaseline = "bottom";
    pen.fillText(scene.across.name, left + w / 2, h - 4);
    pen.save();
    pen.translate(13, top + high / 2);
    pen.rotate(-Math.PI / 2);
    pen.textBaseline = "middle";
    pen.fillText(scene.up.name, 0, 0);
    pen.restore();
    const spot = k => [left + w * (k % columns + 0.5) / columns, top + high * (rows - 0.5 - Math.floor(k / columns)) / rows];
    scene.worst.forEach((worst, n) => {
      const k = worst.place - base;
      if (k < 0 || k >= scene.size) return;
      const [x, y] = spot(k);
      pen.beginPath();
      pen.arc(x, y, 7, 0, 7);
      pen.fillStyle = tint.paper;
      pen.fill();
      pen.strokeStyle = pen.fillStyle = scene.fails(worst.place) ? tint.bad : tint.ink;
      pen.lineWidth = 1.5;
      pen.stroke();
      pen.textBaseline = "middle";
      pen.font = "600 10px system-ui, sans-serif";
      pen.fillText(n + 1, x, y + 0.5);
    });
    if (cursor !== null && cursor < scene.size) {
      const [x, y] = spot(cursor), [a, b] = [Math.max(6, w / columns), Math.max(6, high / rows)];
      pen.strokeStyle = tint.ink;
      pen.lineWidth = 2;
      pen.strokeRect(x - a / 2, y - b / 2, a, b);
    }
  };
  const tell = k => {
    const scene = shared.scene();
    cursor = k;
    shared.at = k;
    said.textContent = k === null ? said.dataset.usual : `${scene.place(k)}: ${scene.said(shared.frame * scene.size + k)}`;
    shared.draw();
  };
  const under = e => {
    const box = canvas.getBoundingClientRect(), scene = shared.scene(), [w, high] = inside();
    const c = Math.floor((e.clientX - box.left - left) / w * scene.across.count);
    const r = scene.up.count - 1 - Math.floor((e.clientY - box.top - top) / high * scene.up.count);
    return c >= 0 && r >= 0 && c < scene.across.count && r < scene.up.count ? r * scene.across.count + c : null;
  };
  canvas.addEventListener("pointermove", e => { const k = under(e); if (k !== cursor) tell(k); });
  canvas.addEventListener("pointerleave", () => { if (document.activeElement !== canvas) tell(null); });
  canvas.addEventListener("keydown", e => {
    const scene = shared.scene(), columns = scene.across.count;
    const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[e.key];
    if (!step) return;
    e.preventDefault();
    const k = cursor === null ? Math.floor(scene.size / 2) : cursor;
    const c = Math.max(0, Math.min(columns - 1, k % columns + step[0]));
    const r = Math.max(0, Math.min(scene.up.count - 1, Math.floor(k / columns) + step[1]));
    tell(r * columns + c);
  });
  by.addEventListener("change", () => {
    shared.by = by.value;
    page.all("[data-end]", figure).forEach(end => { end.textContent = end.dataset[by.value]; });
    shared.draw();
  });
  return draw;
};

// Pictures and maps of all suites.
for (const suite of page.all("details.suite")) {
  const shape = suite.querySelector(".shape"), map = suite.querySelector(".map");
  if (!map) continue;
  const shared = {
    entry: null, frame: 0, at: null, by: "ratio",
    scene: () => page.scene(shared.entry),
    // The power of ten that makes the largest difference about a tenth of the shape.
    times: scene => scene.largest > 0 ? 10 ** Math.max(0, Math.floor(Math.log10(0.3 * scene.half / scene.largest))) : 1,
    draw: () => parts.forEach(f => f()),
  };
  const parts = [page.map(map, shared)];
  if (shape) parts.push(page.viewer(shape, shared));
  suite.addEventListener("way", event => {
    shared.entry = page.data.entries[Number(event.detail)];
    const scene = shared.scene();
    // A picture that moves begins where it has moved.
    if (scene && shared.frame >= scene.frames.length) shared.frame = scene.frames.length - 1;
    if (scene && !shared.seen && scene.frames.length > 1) {
      shared.frame = scene.worst.length && scene.fails(scene.worst[0].place)
        ? Math.floor(scene.worst[0].place / scene.size) : Math.floor(scene.frames.length / 2);
      shared.seen = true;
      if (shape) shape.querySelector("[name=frame]").value = shared.frame;
    }
    shared.draw();
  });
  page.redraw.push(() => { if (suite.open && !suite.hidden) shared.draw(); });
}
addEventListener("resize", page.draw);
page.begin();
page.draw();
