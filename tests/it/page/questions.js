"use strict";
const $ = selector => document.querySelector(selector);
const wait = () => new Promise(done => setTimeout(done, 50));
const rows = () => Array.from(document.querySelectorAll("#matrix-table tbody tr")).filter(r => !r.hidden).length;
const click = selector => $(selector).click();
const type = (selector, text, event) => { $(selector).value = text; $(selector).dispatchEvent(new Event(event)); };
const key = (target, name) => target.dispatchEvent(new KeyboardEvent("keydown", { key: name, bubbles: true, cancelable: true }));
// A short text that changes with any pixel.
const look = canvas => {
  const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  let inked = 0, red = 0, hash = 0;
  for (let k = 0; k < data.length; k += 4) {
    const [r, g, b, a] = data.slice(k, k + 4);
    inked += a > 0;
    red += a > 100 && r > 150 && g < 90 && b < 90;
    hash = (hash * 31 + r + 256 * g + 65536 * b + a) | 0;
  }
  return { inked, red, hash, pixels: data.length / 4 };
};
(async () => {
  await wait();
  answers.title = document.title;
  const counts = { all: rows() };
  click("[data-show=fail]");
  counts.failing = rows();
  click("[data-show=all]");
  type("#search", "turn", "input");
  counts.searched = rows();
  type("#search", "nothing is like that", "input");
  counts.none = rows();
  type("#search", "", "input");
  type("#lane", "embedded", "change");
  counts.lane = rows();
  type("#lane", "", "change");
  answers.rows = counts;

  const suites = Array.from(document.querySelectorAll("details.suite"));
  suites.forEach(suite => { suite.open = true; });
  await wait();
  answers.pictures = [];
  for (const suite of suites) for (const canvas of suite.querySelectorAll("figure:not([hidden]) canvas")) {
    answers.pictures.push({ suite: suite.id, ...look(canvas) });
  }
  const shape = $("#suite-turned .shape canvas");
  let before = look(shape).hash;
  key(shape, "ArrowRight");
  answers.turned_by_key = look(shape).hash !== before;
  before = look(shape).hash;
  const pointer = (type, x, y) => shape.dispatchEvent(new PointerEvent(type, { clientX: x, clientY: y, pointerId: 1, bubbles: true }));
  shape.setPointerCapture = () => {};
  pointer("pointerdown", 100, 100);
  pointer("pointermove", 160, 120);
  pointer("pointerup", 160, 120);
  answers.turned_by_mouse = look(shape).hash !== before;
  before = look($("#suite-sphere .shape canvas")).hash;
  click("#suite-sphere [name=larger]");
  answers.larger = look($("#suite-sphere .shape canvas")).hash !== before;
  key($("#suite-turned .map canvas"), "ArrowLeft");
  answers.map_tells = /deviates|agrees|undetermined/.test($("#suite-turned .said").textContent);
  const colors = () => getComputedStyle(document.body).backgroundColor + look(shape).hash;
  before = colors();
  click("#theme");
  await wait();
  answers.theme = colors() !== before;

  let copied = null;
  Object.defineProperty(navigator, "clipboard", { value: { writeText: async text => { copied = text; } } });
  click("#suite-turned [data-copy$=command]");
  await wait();
  answers.copied = Boolean(copied) && copied.startsWith("shadercheck check ");
  suites.forEach(suite => { suite.open = false; });
  location.hash = document.querySelector("tr[data-suite=suite-sphere] td a").getAttribute("href");
  await wait();
  await wait();
  answers.opened_by_link = $("#suite-sphere").open;

  const out = document.createElement("pre");
  out.id = "answers";
  out.textContent = JSON.stringify(answers);
  document.body.append(out);
})().catch(e => {
  answers.errors.push(String(e));
  const out = document.createElement("pre");
  out.id = "answers";
  out.textContent = JSON.stringify(answers);
  document.body.append(out);
});
