// The other side of the lane `webgpu`: kernels in WGSL on a device of Dawn. Frames come from standard input and go to
// standard output, as crates/lanes/src/worker/frame.rs has them; whatever a driver prints goes elsewhere.
import { readFileSync, writeSync } from 'node:fs';
import { createRequire } from 'node:module';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';

const MAGIC = Buffer.from('SCW1');
const HEAD = 16;

const TABLE = Uint32Array.from({ length: 256 }, (_, n) => {
  for (let k = 0; k < 8; k++) n = n & 1 ? 0xedb88320 ^ (n >>> 1) : n >>> 1;
  return n >>> 0;
});

function crc32(bytes, before) {
  let crc = ~before;
  for (let i = 0; i < bytes.length; i++) crc = TABLE[(crc ^ bytes[i]) & 255] ^ (crc >>> 8);
  return ~crc >>> 0;
}
const zlib = await import('node:zlib');
const sum = zlib.crc32 ?? crc32;

function die(what) {
  const line = String(what?.message ?? what).replaceAll('\n', ' ');
  try { writeSync(2, `${line}\n`); } catch { /* nobody listens */ }
  // Not `exit`: what a driver still runs would be waited for.
  process.kill(process.pid, 'SIGKILL');
}
process.on('uncaughtException', die);
process.on('unhandledRejection', die);
// While a shader runs without end, the end of standard input is not seen.
const parent = process.ppid;
setInterval(() => { if (process.ppid !== parent) die('the process that asks is gone'); }, 1000).unref();

function put(bytes) {
  for (let at = 0; at < bytes.length;) {
    try {
      at += writeSync(1, bytes, at);
    } catch (error) {
      if (error.code === 'EPIPE') die('nobody reads');
      if (error.code !== 'EAGAIN') throw error;
    }
  }
}

/** Writes a message with the bytes of its words. */
function answer(message, words = new Uint8Array(0)) {
  const text = Buffer.from(JSON.stringify(message));
  const head = Buffer.alloc(HEAD);
  MAGIC.copy(head);
  head.writeUInt32LE(text.length, 4);
  head.writeUInt32LE(words.length / 4, 8);
  head.writeUInt32LE(sum(words, sum(text, 0)), 12);
  put(Buffer.concat([head, text]));
  put(words);
}

/** The frames of standard input. */
async function* frames() {
  let parts = [];
  let have = 0;
  let need = HEAD;
  let head = null;
  for await (const part of process.stdin) {
    parts.push(part);
    have += part.length;
    while (have >= need) {
      const all = parts.length === 1 ? parts[0] : Buffer.concat(parts);
      const bytes = all.subarray(0, need);
      parts = [all.subarray(need)];
      have -= need;
      if (head === null) {
        if (!bytes.subarray(0, 4).equals(MAGIC)) die('what was read is no message');
        head = { text: bytes.readUInt32LE(4), words: bytes.readUInt32LE(8), sum: bytes.readUInt32LE(12) };
        need = head.text + 4 * head.words;
      } else {
        if (sum(bytes, 0) !== head.sum) die('a message with a wrong check sum');
        const message = JSON.parse(bytes.subarray(0, head.text).toString());
        // A copy, since words have to start at a multiple of four.
        const words = Uint8Array.from(bytes.subarray(head.text));
        head = null;
        need = HEAD;
        yield [message, words];
      }
    }
  }
}

let gpu = null;
let device = null;
let limits = null;
const kernels = new Map();

