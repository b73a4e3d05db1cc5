// The page in a browser, as a visitor has it. CHROMIUM is the browser, DIST the page; SHOTS takes pictures of it.

import assert from "node:assert/strict";
import { createServer } from "node:http";
import { readFile } from "node:fs/promises";
import { extname, join } from "node:path";
import { after, before, test } from "node:test";
import puppeteer from "puppeteer-core";

const { DIST, CHROMIUM, SHOTS } = process.env;
const TYPES = { ".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".wasm": "application/wasm" };
let server, browser, address;
const complaints = [];

before(async () => {
  server = createServer(async (request, response) => {
    const path = new URL(request.url, "http://x").pathname;
    const file = join(DIST, path === "/" ? "index.html" : path);
    try {
      const bytes = await readFile(file);
      response.writeHead(200, { "content-type": TYPES[extname(file)] ?? "text/plain" }).end(bytes);
    } catch {
      response.writeHead(404).end();
    }
  });
  await new Promise((done) => server.listen(0, "127.0.0.1", done));
  address = `http://127.0.0.1:${server.address().port}/`;
  browser = await puppeteer.launch({ executablePath: CHROMIUM, args: ["--no-sandbox"] });
});

after(async () => {
  await browser?.close();
  server?.close();
});

async function opened(fragment = "", size = { width: 1280, height: 800 }) {
  const page = await browser.newPage();
  page.on("console", (message) => message.type() === "error" && complaints.push(message.text()));
  page.on("pageerror", (error) => complaints.push(String(error)));
  await page.setViewport(size);
  await page.goto(address + fragment);
  return page;
}

const shot = async (page, name) => SHOTS && page.screenshot({ path: join(SHOTS, `${name}.png`) });
const text = (page, selector) => page.$eval(selector, (element) => element.textContent);
const tab = async (page, title) => {
  const found = await page.waitForSelector(`::-p-xpath(//nav[@id='panes']/button[starts-with(., '${title}')])`);
  await found.click();
};
const example = async (page, title) => {
  const value = await page.$$eval("#examples option", (all, t) => all.find((o) => o.textContent === t).value, title);
  await page.select("#examples", value);
};

test("the vec3 of the printed cylinder is found, and its repair leaves nothing", async () => {
  const begun = performance.now();
  const page = await opened();
  await page.waitForSelector(".problems li", { timeout: 20_000 });
  console.log(`first finding after ${Math.round(performance.now() - begun)} ms`);
  assert.match(await text(page, ".problems"), /T001/);
  await shot(page, "problems");
  await (await page.waitForSelector(".problems .error .fix")).click();
  await page.waitForFunction(() => !document.querySelector(".problems")?.textContent.includes("T001"));
  assert.match(await text(page, ".cm-content"), /vec4\(cos\(th\), y, sin\(th\), 1\.0\)/);
});

test("a rule has its page", async () => {
  const page = await opened();
  await (await page.waitForSelector(".problems .error .code")).click();
  await page.waitForFunction(() => document.querySelector("#result .terminal")?.textContent.includes("T001"));
  await (await page.waitForSelector("::-p-xpath(//div[@id='bar']/button[.='Open the good example'])")).click();
  await page.waitForFunction(() => document.querySelector("#result .none") !== null);
});

test("an address names a rule, whose example is opened", async () => {
  const page = await opened("#rule=H001");
  await page.waitForFunction(() => document.querySelector(".problems")?.textContent.includes("H001"));
});

test("fuzz finds the race of a kernel, and its places lead to the line", async () => {
  const page = await opened();
  await example(page, "A race in a kernel");
  await page.waitForFunction(() => document.querySelector("#bar")?.textContent.includes("status"), { timeout: 60_000 });
  assert.match(await text(page, "#bar"), /status 1/);
  assert.match(await text(page, "#result"), /race/);
  await shot(page, "fuzz");
});

const shown = (page, words) =>
  page.waitForFunction((w) => document.querySelector("#bar")?.textContent.includes(w), { timeout: 120_000 }, words);

test("a trace shows the expression that loses the digits", async () => {
  const page = await opened();
  await example(page, "Formulas that lose bits");
  await shown(page, "status");
  assert.match(await text(page, "#result"), /loses most/);
  await shot(page, "trace");
});

test("improve finds a better formula", async () => {
  const page = await opened();
  await example(page, "Formulas that lose bits");
  await tab(page, "Improve");
  await shown(page, "status 1");
  assert.match(await text(page, "#result"), /\n-.*exp\(x\) - 1\.0/);
  await shot(page, "improve");
});

test("a suite runs, and a port with slips is unlike its original", async () => {
  const page = await opened();
  await example(page, "A sphere and its formula");
  await shown(page, "status 0");
  assert.match(await text(page, "#result"), /pass: .* 0 deviated/);
  await example(page, "A port with three slips");
  await shown(page, "status 1");
  assert.match(await text(page, "#result"), /3 unlike/);
  await shot(page, "compare");
});

test("what was typed stays when another file is shown, and undoing is of one file", async () => {
  const page = await opened();
  await example(page, "Two stages that do not fit");
  const press = (name) => page.waitForSelector(`::-p-xpath(//nav[@id='files']/button[.='${name}'])`).then((b) => b.click());
  const has = (words) =>
    page.waitForFunction((w) => document.querySelector(".cm-content")?.textContent.includes(w), {}, words);
  await has("A plant that the wind moves");
  await page.click(".cm-content");
  await page.keyboard.type("// of the visitor");
  await press("scene.frag");
  await has("A lamp with a soft edge");
  await page.click(".cm-content");
  await page.keyboard.down("Control");
  await page.keyboard.press("z");
  await page.keyboard.up("Control");
  assert.match(await text(page, ".cm-content"), /A lamp with a soft edge/);
  await press("scene.vert");
  await has("// of the visitor");
});

test("a file of the visitor is opened, renamed and removed, and a stricter level tells more", async () => {
  const page = await opened();
  await page.waitForSelector(".problems li");
  const press = (name) => page.waitForSelector(`::-p-xpath(//nav[@id='files']/button[.='${name}'])`).then((b) => b.click());
  const [chooser] = await Promise.all([page.waitForFileChooser(), press("Open")]);
  await chooser.accept([join(import.meta.dirname, "../../fixtures/web/wave.js")]);
  await page.waitForFunction(() => document.querySelector(".cm-content")?.textContent.includes("A wave in three.js"));
  page.once("dialog", (dialog) => dialog.accept("other.js"));
  await press("Rename");
  await page.waitForSelector("::-p-xpath(//nav[@id='files']/button[.='other.js'])");
  const count = () => page.$$eval(".problems li", (all) => all.length);
  await page.waitForFunction(() => document.querySelector(".problems")?.textContent.includes("other.js"));
  const before = await count();
  await page.select("#bar select", "strict");
  await page.waitForFunction((n) => document.querySelectorAll(".problems li").length > n, {}, before);
  page.once("dialog", (dialog) => dialog.accept());
  await press("Remove");
  await page.waitForFunction(() => document.querySelectorAll("#files button:not(.file)").length === 1);
});

test("a pane that lacks a file says which", async () => {
  const page = await opened();
  await tab(page, "Check");
  await shown(page, "add a file NAME.suite.toml");
});

test("a link brings the files and the pane back", async () => {
  const page = await opened();
  await page.waitForSelector(".problems li");
  await tab(page, "Translate");
  await page.waitForFunction(() => document.querySelector("#bar")?.textContent.includes("status"));
  await page.click("#share");
  await page.waitForFunction(() => location.hash.startsWith("#s="));
  const again = await opened(await page.evaluate(() => location.hash));
  await again.waitForFunction(() => document.querySelector("#bar")?.textContent.includes("status"));
  assert.match(await text(again, ".cm-content"), /Side of a cylinder/);
});

test("a link that was cut gives a sentence", async () => {
  const page = await opened("#s=abcd");
  await page.waitForFunction(() => document.querySelector("#state")?.textContent.includes("damaged"));
  await page.waitForSelector(".problems li");
});

test("a run can be stopped, and the next one works", async () => {
  const page = await opened();
  await example(page, "Formulas that lose bits");
  await (await page.waitForSelector("::-p-xpath(//div[@id='bar']/button[.='Stop'])")).click();
  await page.waitForFunction(() => document.querySelector("#bar")?.textContent.includes("stopped"));
  await tab(page, "Translate");
  await page.waitForFunction(() => document.querySelector("#bar")?.textContent.includes("status"), { timeout: 30_000 });
});

test("on a phone nothing is wider than the screen", async () => {
  const page = await opened("", { width: 390, height: 844, isMobile: true, hasTouch: true });
  await page.waitForSelector(".problems li");
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= 390));
  await shot(page, "phone");
});

test("in the dark", async () => {
  const page = await opened();
  await page.emulateMediaFeatures([{ name: "prefers-color-scheme", value: "dark" }]);
  await page.waitForSelector(".problems li");
  await shot(page, "dark");
});

test("nothing was complained of", () => {
  assert.deepEqual(complaints, []);
});
