// A shape that can be turned: what is expected as lines, what the lane gave as a coloured surface or line.
page.viewer = (figure, shared) => {
  const canvas = figure.querySelector("canvas"), find = name => figure.querySelector(`[name=${name}]`);
  const view = { yaw: -0.6, pitch: 0.45, zoom: 1 }, start = { ...view };
  const draw = () => {
    const scene = shared.scene();
    figure.hidden = !scene || !scene.expected;
    if (figure.hidden) return;
    const on = page.surface(canvas);
    if (!on) return;
    const { pen, w, h } = on, tint = page.tint(), base = shared.frame * scene.size;
    const times = find("larger").checked ? shared.times(scene) : 1;
    const [cy, sy, cp, sp] = [Math.cos(view.yaw), Math.sin(view.yaw), Math.cos(view.pitch), Math.sin(view.pitch)];
    const unit = Math.min(w, h) * 0.4 * view.zoom / (scene.half || 1);
    // x to the right, y up, z towards the reader; farther points are a little smaller.
    const turn = p => {
      const x = p[0] * cy + p[2] * sy, z = p[2] * cy - p[0] * sy, y = p[1] * cp - z * sp, d = p[1] * sp + z * cp;
      const near = 1 / (1 - d / (scene.half || 1) * 0.12);
      return [w / 2 + x * unit * near, h / 2 - y * unit * near, d];
    };
    const columns = scene.across.count, rows = scene.up.count, at = (r, c) => base + r * columns + c;
    const expected = [], actual = [];
    for (let k = 0; k < scene.size; k++) {
      const e = scene.expected(base + k), a = scene.actual(base + k, times);
      expected.push(e && turn(e));
      actual.push(a && turn(a));
    }
    const path = (points, close) => {
      pen.beginPath();
      points.forEach((p, k) => k ? pen.lineTo(p[0], p[1]) : pen.moveTo(p[0], p[1]));
      if (close) pen.closePath();
    };
    pen.lineJoin = pen.lineCap = "round";
    axes(pen, turn, scene, tint, h);
    if (find("actual").checked) {
      if (scene.surface) {
        const faces = [];
        for (let r = 0; r + 1 < rows; r++) for (let c = 0; c + 1 < columns; c++) {
          const corners = [[r, c], [r, c + 1], [r + 1, c + 1], [r + 1, c]].map(([r, c]) => r * columns + c);
          const points = corners.map(k => actual[k]);
          if (points.some(p => !p)) continue;
          const worst = corners.reduce((a, b) => rank(scene, base + a) >= rank(scene, base + b) ? a : b);
          faces.push([points.reduce((sum, p) => sum + p[2], 0), points, scene.color(base + worst, shared.by, tint)]);
        }
        faces.sort((a, b) => a[0] - b[0]);
        for (const [depth, points, color] of faces) {
          path(points, true);
          pen.globalAlpha = 0.9;
          pen.fillStyle = pen.strokeStyle = color;
          pen.lineWidth = 0.6;
          pen.fill();
          pen.stroke();
          // Farther faces are paler.
          pen.globalAlpha = Math.max(0, Math.min(0.55, 0.28 - depth / (scene.half || 1) / 12));
          pen.fillStyle = tint.paper;
          pen.fill();
        }
      } else {
        pen.lineWidth = 2.5;
        for (let r = 0; r < rows; r++) for (let c = 0; c + 1 < columns; c++) {
          const [a, b] = [actual[r * columns + c], actual[r * columns + c + 1]];
          if (!a || !b) continue;
          const k = rank(scene, at(r, c)) >= rank(scene, at(r, c + 1)) ? at(r, c) : at(r, c + 1);
          pen.strokeStyle = scene.fails(k) ? tint.bad : scene.open(k) ? tint.open : tint.ramp[20];
          pen.globalAlpha = 1;
          path([a, b]);
          pen.stroke();
        }
      }
    }
    pen.globalAlpha = 1;
    if (find("expected").checked) {
      pen.strokeStyle = tint.ink;
      pen.lineWidth = 1;
      if (!scene.surface) pen.setLineDash([2, 4]);
      const line = list => { // Gaps where there is no point.
        let run = [];
        for (const p of [...list, null]) {
          if (p) { run.push(p); continue; }
          if (run.length > 1) { path(run); pen.stroke(); }
          run = [];
        }
      };
      pen.globalAlpha = scene.surface ? 0.32 : 0.85;
      const every = n => Math.max(1, Math.round((n - 1) / 12));
      for (let r = 0; r < rows; r += scene.surface ? every(rows) : 1) line(Array.from({ length: columns }, (_, c) => expected[r * columns + c]));
      if (scene.surface) for (let c = 0; c < columns; c += every(columns)) line(Array.from({ length: rows }, (_, r) => expected[r * columns + c]));
      pen.setLineDash([]);
      pen.globalAlpha = 1;
    }
    const bones = (scene.lines[shared.frame] || []).map(line => line.map(p => turn(p.map((x, c) => x - scene.center[c]))));
    for (const bone of bones) {
      pen.strokeStyle = pen.fillStyle = tint.bone;
      pen.lineWidth = 3;
      path(bone);
      pen.stroke();
      for (const p of bone) { pen.beginPath(); pen.arc(p[0], p[1], 4, 0, 7); pen.fill(); }
    }
    if (find("worst").checked) scene.worst.forEach((worst, n) => {
      const p = worst.place >= base && worst.place < base + scene.size && (actual[worst.place - base] || expected[worst.place - base]);
      if (p) mark(pen, p, n + 1, scene.fails(worst.place) ? tint.bad : tint.ink, tint);
    });
    if (shared.at !== null) {
      const p = actual[shared.at] || expected[shared.at];
      if (p) { pen.beginPath(); pen.arc(p[0], p[1], 5, 0, 7); pen.lineWidth = 2; pen.strokeStyle = tint.ink; pen.fillStyle = tint.paper; pen.fill(); pen.stroke(); }
    }
    figure.querySelector(".times").textContent = "differences × " + page.short(shared.times(scene));
    find("larger").disabled = !scene.largest;
    find("frame").parentElement.hidden = scene.frames.length < 2;
    find("frame").max = scene.frames.length - 1;
    figure.querySelector(".frame").textContent = scene.frames[shared.frame] || "";
  };
  const rank = (scene, k) => scene.fails(k) ? 1e9 : scene.open(k) ? -1 : scene.ratio(k);
  const mark = (pen, p, n, color, tint) => {
    pen.beginPath();
    pen.arc(p[0], p[1], 8, 0, 7);
    pen.fillStyle = tint.paper;
    pen.fill();
    pen.lineWidth = 1.75;
    pen.strokeStyle = pen.fillStyle = color;
    pen.stroke();
    pen.font = "600 11px system-ui, sans-serif";
    pen.textAlign = "center";
    pen.textBaseline = "middle";
    pen.fillText(n, p[0], p[1] + 0.5);
  };
  // A small cross of axes in the corner.
  const axes = (pen, turn, scene, tint, h) => {
    const o = turn([0, 0, 0]), size = 26, from = [38, h - 38];
    ["x", "y", "z"].forEach((name, k) => {
      const d = turn([0, 1, 2].map(c => c === k ? scene.half || 1 : 0)), v = [d[0] - o[0], d[1] - o[1]];
      const long = Math.min(canvas.clientWidth, canvas.clientHeight) * 0.4 * view.zoom;
      const to = v.map((x, c) => from[c] + x / long * size);
      pen.strokeStyle = pen.fillStyle = tint.quiet;
      pen.lineWidth = 1;
      pen.beginPath();
      pen.moveTo(...from);
      pen.lineTo(...to);
      pen.stroke();
      pen.textAlign = "center";
      pen.textBaseline = "middle";
      pen.fillText(name, from[0] + v[0] / long * (size + 8), from[1] + v[1] / long * (size + 8));
    });
  };
  let held = null;
  canvas.addEventListener("pointerdown", e => { held = [e.clientX, e.clientY]; canvas.setPointerCapture(e.pointerId); canvas.style.cursor = "grabbing"; });
  canvas.addEventListener("pointermove", e => {
    if (!held) return;
    view.yaw += (e.clientX - held[0]) / 120;
    view.pitch = Math.max(-1.57, Math.min(1.57, view.pitch + (e.clientY - held[1]) / 120));
    held = [e.clientX, e.clientY];
    draw();
  });
  ["pointerup", "pointercancel"].forEach(name => canvas.addEventListener(name, () => { held = null; canvas.style.cursor = ""; }));
  // The wheel scrolls the page until the picture has the focus.
  canvas.addEventListener("wheel", e => {
    if (document.activeElement !== canvas) return;
    e.preventDefault();
    view.zoom = Math.max(0.3, Math.min(20, view.zoom * Math.exp(-e.deltaY / 400)));
    draw();
  }, { passive: false });
  canvas.addEventListener("keydown", e => {
    const turn = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1] }[e.key];
    if (turn) { view.yaw += turn[0]; view.pitch = Math.max(-1.57, Math.min(1.57, view.pitch + turn[1])); }
    else if (e.key === "+" || e.key === "=") view.zoom = Math.min(20, view.zoom * 1.2);
    else if (e.key === "-") view.zoom = Math.max(0.3, view.zoom / 1.2);
    else if (e.key === "0") Object.assign(view, start);
    else return;
    e.preventDefault();
    draw();
  });
  page.all("input", figure).forEach(input => input.addEventListener("input", () => {
    if (input.name === "frame") { shared.frame = Number(input.value); shared.draw(); } else draw();
  }));
  return draw;
};