async function open(folder) {
  const require = createRequire(join(folder, 'package.json'));
  let dawn;
  try {
    dawn = await import(pathToFileURL(require.resolve(folder)).href);
  } catch (error) {
    return { Missing: { why: `the package cannot be loaded: ${error.message}`, driver: false } };
  }
  Object.assign(globalThis, dawn.globals);
  // Kept until the end: when it is collected, the process crashes.
  globalThis.keep = gpu = dawn.create(['backend=vulkan']);
  const adapter = await gpu.requestAdapter();
  if (!adapter) return { Missing: { why: 'Dawn takes none of the Vulkan drivers that are here', driver: true } };
  const own = adapter.limits;
  limits = {
    maxStorageBufferBindingSize: own.maxStorageBufferBindingSize,
    maxBufferSize: own.maxBufferSize,
    maxComputeWorkgroupsPerDimension: own.maxComputeWorkgroupsPerDimension,
    maxUniformBufferBindingSize: own.maxUniformBufferBindingSize,
    minUniformBufferOffsetAlignment: own.minUniformBufferOffsetAlignment,
  };
  const more = [
    'maxComputeInvocationsPerWorkgroup', 'maxComputeWorkgroupSizeX', 'maxComputeWorkgroupSizeY', 'maxComputeWorkgroupSizeZ',
    'maxComputeWorkgroupStorageSize', 'maxStorageBuffersPerShaderStage',
  ];
  const requiredLimits = { ...limits, ...Object.fromEntries(more.map((name) => [name, own[name]])) };
  device = await adapter.requestDevice({ requiredLimits });
  device.lost.then((info) => die(`the device was lost: ${info.message}`));
  const { vendor, architecture, device: name, description } = adapter.info;
  const { version } = JSON.parse(readFileSync(join(folder, 'package.json'), 'utf8'));
  return { Opened: { vendor, architecture, device: name, description, version, limits } };
}

/** Runs `work`; gives what it gives, and the error of the API that it caused, if any. */
async function checked(work) {
  const filters = ['validation', 'out-of-memory', 'internal'];
  filters.forEach((filter) => device.pushErrorScope(filter));
  let value = null;
  let thrown = null;
  try {
    value = await work();
  } catch (error) {
    thrown = error;
  }
  const errors = [];
  for (const _ of filters) errors.push(await device.popErrorScope());
  const error = errors.find((found) => found) ?? thrown;
  return [value, error ? String(error.message) : null];
}

const buffer = (bytes, usage) => device.createBuffer({ size: Math.max(16, Math.ceil(bytes / 4) * 4), usage });

function textures(asked, words) {
  const layouts = [];
  const entries = [];
  let at = 0;
  for (const { image, sampler, dimension, view, texel, size } of asked) {
    const depth = texel === 'depth';
    const format = { float: 'rgba32float', sint: 'rgba32sint', uint: 'rgba32uint', depth: 'depth16unorm' }[texel];
    const texture = device.createTexture({
      size, dimension, format, usage: GPUTextureUsage.TEXTURE_BINDING | GPUTextureUsage.COPY_DST,
    });
    const count = size[0] * size[1] * size[2] * (depth ? 1 : 4);
    const own = new Uint32Array(words.buffer, 4 * at, count);
    at += count;
    const texels = depth ? Uint16Array.from(own) : own;
    const layout = { bytesPerRow: (depth ? 2 : 16) * size[0], rowsPerImage: size[1] };
    device.queue.writeTexture({ texture }, texels, layout, size);
    const sampleType = texel === 'float' ? 'unfilterable-float' : texel;
    const visibility = GPUShaderStage.COMPUTE;
    layouts.push({ binding: image, visibility, texture: { sampleType, viewDimension: view } });
    entries.push({ binding: image, resource: texture.createView({ dimension: view }) });
    if (sampler !== null) {
      const type = depth ? 'comparison' : 'non-filtering';
      layouts.push({ binding: sampler, visibility, sampler: { type } });
      const resource = device.createSampler(depth ? { compare: 'less-equal' } : {});
      entries.push({ binding: sampler, resource });
    }
  }
  const layout = device.createBindGroupLayout({ entries: layouts });
  return [layout, device.createBindGroup({ layout, entries })];
}

