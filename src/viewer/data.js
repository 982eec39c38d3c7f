// SPDX-License-Identifier: GPL-3.0-or-later
// What the page holds: facts, and arrays by name (page.cpp writes both).

const facts = JSON.parse(document.getElementById("facts").textContent);

function decoded(type, text) {
  const binary = atob(text);
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < bytes.length; ++i) bytes[i] = binary.charCodeAt(i);
  return new { Uint16Array, Uint32Array, Float32Array }[type](bytes.buffer);
}

const arrays = {};
for (const element of document.querySelectorAll("script.array")) {
  arrays[element.dataset.name] = decoded(element.dataset.type, element.textContent);
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
