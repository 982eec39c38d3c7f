// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers to colours. Red, green, blue from 0 to 255.

const highlight = [255, 45, 120];  // in none of the scales below

/// Stops of the viridis scale (CC0), even in lightness.
const viridis = [[68, 1, 84], [72, 36, 117], [65, 68, 135], [53, 95, 141], [42, 120, 142], [33, 145, 140],
  [34, 168, 132], [68, 191, 112], [122, 209, 81], [189, 223, 38], [253, 231, 37]];
/// Night blue to sand.
const cividis = [[0, 34, 78], [26, 56, 111], [66, 78, 108], [92, 101, 109], [116, 124, 115], [142, 148, 119],
  [170, 173, 113], [200, 199, 102], [233, 227, 77], [254, 232, 56]];

function between(stops, x) {
  const at = Math.min(Math.max(x, 0), 1) * (stops.length - 1), k = Math.min(Math.floor(at), stops.length - 2);
  return stops[k].map((v, c) => Math.round(v + (at - k) * (stops[k + 1][c] - v)));
}

/// Neighbouring beams get hues far apart.
function beamColour(beam) {
  const hue = (beam * 137.508) % 360, light = 0.52 + 0.1 * ((beam % 3) - 1), strength = 0.45;
  const part = (n) => {
    const k = (n + hue / 30) % 12;
    return Math.round(255 * (light - strength * Math.min(light, 1 - light) * Math.max(-1, Math.min(k - 3, 9 - k, 1))));
  };
  return [part(0), part(8), part(4)];
}

/// Value below which a share of the values lies.
function quantile(values, share) {
  const sorted = Float64Array.from(values).sort();
  return sorted.length ? sorted[Math.min(Math.floor(share * sorted.length), sorted.length - 1)] : 0;
}

const pictureRangeDb = 50;
/// The picture's scale, as in the PNG files: its top is the brightest echoes but for a few glints, less the
/// scene's display gain.
const pictureTopDb = decibels(quantile(arrays.cellEnergy.filter((e) => e > 0), 0.999) || 1) - facts.displayGain;
const pictureTable = Array.from({ length: 256 }, (_, i) => between(viridis, i / 255));
function pictureColour(energy) {
  const level = energy > 0 ? 1 + (decibels(energy) - pictureTopDb) / pictureRangeDb : 0;
  return level > 0 ? pictureTable[Math.round(255 * Math.min(level, 1))] : null;
}

/// Blue to red about grey: a candidate's energy over the reference's.
const ratioTable = Array.from({ length: 256 }, (_, i) => between([[33, 102, 172], [103, 169, 207], [224, 224, 224], [239, 138, 98], [178, 24, 43]], i / 255));
const litEnergy = (() => {
  const heard = arrays.cellEnergy.filter((e) => e > 0);
  return heard.length ? 1e-3 * heard.reduce((sum, e) => sum + e, 0) / heard.length : 0;
})();
/// Clamped to 30 dB; null where neither is lit.
function ratioDb(reference, candidate) {
  if (reference <= litEnergy && candidate <= litEnergy) return null;
  const db = 10 * Math.log10(candidate / reference);
  return Math.min(Math.max(db, -30), 30);
}
/// The smallest that 98 % of what differs keeps within.
const ratioRangeDb = (() => {
  const all = [];
  arrays.candidateEnergy.forEach((c, cell) => {
    const db = ratioDb(arrays.cellEnergy[cell], c);
    if (db) all.push(Math.abs(db));
  });
  return [1, 3, 10].find((db) => db >= quantile(all, 0.98)) || 30;
})();
function ratioColour(reference, candidate) {
  const db = ratioDb(reference, candidate);
  return db === null ? null : ratioTable[Math.round(127.5 * (1 + Math.min(Math.max(db / ratioRangeDb, -1), 1)))];
}

/// Scales of footprints: `level` is 0 to 1 by footprint, `table` 256 colours (256th parts of the level).
const scales = {
  energy() {
    const db = Float32Array.from(arrays.energy, decibels);
    const heard = db.filter(Number.isFinite);
    const high = Math.ceil(quantile(heard, 0.999)), low = Math.max(Math.floor(quantile(heard, 0.02)), high - 60);
    return { title: "Energy of a footprint, dB re 1 J/m2", ticks: [low, (low + high) / 2, high].map((v) => v.toFixed(0)),
      level: db.map((v) => (v - low) / Math.max(high - low, 1)), table: pictureTable };
  },
  grazing() {
    return { title: "Grazing angle, degrees", ticks: ["0", "30", "60", "90"],
      level: arrays.grazing.map((v) => v / (Math.PI / 2)), table: pictureTable.map((_, i) => between(cividis, i / 255)) };
  },
  beam() {
    const last = facts.beams - 1;
    return { title: "Beam", ticks: [...new Set([0, Math.floor(last / 2), last])].map(String),
      level: Float32Array.from(arrays.beam, (b) => (b % 256 + 0.5) / 256),
      table: pictureTable.map((_, i) => beamColour(i)), used: Math.min(facts.beams, 256) };
  },
};

const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
/// A colour of the style sheet, as #rrggbb, from 0 to 1.
const cssColour = (name) => [1, 3, 5].map((k) => parseInt(css(name).slice(k, k + 2), 16) / 255);
const rgb = (c) => `rgb(${c.join(",")})`;