async function prepare(job, words) {
  const module = device.createShaderModule({ code: job.code });
  const { messages } = await module.getCompilationInfo();
  const wrong = messages.find((message) => message.type === 'error');
  if (wrong) return { refused: { line: wrong.lineNum, column: wrong.linePos, why: wrong.message } };
  if (job.dispatch) return { made: await dispatching(job, module) };
  const visibility = GPUShaderStage.COMPUTE;
  const bytes = 4 * job.record * job.capacity;
  const { STORAGE, UNIFORM, COPY_SRC, COPY_DST, MAP_READ } = GPUBufferUsage;
  const made = {
    job,
    params: buffer(16, UNIFORM | COPY_DST),
    outputs: buffer(bytes, STORAGE | COPY_SRC | COPY_DST),
    blank: buffer(bytes, COPY_SRC | COPY_DST),
    readback: buffer(bytes, MAP_READ | COPY_DST),
    groups: [],
    inputs: [],
  };
  device.queue.writeBuffer(made.blank, 0, new Uint32Array(made.blank.size / 4).fill(job.sentinel));
  const layouts = [
    { binding: 0, visibility, buffer: { type: 'uniform' } },
    { binding: 1, visibility, buffer: { type: 'storage' } },
  ];
  const entries = [
    { binding: 0, resource: { buffer: made.params } },
    { binding: 1, resource: { buffer: made.outputs } },
  ];
  for (const { binding, words: size, dynamic } of job.inputs) {
    const type = dynamic ? 'uniform' : 'read-only-storage';
    const usage = dynamic ? UNIFORM : STORAGE;
    const input = buffer(4 * (dynamic ? job.stride : size) * job.capacity, usage | COPY_DST);
    made.inputs.push(input);
    layouts.push({ binding, visibility, buffer: { type, hasDynamicOffset: dynamic } });
    entries.push({ binding, resource: dynamic ? { buffer: input, size: 4 * size } : { buffer: input } });
  }
  const layout = device.createBindGroupLayout({ entries: layouts });
  const all = [layout];
  made.groups.push(device.createBindGroup({ layout, entries }));
  if (job.textures.length > 0) {
    const empty = device.createBindGroupLayout({ entries: [] });
    const [own, group] = textures(job.textures, words);
    all.push(empty, own);
    made.groups.push(device.createBindGroup({ layout: empty, entries: [] }), group);
  }
  made.pipeline = await device.createComputePipelineAsync({
    layout: device.createPipelineLayout({ bindGroupLayouts: all }),
    compute: { module, entryPoint: job.entry },
  });
  return { made };
}

/** Makes a compute stage ready for whole dispatches, one after the other. */
async function dispatching(job, module) {
  const { STORAGE, UNIFORM, COPY_SRC, COPY_DST, MAP_READ } = GPUBufferUsage;
  const visibility = GPUShaderStage.COMPUTE;
  const inputs = [];
  const groups = [];
  for (const { group, binding, bytes, words, uniform, writable } of job.dispatch.buffers) {
    const own = buffer(4 * words, (uniform ? UNIFORM : STORAGE) | COPY_DST | COPY_SRC);
    inputs.push(own);
    groups[group] ??= { layouts: [], entries: [] };
    const type = uniform ? 'uniform' : writable ? 'storage' : 'read-only-storage';
    groups[group].layouts.push({ binding, visibility, buffer: { type } });
    groups[group].entries.push({ binding, resource: { buffer: own, size: bytes } });
  }
  const filled = Array.from(groups, (group) => group ?? { layouts: [], entries: [] });
  const layouts = filled.map((group) => device.createBindGroupLayout({ entries: group.layouts }));
  const bound = filled.map(({ entries }, k) => device.createBindGroup({ layout: layouts[k], entries }));
  const pipeline = await device.createComputePipelineAsync({
    layout: device.createPipelineLayout({ bindGroupLayouts: layouts }),
    compute: { module, entryPoint: job.entry },
  });
  const readback = buffer(4 * job.record * job.capacity, MAP_READ | COPY_DST);
  return { job, inputs, groups: bound, pipeline, readback };
}

