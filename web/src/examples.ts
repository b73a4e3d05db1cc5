// Examples: files of the repository, with the bugs that they have there.

import functions from "../../fixtures/compare/functions.glsl";
import slips from "../../fixtures/compare/slips.wgsl";
import cylinder from "../../fixtures/printed/cylinder.vert";
import formulas from "../../fixtures/improve/formulas.glsl";
import phone from "../../fixtures/precision/phone.frag";
import race from "../../fixtures/kernels/wrong/histogram.wgsl";
import sceneFrag from "../../fixtures/tour/scene.frag";
import sceneVert from "../../fixtures/tour/scene.vert";
import sphereSuite from "../../shaders/chapter9/sphere.suite.toml";
import sphere from "../../shaders/chapter9/sphere.vert";
import type { Open } from "./state";

interface Example {
  title: string;
  files: Open[];
  pane: string;
}

export const EXAMPLES: Example[] = [
  { title: "A cylinder, as it was printed", files: [{ name: "cylinder.vert", text: cylinder }], pane: "problems" },
  {
    title: "Two stages that do not fit",
    files: [
      { name: "scene.vert", text: sceneVert },
      { name: "scene.frag", text: sceneFrag },
    ],
    pane: "problems",
  },
  { title: "A race in a kernel", files: [{ name: "histogram.wgsl", text: race }], pane: "fuzz" },
  { title: "An overflow at mediump", files: [{ name: "phone.frag", text: phone }], pane: "fuzz" },
  { title: "Formulas that lose bits", files: [{ name: "formulas.glsl", text: formulas }], pane: "trace" },
  {
    title: "A sphere and its formula",
    files: [
      { name: "sphere.vert", text: sphere },
      { name: "sphere.suite.toml", text: sphereSuite },
    ],
    pane: "check",
  },
  {
    title: "A port with three slips",
    files: [
      { name: "functions.glsl", text: functions },
      { name: "slips.wgsl", text: slips },
    ],
    pane: "compare",
  },
];
