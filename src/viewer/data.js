// SPDX-License-Identifier: GPL-3.0-or-later
// What the page holds: facts, and arrays by name (page.cpp writes both).

const byId = (id) => document.getElementById(id);

const facts = JSON.parse(byId("facts").textContent);

/// Undoes what packed_array.cpp does.
async function unpacked({ type, stride, unit }, text) {
  const binary = atob(text), packed = new Uint8Array(binary.length);
  for (let i = 0; i < packed.length; ++i) packed[i] = binary.charCodeAt(i);
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  const planes = new Uint8Array(await new Response(stream).arrayBuffer());
  const Type = { Uint16Array, Uint32Array, Int32Array, Float32Array }[type], size = Type.BYTES_PER_ELEMENT;
  const bytes = new Uint8Array(planes.length), count = planes.length / size;
  for (let b = 0; b < size; ++b)
    for (let i = 0, from = b * count; i < count; ++i) bytes[i * size + b] = planes[from + i];
  const values = new Type(bytes.buffer), step = Number(stride);
  if (step) for (let i = step; i < count; ++i) values[i] += values[i - step];
  return Number(unit) ? Float32Array.from(values, (v) => v * Number(unit)) : values;
}

if (!window.DecompressionStream) byId("no-data").hidden = false;
const arrays = {};
for (const element of document.querySelectorAll("script.array")) {
  arrays[element.dataset.name] = await unpacked(element.dataset, element.textContent);
  element.remove();  // the text would only take memory
}

const footprintCount = arrays.area.length;
const cellsAPing = facts.beams * facts.samples;

function cellOf(ping, beam, sample) { return ping * cellsAPing + beam * facts.samples + sample; }
function placeOf(cell) {
  const ping = Math.floor(cell / cellsAPing), rest = cell - ping * cellsAPing;
  const beam = Math.floor(rest / facts.samples);
  return { ping, beam, sample: rest - beam * facts.samples };
}

/// Whether no surface is left in the beam at a cell's range: what is dark there is no shadow.
function isBeyond(cell) {
  const { ping, beam, sample } = placeOf(cell);
  return arrays.surfaces.length > 0 && sample >= arrays.surfaces[ping * facts.beams + beam];
}

/// First element of each ping, and the end: things lie ping by ping.
function firstOfPings(pingOf, count) {
  const first = new Uint32Array(facts.pings.length + 1);
  for (let i = 0; i < count; ++i) ++first[pingOf(i) + 1];
  for (let p = 0; p < facts.pings.length; ++p) first[p + 1] += first[p];
  return first;
}

/// Where the polygons of a list begin, and the end of the last.
function starts(counts) {
  const first = new Uint32Array(counts.length + 1);
  for (let i = 0; i < counts.length; ++i) first[i + 1] = first[i] + counts[i];
  return first;
}

const decibels = (energy) => 10 * Math.log10(energy * facts.energyScale);
