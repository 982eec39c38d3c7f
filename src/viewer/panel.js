// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers of what is lit.

const mostRows = 200;

function element(name, { text, ...attributes } = {}, ...children) {
  const made = document.createElement(name);
  if (text !== undefined) made.textContent = text;
  for (const [key, value] of Object.entries(attributes)) key in made ? (made[key] = value) : made.setAttribute(key, value);
  made.append(...children);
  return made;
}

const dbText = (energy) => energy > 0 ? `${decibels(energy).toFixed(2)} dB` : "no echo";
const digits = (value, n = 4) => Number(value.toPrecision(n)).toString();
const degrees = (rad) => (rad / radians).toFixed(2) + "\u00b0";
const pingOf = (ping) => facts.pings.length > 1 ? `ping ${facts.pings[ping].number}, ` : "";
function cellText(cell) {
  const { ping, beam, sample } = placeOf(cell);
  return `${pingOf(ping)}beam ${beam}, range bin ${sample}`;
}

/// Which of a ping's cycles a cell was heard in, where there are several.
function cycleOf(cell) {
  const { beam } = placeOf(cell), sent = facts.transmissions || [], k = sent.findIndex((one) => one.beams.includes(beam));
  return k < 0 ? [] : [["cycle", `${k} of 0 to ${sent.length - 1}`], ["transmitted", `after ${(1000 * sent[k].delay).toFixed(1)} ms`]];
}

/// What a candidate has of a cell.
function comparedOf(cell) {
  if (!arrays.candidateEnergy.length) return [];
  const energy = arrays.cellEnergy[cell], candidate = arrays.candidateEnergy[cell];
  return [["candidate", dbText(candidate)],
    ["difference", energy > 0 && candidate > 0 ? `${(10 * Math.log10(candidate / energy)).toFixed(2)} dB` : energy > 0 ? "missing" : candidate > 0 ? "too much" : "none"]];
}

function table(heads, rows, more) {
  const body = element("table", {}, element("thead", {}, element("tr", {}, ...heads.map((text) => element("th", { text, scope: "col" })))));
  const list = element("tbody");
  for (const row of rows)
    list.append(element("tr", {}, ...row.map((cell) => typeof cell === "string" ? element("td", { text: cell }) : element("td", {}, cell))));
  body.append(list);
  return more > 0 ? [body, element("p", { className: "faint", text: `and ${more} more` })] : [body];
}

function listOf(pairs) {
  return element("dl", {}, ...pairs.flatMap(([name, text]) => [element("dt", { text: name }), element("dd", { text })]));
}

/// `choose`: called with {cell} or {footprint} by the buttons of the lists.
class Panel {
  constructor(place, choose) {
    this.place = place;
    this.choose = choose;
  }
  button(text, what) { return element("button", { type: "button", text, onclick: () => this.choose(what) }); }

  showNothing() {
    this.place.replaceChildren(
      element("h2", { text: "Nothing is selected" }),
      element("p", { text: "A click on a pixel of the picture highlights its footprints; a click on a footprint highlights its pixels." }),
      element("p", { className: "faint", text: `${footprintCount} footprints, ${arrays.linkCell.length} links between footprints and pixels.` }));
  }

  showCell(cell, parts) {
    const { sample } = placeOf(cell), energy = arrays.cellEnergy[cell], sum = parts.reduce((s, p) => s + p.energy, 0);
    const shown = parts.slice(0, mostRows);
    const rest = energy - sum;
    const content = [
      element("h2", { text: `Pixel: ${cellText(cell)}` }),
      listOf([["energy", dbText(energy)], ["slant range", `${rangeOf(sample).toFixed(3)} to ${rangeOf(sample + 1).toFixed(3)} m`],
        ...comparedOf(cell), ["footprints", String(parts.length)], ["sum of footprints", dbText(sum)], ...cycleOf(cell)]),
    ];
    // Rounding leaves 1e-5 or so.
    if (Math.abs(rest) > 3e-5 * energy)
      content.push(element("p", { className: "faint", text: `The footprints do not explain ${(100 * rest / energy).toPrecision(3)} % of the energy (see About this page).` }));
    if (!parts.length) content.push(element("p", { text: energy > 0 ? "No footprint is linked to this pixel."
        : isBeyond(cell) ? "No footprint reaches this pixel, and this beam has no farther surface: open water, or seabed outside of the scene."
          : "No footprint reaches this pixel: shadow, or water before the first surface." }));
    else
      content.push(...table(["footprint", "energy", "share", "grazing", "area, m\u00b2"], shown.map(({ footprint: f, energy: e }) => [
        this.button(`${facts.components[arrays.component[f]]} #${arrays.facet[f]}`, { footprint: f }), dbText(e),
        `${(100 * e / sum).toFixed(1)} %`, degrees(arrays.grazing[f]), digits(arrays.area[f], 3)]), parts.length - shown.length));
    this.place.replaceChildren(...content);
  }

  showFootprint(f, parts) {
    const a = arrays, shown = parts.slice(0, mostRows), at = [0, 1, 2].map((k) => (a.centroid[3 * f + k] + facts.centre[k]).toFixed(3));
    this.place.replaceChildren(
      element("h2", { text: `Footprint: ${pingOf(a.ping[f])}beam ${a.beam[f]}, facet ${a.facet[f]}` }),
      listOf([["energy", dbText(a.energy[f])], ["area", `${digits(a.area[f])} m\u00b2`],
        ["grazing angle", degrees(a.grazing[f])], ["solid angle", `${digits(a.solidAngle[f])} sr`],
        [facts.receiverApart ? "half path" : "slant range", `${a.near[f].toFixed(3)} to ${a.far[f].toFixed(3)} m`], ["tube", facts.receiverApart ? `${a.tube[f]}, received in ${a.receiveTube[f]}` : String(a.tube[f])],
        ["object", facts.components[a.component[f]]], ["material", facts.materials[a.material[f]]],
        ["cut by", a.occluders[f] ? `${a.occluders[f]} nearer facets` : "nothing"], ["pieces", String(a.pieces[f])],
        ["centroid", `${at[0]} E, ${at[1]} N`], ["height", `${at[2]} m`]]),
      ...(parts.length
        ? table(["pixel", "energy in the pixel", "share of the pixel"], shown.map(({ cell, energy }) => [
          this.button(cellText(cell), { cell }), dbText(energy),
          a.cellEnergy[cell] > 0 ? `${(100 * energy / a.cellEnergy[cell]).toFixed(1)} %` : ""]), parts.length - shown.length)
        : [element("p", { text: "The footprint is in no pixel, because it lies outside of the range gate." })]));
  }
}