async function dispatched(made, count, words) {
  const { job, inputs, groups, pipeline, readback } = made;
  const { buffers, groups: [x, y, z] } = job.dispatch;
  for (let k = 0; k < count; k++) {
    let at = 0;
    buffers.forEach(({ words: size }, b) => {
      device.queue.writeBuffer(inputs[b], 0, words, 4 * (at + k * size), 4 * size);
      at += size * count;
    });
    const encoder = device.createCommandEncoder();
    const pass = encoder.beginComputePass();
    pass.setPipeline(pipeline);
    groups.forEach((group, g) => pass.setBindGroup(g, group));
    pass.dispatchWorkgroups(x, y, z);
    pass.end();
    let to = 4 * job.record * k;
    buffers.forEach(({ words: size, read }, b) => {
      if (!read) return;
      encoder.copyBufferToBuffer(inputs[b], 0, readback, to, 4 * size);
      to += 4 * size;
    });
    device.queue.submit([encoder.finish()]);
  }
  await readback.mapAsync(GPUMapMode.READ, 0, Math.max(4, 4 * job.record * count));
  return readback;
}

async function run({ id, count, per_case, canary, lengths }, words) {
  const made = kernels.get(id);
  if (!made) throw new Error('a kernel that was never made ready');
  const { job } = made;
  if (job.dispatch) return dispatched(made, count, words);
  const bytes = 4 * job.record * count;
  const { queue } = device;
  queue.writeBuffer(made.params, 0, Uint32Array.of(count, per_case, canary, job.sentinel));
  let at = 0;
  lengths.forEach((length, k) => {
    if (length > 0) queue.writeBuffer(made.inputs[k], 0, words, 4 * at, 4 * length);
    at += length;
  });
  const encoder = device.createCommandEncoder();
  encoder.copyBufferToBuffer(made.blank, 0, made.outputs, 0, bytes);
  const pass = encoder.beginComputePass();
  pass.setPipeline(made.pipeline);
  made.groups.slice(1).forEach((group, k) => pass.setBindGroup(k + 1, group));
  if (job.stride > 0) {
    for (let i = 0; i < count; i++) {
      pass.setBindGroup(0, made.groups[0], [4 * job.stride * i]);
      pass.dispatchWorkgroups(1);
    }
  } else {
    pass.setBindGroup(0, made.groups[0]);
    pass.dispatchWorkgroups(Math.ceil(count / job.workgroup));
  }
  pass.end();
  encoder.copyBufferToBuffer(made.outputs, 0, made.readback, 0, bytes);
  queue.submit([encoder.finish()]);
  await made.readback.mapAsync(GPUMapMode.READ, 0, bytes);
  return made.readback;
}

function drop(id) {
  const made = kernels.get(id);
  if (!made) return;
  kernels.delete(id);
  [made.params, made.outputs, made.blank, made.readback, ...made.inputs].forEach((own) => own?.destroy());
}

for await (const [message, words] of frames()) {
  const [[kind, asked]] = Object.entries(message);
  const { id, run: number } = asked;
  if (kind === 'Open') {
    answer(await open(asked.folder));
  } else if (kind === 'Prepare') {
    const [done, error] = await checked(() => prepare(asked, words));
    if (done?.refused) {
      answer({ Refused: { id, ...done.refused } });
    } else if (error) {
      answer({ Refused: { id, line: 0, column: 0, why: error } });
    } else {
      kernels.set(id, done.made);
      answer({ Ready: { id } });
    }
  } else if (kind === 'Run') {
    const [readback, error] = await checked(() => run(asked, words));
    if (error) {
      answer({ Failed: { run: number, why: error } });
    } else {
      const bytes = 4 * kernels.get(id).job.record * asked.count;
      answer({ Done: { run: number } }, new Uint8Array(readback.getMappedRange(0, bytes)));
      readback.unmap();
    }
  } else if (kind === 'Drop') {
    drop(id);
  } else {
    die(`\`${kind}\` is nothing that can be asked`);
  }
}
die('nobody asks any more');
